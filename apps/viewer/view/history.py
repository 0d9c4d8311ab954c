"""Undo and redo of all that the page can change: settings, both sides of the comparison, and the camera."""
from __future__ import annotations

import copy
import time
from typing import Any, Optional

KEPT = "look", "other", "against", "wipe", "beside", "orbit", "settings"  # of a session
PAUSE = 0.5  # seconds without a change, after which the next one is a step of its own
MOST = 200


class History:
    """The states of a session, one for each gesture."""

    def __init__(self, session: Any) -> None:
        self._undo: list[dict[str, Any]] = []
        self._redo: list[dict[str, Any]] = []
        self._now = self._state(session)
        self._last = 0.0

    @staticmethod
    def _state(session: Any) -> dict[str, Any]:
        return copy.deepcopy({name: getattr(session, name) for name in KEPT if hasattr(session, name)})

    def note(self, session: Any, now: Optional[float] = None) -> None:
        """Call after a change. Quickly following changes, such as those of a dragged slider, are one step."""
        now = time.monotonic() if now is None else now
        state = self._state(session)
        if state == self._now:
            return
        if now - self._last > PAUSE:
            self._undo = [*self._undo[1 - MOST:], self._now]
            self._redo.clear()
        self._now, self._last = state, now

    def _go(self, session: Any, back: list[dict[str, Any]], forth: list[dict[str, Any]]) -> bool:
        if not back:
            return False
        forth.append(self._now)
        self._now, self._last = back.pop(), 0.0
        for name, value in copy.deepcopy(self._now).items():
            setattr(session, name, value)
        return True

    def undo(self, session: Any) -> bool:
        """Whether there was something to undo."""
        return self._go(session, self._undo, self._redo)

    def redo(self, session: Any) -> bool:
        return self._go(session, self._redo, self._undo)
