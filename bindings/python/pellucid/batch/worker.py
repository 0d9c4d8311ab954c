"""What runs on a worker: some entries of a manifest, from integration to the file, and the reading of what others wrote."""
from __future__ import annotations

import hashlib
import os
import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Optional

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
MADE, KEPT, REDONE, BAD, NO_ROOM = "made", "kept", "redone", "bad", "no room"
DEVICE_FAILED, NO_STORE, NO_MANIFEST = "device failed", "no store", "no manifest"


class UnfitWorker(Exception):
    """This process can make no entry at all, and a fresh one in its place could not either."""


def device_of(selector: str) -> Device:
    """This process's device of that name, opened once."""
    with _lock:
        if selector not in _devices:
            _devices[selector] = Device(selector)
        return _devices[selector]


def manifest_of(digest: str, packed: Optional[bytes], version: str) -> Optional[Manifest]:
    """The manifest of that digest, read once; None if it was not sent yet."""
    if version != __version__:  # every name of a file would differ
        raise UnfitWorker(f"it has pellucid {__version__} where the batch was started with {version}: install that one there")
    with _lock:
        if digest not in _manifests and packed is not None:
            _manifests.clear()  # one batch at a time
            _manifests[digest] = pickle.loads(packed)
        return _manifests.get(digest)


def make_entry(manifest: Manifest, index: int, store: Store, device: Device) -> dict[str, Any]:
    """Makes one entry unless its file is there and whole."""
    entry = manifest.entries[index]
    result: dict[str, Any] = {"index": index, "file": entry.file}
    try:
        old = store.read(entry.file)
        if old is not None and manifest.holds(index, old):
            return {**result, "what": KEPT, "sum": hashlib.sha256(old).hexdigest()}
        data = manifest.make(device, index)
        store.write(entry.file, data)
        return {**result, "what": MADE if old is None else REDONE, "sum": hashlib.sha256(data).hexdigest()}
    except StoreError as e:
        return {**result, "what": NO_STORE, "message": str(e)}
    except PellucidError as e:
        what = {ErrorCode.DEVICE: DEVICE_FAILED, ErrorCode.NO_DEVICE: DEVICE_FAILED, ErrorCode.UNKNOWN: DEVICE_FAILED,
                ErrorCode.OUT_OF_MEMORY: NO_ROOM}.get(e.code, BAD)
        return {**result, "what": what, "message": str(e)}


def read_entry(manifest: Manifest, index: int, store: Store) -> Optional[str]:
    """The check sum of an entry's file, read now; None if it is not there, or not that entry whole and unchanged."""
    data = store.read(manifest.entries[index].file)
    return hashlib.sha256(data).hexdigest() if data is not None and manifest.holds(index, data) else None


def _each(indices: list[int], jobs: int, do: Callable[[int], Any]) -> list[Any]:
    """Several at a time: one integrates while another waits for the disk or the store."""
    with ThreadPoolExecutor(min(len(indices), jobs or 4 * (os.cpu_count() or 1), 256)) as pool:
        return list(pool.map(do, indices))


def make_entries(digest: str, packed: Optional[bytes], version: str, indices: list[int], out: str, selector: str,
                 jobs: int) -> list[dict[str, Any]]:
    """Makes entries; what happened to each."""
    manifest, store = manifest_of(digest, packed, version), Store(out)
    if manifest is None:
        return [{"index": i, "file": "", "what": NO_MANIFEST} for i in indices]
    try:
        device = device_of(selector)
    except PellucidError as e:
        if e.code == ErrorCode.NO_DEVICE:
            raise UnfitWorker(str(e)) from None
        return [{"index": i, "file": manifest.entries[i].file, "what": DEVICE_FAILED, "message": str(e)} for i in indices]
    return _each(indices, jobs, lambda i: make_entry(manifest, i, store, device))


def read_entries(digest: str, packed: Optional[bytes], version: str, indices: list[int], out: str,
                 jobs: int) -> list[Optional[str]]:
    """Check sums of files that another worker wrote; None for those that cannot be vouched for from here."""
    manifest, store = manifest_of(digest, packed, version), Store(out)

    def read(index: int) -> Optional[str]:
        try:
            return None if manifest is None else read_entry(manifest, index, store)
        except StoreError:
            return None

    return _each(indices, jobs, read)
