"""Shares the entries of a manifest out among the workers of a Dask cluster, and believes none of them.

Each piece of work is pinned to one worker, so that it is known who has what since when: what a worker loses, garbles or sits on
goes to another. Files are named by content and appear whole, so that doing an entry twice changes nothing; an entry counts
once, when its file has been read back.
"""
from __future__ import annotations

import contextlib
import hashlib
import itertools
import pickle
import queue
import threading
import time
import uuid
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Optional

from . import worker as work
from .manifest import Manifest
from .report import BatchError, Display, Summary
from .store import Store, StoreError

PIECE_SECONDS = 0.5  # what a piece should take: long against Dask's milliseconds, short against a lost one
LARGEST_PIECE = 256  # entries
ATTEMPTS = 3  # of an entry by itself, before it is to blame for the workers that it costs


@dataclass
class _Worker:
    address: str
    threads: int
    pieces: dict[Any, list[int]] = field(default_factory=dict)  # future: entries
    since: float = 0.0  # when it last showed life, or got work after having none
    entry_seconds: Optional[float] = None
    has_manifest: bool = False


class Dispatcher:
    """One batch on one cluster; `run` does it."""

    def __init__(self, client: Any, manifest: Manifest, store: Store, *, timeout: float, jobs: int, patience: float,
                 read_back: bool, device: str, display: Display) -> None:
        self._client, self._manifest, self._store, self._display = client, manifest, store, display
        self._timeout, self._jobs, self._patience, self._device = timeout, jobs, patience, device
        self._read_back = read_back
        self._packed = pickle.dumps(manifest)
        self._digest = hashlib.sha256(self._packed).hexdigest()
        self._pending: deque[list[int]] = deque([list(range(len(manifest)))])
        self._open = set(range(len(manifest)))  # entries that nobody has finished
        self._attempts: dict[int, int] = {}
        self._workers: dict[str, _Worker] = {}
        self._dismissed: dict[str, str] = {}  # address: why
        self._events: queue.SimpleQueue[tuple[Any, ...]] = queue.SimpleQueue()
        self._names = (f"pellucid-{uuid.uuid4().hex[:8]}-{n}" for n in itertools.count())
        self._readers = ThreadPoolExecutor(8)
        self._last_trouble = ""
        self.summary = Summary(entries=len(manifest), duplicates=manifest.duplicates)

    def run(self) -> Summary:
        """Returns when every entry is done or has failed.

        Raises
        ------
        BatchError
            The output is full or gone, or there was no worker for longer than `patience`.
        """
        start = looked = alone = time.monotonic()
        for line, message in self._manifest.errors:
            self._entry_failed(message)
        try:
            self._look_for_workers()
            while self._open:
                now = time.monotonic()
                if now - looked > 0.5:
                    self._look_for_workers()
                    self._look_for_hung(now)
                    looked = now
                if self._usable():
                    alone = now
                elif now - alone > self._patience:
                    why = f"; the last trouble was: {self._last_trouble}" if self._last_trouble else ""
                    raise BatchError(f"no worker for {self._patience:.0f} s{why}")
                self._hand_out(now)
                self._display.show(self.summary.entries - len(self._open))
                with contextlib.suppress(queue.Empty):
                    self._handle(*self._events.get(timeout=0.1))
                    while True:
                        self._handle(*self._events.get_nowait())
        except BatchError as e:
            e.summary = self.summary
            raise
        finally:
            for worker in self._workers.values():
                self._client.cancel(list(worker.pieces), force=True)
            self._readers.shutdown(cancel_futures=True)
            self.summary.total_ms = 1e3 * (time.monotonic() - start)
            self.summary.per_second = self.summary.made / max(time.monotonic() - start, 1e-9)
            self._display.show(self.summary.entries - len(self._open), last=True)
        return self.summary

    def _usable(self) -> list[_Worker]:
        return [w for w in self._workers.values() if w.address not in self._dismissed]

    # --- workers come and go ---

    def _look_for_workers(self) -> None:
        present = self._client.nthreads()
        for address, threads in present.items():
            if address not in self._workers:
                self._workers[address] = _Worker(address, threads)
        for address in set(self._workers) - set(present):
            gone = self._workers.pop(address)
            if self._dismissed.pop(address, None) is None:
                self.summary.workers_lost += 1
                self._trouble(f"worker {address} is gone")
            self._take_back(gone)

    def _look_for_hung(self, now: float) -> None:
        for worker in self._usable():
            if worker.pieces and now - worker.since > self._timeout:
                self._dismiss(worker, f"worker {worker.address} did nothing for {self._timeout:g} s")

    def _dismiss(self, worker: _Worker, why: str) -> None:
        """Gives it no more work; a nanny, where there is one, puts a fresh process in its place."""
        if worker.address in self._dismissed:
            return
        self._dismissed[worker.address] = why
        self.summary.workers_dismissed += 1
        self._trouble(why)
        self._take_back(worker)

        def restart() -> None:
            with contextlib.suppress(Exception):
                self._client.restart_workers([worker.address], timeout=30, raise_for_error=False)

        threading.Thread(target=restart, daemon=True).start()

    def _take_back(self, worker: _Worker) -> None:
        pieces, worker.pieces = worker.pieces, {}
        if pieces:
            self._client.cancel(list(pieces), force=True)
        for indices in pieces.values():
            self._again(indices)

    def _trouble(self, message: str) -> None:
        self._last_trouble = message
        self._display.message(message)

    # --- work goes out ---

    def _hand_out(self, now: float) -> None:
        usable = self._usable()
        for worker in sorted(usable, key=lambda w: len(w.pieces)):
            while self._pending and len(worker.pieces) <= worker.threads:  # one waits while the others run
                indices = self._next_piece(worker, len(usable))
                if not indices:
                    break
                packed = None if worker.has_manifest else self._packed
                worker.has_manifest = True
                future = self._client.submit(work.make_entries, self._digest, packed, indices, self._store.out, self._device,
                                             self._jobs, key=next(self._names), workers=[worker.address],
                                             allow_other_workers=False, pure=False, retries=0)
                if not worker.pieces:
                    worker.since = now
                worker.pieces[future] = indices
                address, sent = worker.address, time.monotonic()
                future.add_done_callback(lambda f, a=address, s=sent: self._events.put(("answered", a, f, s)))

    def _next_piece(self, worker: _Worker, workers: int) -> list[int]:
        size = 4 if worker.entry_seconds is None else int(PIECE_SECONDS / max(worker.entry_seconds, 1e-6))
        size = max(1, min(size, LARGEST_PIECE, -(-len(self._open) // (2 * workers))))
        while self._pending:
            head = self._pending.popleft()
            piece, rest = head[:size], head[size:]
            if rest:
                self._pending.appendleft(rest)
            piece = [i for i in piece if i in self._open]  # a late answer may have closed some
            if piece:
                return piece
        return []

    def _again(self, indices: list[int]) -> None:
        """Hands entries out once more, in halves: one of them may be what costs the workers."""
        indices = [i for i in indices if i in self._open]
        if not indices:
            return
        self.summary.retried += 1
        if len(indices) > 1:
            middle = len(indices) // 2
            self._pending.append(indices[:middle])
            self._pending.append(indices[middle:])
            return
        (index,) = indices
        self._attempts[index] = self._attempts.get(index, 0) + 1
        if self._attempts[index] < ATTEMPTS:
            self._pending.append(indices)
        else:
            self._close_failed(index, f"given up after {ATTEMPTS} attempts; the last trouble was: {self._last_trouble}")

    # --- answers come in ---

    def _handle(self, what: str, *details: Any) -> None:
        getattr(self, "_" + what)(*details)

    def _answered(self, address: str, future: Any, sent: float) -> None:
        worker = self._workers.get(address)
        if worker is None or future not in worker.pieces:
            return  # taken back before
        indices = worker.pieces.pop(future)
        now = time.monotonic()
        began, worker.since = max(worker.since, sent), now
        if future.status != "finished":
            error = future.exception() if future.status == "error" else None
            self._trouble(f"worker {address}: {type(error).__name__}: {error}" if error else f"worker {address} lost work")
            self._again(indices)
            if error is not None and "KilledWorker" not in type(error).__name__:
                self._dismiss(worker, f"worker {address} cannot work: {error}")
            return
        worker.entry_seconds = max(now - began, 1e-6) / len(indices)
        try:
            answers = future.result()
        except Exception as e:  # what came cannot even be unpickled
            answers = f"{type(e).__name__}: {e}"
        self._readers.submit(self._check, address, indices, answers)

    def _check(self, address: str, indices: list[int], answers: Any) -> None:
        """On a reader's thread: which of the answers are true."""
        good, bad = [], []
        try:
            by_index = {a["index"]: a for a in answers}
            if len(answers) != len(indices) or set(by_index) != set(indices):
                raise ValueError
            for i in indices:
                (good if self._is_true(i, by_index[i]) else bad).append(by_index[i])
            self._events.put(("checked", address, good, [a["index"] for a in bad]))
        except StoreError as e:
            self._events.put(("no_store", str(e)))
        except Exception:  # nothing of the form that was agreed on
            self._events.put(("checked", address, [], indices))

    def _is_true(self, index: int, answer: dict[str, Any]) -> bool:
        what = answer["what"]
        if what in (work.BAD, work.NO_ROOM, work.DEVICE_FAILED, work.NO_STORE):
            return isinstance(answer["message"], str)
        if what == work.NO_MANIFEST:
            return True
        if what not in (work.MADE, work.KEPT, work.REDONE) or answer["file"] != self._manifest.entries[index].file:
            return False
        if not self._read_back:
            return len(answer["sum"]) == 64
        data = self._store.read(answer["file"])
        return data is not None and hashlib.sha256(data).hexdigest() == answer["sum"] and self._manifest.holds(index, data)

    def _checked(self, address: str, good: list[dict[str, Any]], bad: list[int]) -> None:
        worker = self._workers.get(address)
        failed_here, broken = [], 0
        for answer in good:
            index, what = answer["index"], answer["what"]
            if index not in self._open:
                continue  # another worker was as quick
            if what == work.NO_STORE:
                raise BatchError(answer["message"])
            if what == work.BAD:
                self._close_failed(index, answer["message"])
            elif what in (work.NO_ROOM, work.DEVICE_FAILED):  # another device may do it
                failed_here.append(index)
                broken += what == work.DEVICE_FAILED
                self._last_trouble = answer["message"]
            elif what == work.NO_MANIFEST:
                self._pending.append([index])
                if worker:
                    worker.has_manifest = False
            else:
                self._open.discard(index)
                if what == work.KEPT:
                    self.summary.kept += 1
                else:
                    self.summary.made += 1
                    self.summary.redone += what == work.REDONE
                    self.summary.made_by[address] = self.summary.made_by.get(address, 0) + 1
        self._again(failed_here)
        self._again(bad)
        if worker and bad:
            self._dismiss(worker, f"worker {address} gave garbage for {len(bad)} entries")
        elif worker and broken and broken == len(good):
            self._dismiss(worker, f"worker {address}: its device fails: {self._last_trouble}")

    def _no_store(self, message: str) -> None:
        raise BatchError(message)

    def _close_failed(self, index: int, message: str) -> None:
        self._open.discard(index)
        self._entry_failed(f"{self._manifest.path}:{self._manifest.entries[index].line}: {message}")

    def _entry_failed(self, message: str) -> None:
        self.summary.failed += 1
        self.summary.warnings.append(message)
        self._display.message(message)
