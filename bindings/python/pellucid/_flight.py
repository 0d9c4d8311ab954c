"""What submitted work still uses. Python's memory given to the device must outlive the work, whoever lets go of it."""
from __future__ import annotations

import atexit
import threading
from typing import Any

from . import _native

_lock = threading.Lock()
_flying: list[tuple[_native.Event, tuple[Any, ...]]] = []


def hold(event: _native.Event, *used: Any) -> None:
    """Keeps `used` alive until `event` is done."""
    sweep()
    with _lock:
        _flying.append((event, used))


def sweep() -> None:
    """Lets go of what finished work used."""
    with _lock:
        running = [entry for entry in _flying if not _finished(entry[0])]
        finished, _flying[:] = _flying[:], running
    del finished  # outside the lock: dropping an object may run any code


def in_flight() -> int:
    """How many submissions have not finished, as far as the last look."""
    sweep()
    return len(_flying)


def _finished(event: _native.Event) -> bool:
    try:
        return event.is_done()
    except Exception:  # failed work uses nothing any more; whoever waits for it gets the error
        return True


@atexit.register
def _land() -> None:
    for event, _ in list(_flying):
        try:
            event.wait()
        except Exception:
            pass
    sweep()
