"""The code of a worker: makes some entries of a manifest, from integration to the file."""
from __future__ import annotations

import functools
import hashlib
import os
import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as NothingYet

import distributed

from .. import __version__
from .._errors import PellucidError
from .._types import ErrorCode
from ..device import Device
from .manifest import Manifest
from .store import InTheWay, Store, StoreError

_lock = threading.Lock()

# What happened to an entry.
MADE, KEPT, REDONE, BAD = "made", "kept", "redone", "bad"
NO_ROOM, DEVICE_FAILED, NO_STORE = "no room", "device failed", "no store"
FILE_THERE = (MADE, KEPT, REDONE)
KINDS = (*FILE_THERE, BAD, NO_ROOM, DEVICE_FAILED, NO_STORE)


class UnfitWorker(Exception):
    """This process can make no entry at all, and a new process could not either."""


@functools.cache
def the_device() -> Device:
    """This process's device."""
    return Device("")


@functools.lru_cache(maxsize=1)  # one batch at a time
def manifest_of(name: str) -> Manifest:
    """The manifest that the scheduler keeps under this name."""
    manifest: Manifest = pickle.loads(distributed.Variable(name).get(timeout=60))
    return manifest


def make_entry(manifest: Manifest, index: int, store: Store, device: Device) -> tuple[int, str, str]:
    """Makes one entry unless its file is there and whole. Returns its index, what happened, and the file's
    check sum or what is wrong."""
    file = manifest.entries[index].file
    try:
        old = store.read(file)
        if old is not None and manifest.holds(index, old):
            return index, KEPT, hashlib.sha256(old).hexdigest()
        data = manifest.make(device, index)
        store.write(file, data)
        return index, MADE if old is None else REDONE, hashlib.sha256(data).hexdigest()
    except StoreError as e:
        return index, NO_STORE, str(e)
    except InTheWay as e:
        return index, BAD, str(e)
    except PellucidError as e:
        kinds = {ErrorCode.DEVICE: DEVICE_FAILED, ErrorCode.NO_DEVICE: DEVICE_FAILED,
                 ErrorCode.UNKNOWN: DEVICE_FAILED, ErrorCode.OUT_OF_MEMORY: NO_ROOM}
        return index, kinds.get(e.code, BAD), str(e)


def make_entries(name: str, version: str, indices: list[int], out: str, jobs: int,
                 timeout: float) -> list[tuple[int, str, str]]:
    """Makes entries, several at a time: one integrates while another waits for the disk or the store."""
    if version != __version__:  # every name of a file would differ
        raise UnfitWorker(f"it has pellucid {__version__} where the batch was started with {version}: "
                          f"install that one there")
    with _lock:
        manifest, store = manifest_of(name), Store(out)
        try:
            device = the_device()
        except PellucidError as e:
            if e.code == ErrorCode.NO_DEVICE:
                raise UnfitWorker(str(e)) from None
            return [(i, DEVICE_FAILED, str(e)) for i in indices]
    pool = ThreadPoolExecutor(min(len(indices), jobs or 4 * (os.cpu_count() or 1), 256))
    answers, patience = [], timeout
    for index, entry in [(i, pool.submit(make_entry, manifest, i, store, device)) for i in indices]:
        try:
            answers.append(entry.result(patience))
        except NothingYet:
            patience = 0  # the others had that long as well
            answers.append((index, DEVICE_FAILED, f"it did nothing for {timeout:g} s"))
    pool.shutdown(wait=False, cancel_futures=True)
    return answers
