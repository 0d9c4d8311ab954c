"""Results of a batch."""
from __future__ import annotations

from dataclasses import dataclass, field


class BatchError(Exception):
    """The batch stopped: the output is full or gone, or no worker is left. `summary` says how far it came."""

    summary: Summary


class NoWorker(BatchError):
    """There is no scheduler, or no worker for too long."""


@dataclass
class Summary:
    """Counts of a batch; `failed` are invalid entries, and entries that no worker could make."""

    entries: int = 0
    made: int = 0
    kept: int = 0
    redone: int = 0  # of `made`: in place of a file that was damaged
    duplicates: int = 0
    failed: int = 0
    retried: int = 0  # pieces that a worker lost, garbled or did not finish, given to another
    workers_lost: int = 0
    workers_dismissed: int = 0  # hung, or gave garbage
    total_ms: float = 0.0
    per_second: float = 0.0
    made_by: dict[str, int] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
