"""What runs on a worker: some entries of a manifest, from integration to the file."""
from __future__ import annotations

import hashlib
import os
import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as NothingYet
from typing import Any

import distributed

from .. import __version__
from .._errors import PellucidError
from .._types import ErrorCode
from ..device import Device
from .manifest import Manifest
from .store import Store, StoreError

_lock = threading.Lock()
_devices: dict[str, Device] = {}
_manifests: dict[str, Manifest] = {}

# What happened to an entry.
MADE, KEPT, REDONE, BAD = "made", "kept", "redone", "bad"
NO_ROOM, DEVICE_FAILED, NO_STORE = "no room", "device failed", "no store"
FILE_THERE = (MADE, KEPT, REDONE)
KINDS = (*FILE_THERE, BAD, NO_ROOM, DEVICE_FAILED, NO_STORE)


class UnfitWorker(Exception):
    """This process can make no entry at all, and a fresh one in its place could not either."""


def device_of(selector: str) -> Device:
    """This process's device of that name, opened once."""
    with _lock:
        if selector not in _devices:
            _devices[selector] = Device(selector)
        return _devices[selector]


def manifest_of(name: str, version: str) -> Manifest:
    """The manifest that the scheduler keeps under this name, read once."""
    if version != __version__:  # every name of a file would differ
        raise UnfitWorker(f"it has pellucid {__version__} where the batch was started with {version}: "
                          f"install that one there")
    with _lock:
        if name not in _manifests:
            _manifests.clear()  # one batch at a time
            _manifests[name] = pickle.loads(distributed.Variable(name).get(timeout=60))
        return _manifests[name]


def make_entry(manifest: Manifest, index: int, store: Store, device: Device) -> dict[str, Any]:
    """Makes one entry unless its file is there and whole."""
    entry = manifest.entries[index]
    try:
        old = store.read(entry.file)
        if old is not None and manifest.holds(index, old):
            return {"index": index, "what": KEPT, "sum": hashlib.sha256(old).hexdigest()}
        data = manifest.make(device, index)
        store.write(entry.file, data)
        return {"index": index, "what": MADE if old is None else REDONE,
                "sum": hashlib.sha256(data).hexdigest()}
    except StoreError as e:
        return {"index": index, "what": NO_STORE, "message": str(e)}
    except PellucidError as e:
        what = {ErrorCode.DEVICE: DEVICE_FAILED, ErrorCode.NO_DEVICE: DEVICE_FAILED,
                ErrorCode.UNKNOWN: DEVICE_FAILED,
                ErrorCode.OUT_OF_MEMORY: NO_ROOM}.get(e.code, BAD)
        return {"index": index, "what": what, "message": str(e)}


def make_entries(name: str, version: str, indices: list[int], out: str, jobs: int,
                 timeout: float) -> list[dict[str, Any]]:
    """Makes entries, several at a time: one integrates while another waits for the disk or the store.

    Returns what happened to each.
    """
    manifest, store = manifest_of(name, version), Store(out)
    try:
        device = device_of("")
    except PellucidError as e:
        if e.code == ErrorCode.NO_DEVICE:
            raise UnfitWorker(str(e)) from None
        return [{"index": i, "what": DEVICE_FAILED, "message": str(e)} for i in indices]
    pool = ThreadPoolExecutor(min(len(indices), jobs or 4 * (os.cpu_count() or 1), 256))
    answers: list[dict[str, Any]] = []
    waiting = [(i, pool.submit(make_entry, manifest, i, store, device)) for i in indices]
    patience = timeout
    for index, entry in waiting:
        try:
            answers.append(entry.result(patience))
        except NothingYet:
            patience = 0  # the others had that long as well
            answers.append({"index": index, "what": DEVICE_FAILED,
                            "message": f"it did nothing for {timeout:g} s"})
    pool.shutdown(wait=False, cancel_futures=True)
    return answers
