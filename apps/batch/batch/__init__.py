"""Batches of look-up tables: the manifests of `pellucid batch` (docs/guide/batch.md), here or on a cluster.

`python -m pellucid.batch MANIFEST --out DIR` makes what is missing; `run` does the same from Python. Names,
bytes and resumability are those of the command, so that either can finish what the other began.
"""
from .manifest import Entry, Manifest
from .report import BatchError, NoWorker, Summary
from .run import run
from .store import Store

__all__ = ["BatchError", "Entry", "Manifest", "NoWorker", "Store", "Summary", "run"]
