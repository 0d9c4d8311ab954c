"""Ctrl-C while Dask works."""
from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any


@contextlib.contextmanager
def held_interrupts() -> Iterator[Callable[[], None]]:
    """Yields a function that raises KeyboardInterrupt where Ctrl-C was pressed. Raised by the signal, it
    could end in a finalizer or a callback of Dask, where Python prints and drops it, or leave a cluster half
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
