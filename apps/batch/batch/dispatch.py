"""Shares the entries of a manifest out among the workers of a Dask cluster.

Dask gives pieces of the list to workers, and the pieces of a worker that dies, or that the scheduler has not
heard of for its `worker-ttl`, to others. In addition, an entry counts only once its file has been read back,
and unfinished entries are submitted again, in halves, to workers other than the one that failed. Doing an
entry twice changes nothing, because files are named by content and appear whole.
"""
from __future__ import annotations

import asyncio
import contextlib
import hashlib
import pickle
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, ThreadPoolExecutor
from typing import Any

import distributed

from .. import __version__
from ..device import progress_bar
from . import worker as work
from .manifest import Manifest
from .report import BatchError, NoWorker, Summary
from .store import Store, StoreError

PIECES = 256  # at least, so that later workers get work
PIECES_PER_WORKER = 8  # per present worker, so that all end at about the same time
LARGEST_PIECE = 1024  # entries
ATTEMPTS = 3  # of a single entry, after which it is blamed for lost workers
LOOK_SECONDS = 0.5  # between two checks of the present workers
LATEST_SECONDS = 10.0  # until a dismissed process has ended; Dask kills it after four


def on_worker(*arguments: Any) -> tuple[str, str, Any]:
    """Runs on a worker. Returns the worker's address, the kind of the answer, and the answer."""
    import importlib

    import distributed

    address = distributed.get_worker().address
    try:
        worker = importlib.import_module("pellucid.batch.worker")
    except ImportError as e:
        return address, "unfit", f"{e} (install pellucid[batch] in the environment of the workers)"
    try:
        return address, "made", worker.make_entries(*arguments)
    except worker.UnfitWorker as e:
        return address, "unfit", str(e)
    except Exception as e:
        return address, "garbage", f"{type(e).__name__}: {e}"


# Sent as code, so that the scheduler needs no package and a worker without the package can report that.
on_worker.__module__ = "__main__"


class Dispatcher:
    """One batch on one cluster; `run` does it."""

    def __init__(self, client: Any, manifest: Manifest, store: Store, *, progress: bool, timeout: float,
                 jobs: int, patience: float, check: Callable[[], None]) -> None:
        """`check` raises what should end the batch early."""
        self._client, self._manifest, self._store = client, manifest, store
        self._spoken, self._bar_of_all = progress, progress_bar() if progress else None
        self._timeout, self._jobs, self._patience, self._check = timeout, jobs, patience, check
        self._open = set(range(len(manifest)))  # unfinished entries
        self._there = [False] * len(manifest)
        self._attempts: dict[int, int] = {}
        self._present: set[str] = set()
        self._barred: set[str] = set()
        self._garbled: set[str] = set()  # workers with invalid answers, whose processes may still write
        # By future: its entries, and the workers it was restricted to; empty: any worker.
        self._pieces: dict[Any, tuple[list[int], set[str]]] = {}
        self._alone = time.monotonic()
        self._last_trouble = ""
        self.summary = Summary(entries=len(manifest), duplicates=manifest.duplicates)

    def run(self) -> Summary:
        """Returns when every entry is done or has failed.

        Raises
        ------
        BatchError
            The output is full or gone; NoWorker: the scheduler is gone, or no worker came for longer than
            `patience`.
        """
        start = time.monotonic()
        for _, message in self._manifest.errors:
            self._entry_failed(message)
        try:
            self._make_all()
        except BatchError as e:
            e.summary = self.summary
            raise
        finally:
            with contextlib.suppress(Exception):  # the scheduler may be gone
                self._client.cancel(list(self._pieces), force=True)
            self.summary.total_ms = 1e3 * (time.monotonic() - start)
            self.summary.per_second = self.summary.made / max(time.monotonic() - start, 1e-9)
            self._bar_of_all = None  # ends it
            self._write_index()
        return self.summary

    def _make_all(self) -> None:
        self._check()
        packed = pickle.dumps(self._manifest)
        self._name = f"pellucid-{hashlib.sha256(packed).hexdigest()}"
        # The scheduler keeps it; each worker asks once.
        distributed.Variable(self._name, client=self._client).set(packed)
        self._look()
        count = len(self._manifest)
        pieces = max(PIECES, PIECES_PER_WORKER * len(self._present))
        size = max(1, min(LARGEST_PIECE, count // pieces))
        for first in range(0, count, size):
            self._submit(list(range(first, min(first + size, count))))
        looked = time.monotonic()
        with ThreadPoolExecutor(8) as readers:
            while self._open or self._written_late(readers):
                self._check()
                if time.monotonic() - looked > LOOK_SECONDS:
                    self._look()
                    looked = time.monotonic()
                done = [future for future in self._pieces if future.done()]
                for future, answer in zip(done, readers.map(self._receive, done)):
                    piece = self._pieces.pop(future, None)
                    if piece:  # has not been resubmitted
                        self._handle(piece[0], answer)
                if self._bar_of_all:
                    self._bar_of_all(1 - len(self._open) / len(self._manifest), "tables")
                if not done:
                    time.sleep(0.02)
        with contextlib.suppress(NoWorker):
            self._look()  # for the last lost workers

    def _written_late(self, readers: ThreadPoolExecutor) -> bool:
        """Whether entries are open again because a dismissed worker kept running until its process ended, and
        overwrote files that had been checked."""
        if not self._garbled:
            return False
        end = time.monotonic() + LATEST_SECONDS
        with contextlib.suppress(NoWorker):
            while self._garbled & self._present and time.monotonic() < end:
                self._check()
                time.sleep(0.1)
                self._look()
        self._garbled.clear()
        made = [i for i, there in enumerate(self._there) if there]

        def is_whole(i: int) -> bool:
            return self._manifest.holds(i, self._store.read(self._manifest.entries[i].file) or b"")

        try:
            damaged = [i for i, whole in zip(made, readers.map(is_whole, made)) if not whole]
        except StoreError as e:
            raise BatchError(str(e)) from e
        self._open.update(damaged)
        if damaged:
            self._submit(damaged)
        return bool(damaged)

    def _write_index(self) -> None:
        """Also for an unfinished batch, unless the output failed or there is no table."""
        if not any(self._there):
            return
        other = sys.exc_info()[1]  # the exception in flight
        try:
            self._store.write(self._manifest.index_name, self._manifest.index(self._there))
        except StoreError as e:
            if other is None:
                raise BatchError(str(e)) from e

    def _look(self) -> None:
        """Finds present and lost workers, and whether any of them can work."""
        try:
            present = set(self._client.nthreads())
        except (OSError, TimeoutError, asyncio.TimeoutError) as e:
            raise NoWorker(f"the scheduler {self._client.scheduler.address} does not answer any more ({e}); "
                           "what is made is kept, and the same call goes on from there when a scheduler is "
                           "back") from e
        now = time.monotonic()
        for address in self._present - present - self._barred:
            self.summary.workers_lost += 1
            self._trouble(f"worker {address} is gone")
        self._present = present
        self._barred &= present
        # Dask reassigns work only while there are workers: work left by the last one would wait for ever.
        for future in [f for f, (_, asked) in self._pieces.items()
                       if asked and not asked & present and not f.done()]:
            self._client.cancel([future], force=True)
            self._submit(self._pieces.pop(future)[0])
        if present - self._barred:
            self._alone = now
        elif now - self._alone > self._patience:
            why = f"; the last trouble was: {self._last_trouble}" if self._last_trouble else ""
            raise NoWorker(f"no worker for {self._patience:.0f} s{why}")

    def _bar(self, address: str, why: str, restart: bool = True) -> None:
        """Gives it no more work. A nanny, where there is one, starts a fresh process in its place."""
        if address in self._barred:
            return
        self._barred.add(address)
        self.summary.workers_dismissed += 1
        self._trouble(f"worker {address} {why}")

        def renew() -> None:
            with contextlib.suppress(Exception):  # the scheduler may be gone
                self._client.restart_workers([address], timeout=30, raise_for_error=False)

        if restart:
            self._garbled.add(address)
            threading.Thread(target=renew, daemon=True).start()

    def _trouble(self, message: str) -> None:
        self._last_trouble = message
        self._say(message)

    def _say(self, message: str) -> None:
        if self._spoken:
            print(("\r\033[K" if sys.stderr.isatty() else "") + message, file=sys.stderr, flush=True)

    def _submit(self, indices: list[int]) -> None:
        # If all usable workers go, Dask asks others.
        usable = sorted(self._present - self._barred) if self._barred else None
        future = self._client.submit(on_worker, self._name, __version__, indices, self._store.out, self._jobs,
                                     self._timeout, workers=usable or None, allow_other_workers=bool(usable),
                                     pure=False)
        self._pieces[future] = indices, set(usable or ())

    def _again(self, indices: list[int]) -> None:
        """Submits entries again, in halves: one of them may crash the workers."""
        indices = [i for i in indices if i in self._open]
        if not indices:
            return
        self.summary.retried += 1
        half = len(indices) // 2
        if half:
            self._submit(indices[:half])
            self._submit(indices[half:])
            return
        (index,) = indices
        self._attempts[index] = self._attempts.get(index, 0) + 1
        if self._attempts[index] < ATTEMPTS:
            self._submit(indices)
        else:
            self._close_failed(index, f"given up after {ATTEMPTS} attempts; the last trouble was: "
                                      f"{self._last_trouble}")

    def _receive(self, future: Any) -> Any:
        """On a thread: the answer to a piece, with a check of each file in it; or the error in its place."""
        try:
            address, kind, answers = future.result(timeout=30)
            if kind == "made":
                try:
                    indices = self._pieces[future][0]
                    answers = [(*answer, self._is_true(indices, *answer)) for answer in answers]
                except (LookupError, TypeError, ValueError):
                    return address, "garbage", "an answer of unknown form"
            return address, kind, answers
        except BaseException as e:  # what Dask raises, an output that is gone
            return e

    def _is_true(self, indices: list[int], index: int, what: str, text: str) -> bool:
        """Whether an entry's file exists, is complete, and matches the worker's report."""
        if index not in indices or what not in work.KINDS or not isinstance(text, str):
            raise ValueError(what)
        if what not in work.FILE_THERE:
            return True
        data = self._store.read(self._manifest.entries[index].file)
        return (data is not None and self._manifest.holds(index, data) and
                hashlib.sha256(data).hexdigest() == text)

    def _handle(self, indices: list[int], answer: Any) -> None:
        if isinstance(answer, StoreError):
            raise BatchError(str(answer)) from answer
        # The scheduler is or was unreachable, or the worker that held the answer is gone.
        if isinstance(answer, (CancelledError, asyncio.CancelledError, asyncio.TimeoutError, OSError)):
            self._look()
            self._submit(indices)
        elif isinstance(answer, BaseException):  # KilledWorker, an answer that cannot be read, ...
            self._trouble(f"work was lost: {type(answer).__name__}: {answer}")
            self._again(indices)
        elif answer[1] == "unfit":  # not the entries' fault, and a restart does not help
            self._bar(answer[0], f"gets no work: {answer[2]}", restart=False)
            self._submit(indices)
        elif answer[1] == "garbage":
            self._bar(answer[0], f"returned invalid results: {answer[2]}")
            self._again(indices)
        else:
            self._made(answer[0], indices, answer[2])

    def _made(self, address: str, indices: list[int], answers: list[tuple[int, str, str, bool]]) -> None:
        broken = lies = 0
        for index, what, text, true in answers:
            lies += not true
            if what == work.NO_STORE:
                raise BatchError(f"worker {address}: {text}")
            if index not in self._open or not true:
                continue
            if what == work.BAD:
                self._close_failed(index, text)
            elif what in work.FILE_THERE:
                self._close(address, index, what)
            else:  # another device may do it
                broken += what == work.DEVICE_FAILED
                self._last_trouble = text
        if lies:
            self._bar(address, f"returned invalid results for {lies} entries: files are missing from "
                               f"{self._store.out}, or differ from what it reports (all machines must see "
                               "the same folder)")
        elif broken and broken == len(answers):
            self._bar(address, f"has a device that fails: {self._last_trouble}")
        self._again(indices)

    def _close(self, address: str, index: int, what: str) -> None:
        self._open.discard(index)
        if self._there[index]:  # counted before it was overwritten
            return
        self._there[index] = True
        if what == work.KEPT:
            self.summary.kept += 1
        else:
            self.summary.made += 1
            self.summary.redone += what == work.REDONE
            self.summary.made_by[address] = self.summary.made_by.get(address, 0) + 1

    def _close_failed(self, index: int, message: str) -> None:
        self._open.discard(index)
        self._there[index] = False
        self._entry_failed(f"{self._manifest.path}:{self._manifest.entries[index].line}: {message}")

    def _entry_failed(self, message: str) -> None:
        self.summary.failed += 1
        self.summary.warnings.append(message)
        self._say(message)
