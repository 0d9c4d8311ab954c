"""What submitted work still uses. Python's memory given to the device must outlive the work, whoever lets go of it."""
from __future__ import annotations

import atexit
import contextlib
import itertools
import os
from collections.abc import Iterator
from typing import Any, Union

from . import _native

# By the order of submission. No lock: finalizers and signal handlers submit work, too, and may come in the middle of any line here;
# each operation on the dictionary is one step.
_flying: dict[int, tuple[Union[_native.Event, _native.Settling], tuple[Any, ...]]] = {}
_numbers = itertools.count()


@contextlib.contextmanager
def kept(device: _native.Device, *used: Any) -> Iterator[None]:
    """Keeps `used` alive where Ctrl-C, or another exception, leaves a call behind that still works on it."""
    try:
        yield
    except BaseException:
        hold(device.settle(), *used)
        raise


def hold(event: Union[_native.Event, _native.Settling], *used: Any) -> None:
    """Keeps `used` alive until `event` is done."""
    sweep()
    _flying[next(_numbers)] = (event, used)


def sweep() -> None:
    """Lets go of what finished work used."""
    for number, entry in _flying.copy().items():
        if _finished(entry[0]):
            _flying.pop(number, None)


def in_flight() -> int:
    """How many submissions have not finished, as far as the last look."""
    sweep()
    return len(_flying)


def _finished(event: Union[_native.Event, _native.Settling]) -> bool:
    try:
        return event.is_done()
    except Exception:  # failed work uses nothing any more; whoever waits for it gets the error
        return True


@atexit.register
def _land() -> None:
    for event, _ in _flying.copy().values():
        try:
            event.wait()
        except KeyboardInterrupt:  # asked twice: no more waiting, nor an end that frees what kernels still write to
            os._exit(130)
        except Exception:
            pass
    sweep()
