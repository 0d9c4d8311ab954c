"""Keeps Python's memory alive while submitted work, or a call that Ctrl-C has interrupted, still uses it.

Ctrl-C is noticed where a call reports its progress and while an event is waited for. All other long calls run
by `interruptible`.
"""
from __future__ import annotations

import atexit
import contextlib
import itertools
import os
import threading
from collections.abc import Iterator
from typing import Any, Callable, Optional, Union

from . import _native

# In the order of submission. Without a lock, because finalizers and signal handlers submit work, too, and may
# run in the middle of any line here; each operation on the dictionary is atomic.
_flying: dict[int, tuple[Union[_native.Event, _Call], tuple[Any, ...]]] = {}
_numbers = itertools.count()


class _Call:
    """A call on a thread of its own."""

    result: Any = None
    error: Optional[BaseException] = None

    def __init__(self, call: Callable[[], Any]) -> None:
        self._done, self._cancel = threading.Event(), _native.Cancel()
        threading.Thread(target=self._run, args=(call,), daemon=True).start()

    def _run(self, call: Callable[[], Any]) -> None:
        try:
            self._cancel.watch()
            self.result = call()
        except BaseException as error:
            self.error = error
        finally:
            self._done.set()

    def cancel(self) -> None:
        """Cancels the call at its next progress report, if there is one."""
        self._cancel.ask()

    def is_done(self) -> bool:
        return self._done.is_set()

    def wait(self) -> None:
        self._done.wait()  # signals come through


def interruptible(call: Callable[[], Any], *used: Any) -> Any:
    """Returns call(). Ctrl-C ends the wait: the call then goes on, and `used` lives until it is done.

    For calls of the library that may take long without reporting their progress. No signal reaches other
    threads than Python's main one.
    """
    if threading.current_thread() is not threading.main_thread():
        return call()
    running = _Call(call)
    try:
        running.wait()
    except BaseException:
        running.cancel()
        hold(running, *used)
        raise
    if running.error is not None:
        error, running.error = running.error, None
        raise error
    return running.result


@contextlib.contextmanager
def kept(device: _native.Device, *used: Any) -> Iterator[None]:
    """Keeps `used` alive if an error occurs after a part of the work was submitted."""
    try:
        yield
    except BaseException:
        hold(device.marker(), *used)
        raise


def hold(event: Union[_native.Event, _Call], *used: Any) -> None:
    """Keeps `used` alive until `event` is done."""
    sweep()
    _flying[next(_numbers)] = (event, used)


def sweep() -> None:
    """Releases the memory of finished work."""
    for number, entry in _flying.copy().items():
        if _finished(entry[0]):
            _flying.pop(number, None)


def in_flight() -> int:
    """The number of unfinished submissions at the last check."""
    sweep()
    return len(_flying)


def _finished(event: Union[_native.Event, _Call]) -> bool:
    try:
        return bool(event.is_done())
    except Exception:  # failed work uses nothing any more; whoever waits for it gets the error
        return True


@atexit.register
def _land() -> None:
    for event, _ in _flying.copy().values():
        try:
            event.wait()
        # asked twice: no more waiting, nor an end that frees what kernels still write to
        except KeyboardInterrupt:
            os._exit(130)
        except Exception:
            pass
    sweep()
