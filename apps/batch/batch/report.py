"""Results of a batch, and its progress on standard error."""
from __future__ import annotations

import sys
import time
from collections import deque
from dataclasses import asdict, dataclass, field
from typing import Any


class BatchError(Exception):
    """The batch stopped: the output is full or gone, or no worker is left. `summary` says how far it came."""

    summary: Summary


class NoWorker(BatchError):
    """There is no scheduler, or no worker for too long."""


@dataclass
class Summary:
    """Counts of a batch; `failed` are entries that make no sense, or that no worker could make."""

    entries: int = 0
    made: int = 0
    kept: int = 0
    redone: int = 0  # of `made`: in place of a file that was damaged
    duplicates: int = 0
    failed: int = 0
    retried: int = 0  # pieces of work that a worker lost, garbled or sat on, given to another
    workers_lost: int = 0
    workers_dismissed: int = 0  # hung, or gave garbage
    total_ms: float = 0.0
    per_second: float = 0.0
    made_by: dict[str, int] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)


class Display:
    """Rate and time left: in place on a terminal, a line every ten seconds elsewhere."""

    def __init__(self, total: int, quiet: bool) -> None:
        self._total, self._quiet, self._terminal = total, quiet, sys.stderr.isatty()
        self._start = self._spoken = time.monotonic()
        self._past = deque([(self._start, 0)])

    def message(self, text: str) -> None:
        if not self._quiet:
            print(("\r\033[K" if self._terminal else "") + text, file=sys.stderr, flush=True)

    def show(self, done: int, last: bool = False) -> None:
        now = time.monotonic()
        if self._quiet or now - self._start < 0.5 or not last and now - self._spoken < (
            0.1 if self._terminal else 10):
            return
        self._spoken = now
        self._past.append((now, done))
        while len(self._past) > 2 and now - self._past[1][0] > 10:  # the rate of the last ten seconds
            self._past.popleft()
        then, before = (self._start, 0) if last else self._past[0]
        rate = (done - before) / max(now - then, 1e-3)
        left = f", {(self._total - done) / rate:.0f} s left" if rate > 0 and not last else ""
        print(f"{chr(13) if self._terminal else ''}{done} of {self._total}, {rate:.1f} per second{left}",
              file=sys.stderr, end="   " if self._terminal and not last else "\n", flush=True)
