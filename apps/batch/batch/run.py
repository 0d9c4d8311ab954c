"""A batch on an existing cluster, or on a cluster of local processes, one per device."""
from __future__ import annotations

import contextlib
import logging
import multiprocessing.resource_tracker
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Optional

from .._errors import PellucidError
from ..device import Device, devices
from .manifest import Manifest
from .report import BatchError, NoWorker, Summary
from .store import Store, StoreError

try:
    import dask
    import distributed
except ImportError as e:
    raise ImportError("batches run on Dask, which is not installed: pip install pellucid[batch]") from e


@contextlib.contextmanager
def _local_client(count: Optional[int], selectors: Sequence[str], timeout: float = 120.0) -> Iterator[Any]:
    """Processes of this machine, each with a device of its own by turns, restarted when they die."""
    chosen = list(selectors) or [str(i) for i in range(len(devices()))]
    if not chosen:
        raise NoWorker("no OpenCL device; Debian's pocl-opencl-icd brings one for any CPU")
    for selector in selectors:
        try:
            Device(selector)
        except PellucidError as e:
            raise NoWorker(str(e)) from None
    if not selectors and os.environ.get("PELLUCID_DEVICE"):
        chosen = [os.environ["PELLUCID_DEVICE"]]
    here = {"host": "127.0.0.1"}  # anyone who can connect to a Dask port can execute code
    quiet = logging.CRITICAL + 1  # connections that break while it closes are critical to Dask
    worker = {**here, "nthreads": 1, "memory_limit": 0, "silence_logs": quiet}
    workers = {i: {"cls": distributed.Nanny,
                   "options": {**worker, "env": {"PELLUCID_DEVICE": chosen[i % len(chosen)]}}}
               for i in range(count or len(chosen))}
    scheduler = {"cls": distributed.Scheduler,
                 "options": {**here, "port": 0, "dashboard": False, "dashboard_address": "127.0.0.1:0"}}
    with dask.config.set({"distributed.admin.system-monitor.interval": "10s",
                          "distributed.scheduler.worker-ttl": f"{timeout:g}s"}):
        # Inherited by Dask's threads and the processes that they start: Ctrl-C is for this process, which
        # ends them. (Starting the tracker would unblock it in the thread that does.)
        multiprocessing.resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            cluster = distributed.SpecCluster(workers=workers, scheduler=scheduler, silence_logs=quiet)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        with cluster, distributed.Client(cluster) as client:
            yield client


@contextlib.contextmanager
def _connected(scheduler: Any) -> Iterator[Any]:
    """A client of an address or of a cluster object."""
    name = getattr(scheduler, "scheduler_address", scheduler)
    try:
        client = distributed.Client(scheduler)
    except Exception as e:  # of a wrong address, a host that is none, another protocol, ...
        raise NoWorker(f"no Dask scheduler at {name}: {str(e) or type(e).__name__} (an address looks like "
                       "tcp://host:8786, and `dask scheduler` prints its own when it starts; the scheduler's "
                       f"Dask must be this one's, {distributed.__version__})") from e
    with client:
        yield client


@contextlib.contextmanager
def _held_interrupts() -> Iterator[Callable[[], None]]:
    """Yields a function that raises KeyboardInterrupt if Ctrl-C was pressed. Raised by the signal, it could
    end in a finalizer or a callback of Dask, where Python prints and drops it, or leave a cluster half
    started. A second Ctrl-C is raised at once. On another thread, or with a handler of the caller's: does
    nothing."""
    pressed = False

    def note(number: int, frame: Any) -> None:
        nonlocal pressed
        if pressed:
            signal.default_int_handler(number, frame)
        pressed = True

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    held = (threading.current_thread() is threading.main_thread() and
            signal.getsignal(signal.SIGINT) is signal.default_int_handler)
    if held:
        signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        if held:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def run(manifest: str | os.PathLike[str] | Manifest, out: str | os.PathLike[str], *, scheduler: Any = None,
        workers: Optional[int] = None, device: Sequence[str] = (), timeout: float = 120.0, jobs: int = 0,
        patience: float = 300.0, progress: bool = False) -> Summary:
    """Makes the tables of a manifest that are not in `out` yet.

    Parameters
    ----------
    manifest : path or Manifest
    out : path or URL
        A folder that all workers see under this name, or what fsspec knows (s3://...).
    scheduler : address, Client, cluster or None
        A Dask cluster whose workers have this package: the address of its scheduler, a distributed.Client,
        or a cluster object as those of dask-jobqueue and dask-kubernetes, whose own `scale` and `adapt` say
        how many workers there are. None: processes of this machine.
    workers : int, optional
        Without a scheduler: how many processes; one per device without it.
    device : selectors
        Without a scheduler: devices that the processes take by turns; all without it. On a cluster every
        worker takes its own, by its PELLUCID_DEVICE.
    timeout : seconds
        A worker whose device finishes nothing for that long is given up, and its work goes to another.
        Without a scheduler the same holds for a process that answers nothing; a cluster's scheduler has its
        own limit, `distributed.scheduler.worker-ttl`.
    jobs : int
        Entries in flight per worker; 0: four per core.
    patience : seconds
        How long to wait when there is no worker.
    progress : bool
        On standard error.

    Returns
    -------
    Summary

    Raises
    ------
    ValueError
        It is no manifest, or workers are asked of a scheduler, which has its own.
    BatchError
        The output is full or gone; NoWorker, which is one: there is no scheduler, or no worker for too long.
        What is made is kept: the same call goes on from there.
    """
    if scheduler is not None and workers is not None:
        raise ValueError("workers are processes of this machine; a cluster has its own: cluster.scale(n)")
    if scheduler is None and os.fspath(out).startswith(("memory://", "local://")):
        raise ValueError(f"{out}: processes of this machine share no memory; name a folder")
    if not isinstance(manifest, Manifest):
        manifest = Manifest(manifest)
    try:
        store = Store(out)
        store.prepare()
    except StoreError as e:
        raise BatchError(str(e)) from e
    from .dispatch import Dispatcher

    if isinstance(scheduler, distributed.Client):
        connection: Any = contextlib.nullcontext(scheduler)
    elif scheduler is None:
        connection = _local_client(workers, device, timeout)
    else:
        connection = _connected(scheduler)
    with _held_interrupts() as check, connection as client:
        return Dispatcher(client, manifest, store, progress=progress, timeout=timeout, jobs=jobs,
                          patience=patience, check=check).run()
