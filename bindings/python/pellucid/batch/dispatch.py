"""Shares the entries of a manifest out among the workers of a Dask cluster, and believes none of them.

Each piece of work is pinned to one worker, so that it is known who has what since when: what a worker loses, garbles or sits on
goes to another. Files are named by content and appear whole, so that doing an entry twice changes nothing; an entry counts
once, when its file has been read back: by a worker that did not write it, whose check sum must be the writer's. Where the two
differ, or there is no second worker, this process reads the file and decides which of them is wrong.
"""
from __future__ import annotations

import asyncio
import contextlib
import hashlib
import itertools
import pickle
import queue
import random
import threading
import time
import uuid
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Callable, Optional

from .. import __version__
from . import worker as work
from .answers import is_there, sort_out, vouched_for
from .manifest import Manifest
from .report import BatchError, Display, NoWorker, Summary
from .store import Store, StoreError

PIECE_SECONDS = 0.5  # what a piece should take: long against Dask's milliseconds, short against a lost one
LARGEST_PIECE = 1024  # entries
ATTEMPTS = 3  # of an entry by itself, before it is to blame for the workers that it costs
# A scheduler needs no package of ours to pass this on, and a worker without it says what it lacks instead of dying of what it reads.
CALL = "getattr(__import__('pellucid.batch.worker', fromlist=['worker']), task)(*arguments)"
ASK_AGAIN_SECONDS = 20  # a cluster that was asked for workers is asked for those that it lost; above Dask's 15 to notice


@dataclass
class _Piece:
    """Entries to make or, where there is a writer, files of that one to read."""

    indices: list[int]
    writer: str = ""
    answers: list[dict[str, Any]] = field(default_factory=list)  # the writer's
    tries: int = 0


@dataclass
class _Worker:
    address: str
    threads: int
    pieces: dict[Any, _Piece] = field(default_factory=dict)  # by future
    making: int = 0  # of `pieces`
    since: float = 0.0  # when it last showed life, or got work after having none
    entry_seconds: Optional[float] = None
    has_manifest: bool = False


class Dispatcher:
    """One batch on one cluster; `run` does it."""

    def __init__(self, client: Any, manifest: Manifest, store: Store, *, timeout: float, jobs: int, patience: float,
                 read_back: bool, device: str, display: Display, ask: Optional[Callable[[], None]] = None) -> None:
        self._client, self._manifest, self._store, self._display = client, manifest, store, display
        self._timeout, self._jobs, self._patience, self._device = timeout, jobs, patience, device
        self._read_back, self._ask = read_back, ask
        self._address = client.scheduler.address
        self._packed = pickle.dumps(manifest)
        self._digest = hashlib.sha256(self._packed).hexdigest()
        self._pending: deque[list[int]] = deque([list(range(len(manifest)))])
        self._open = set(range(len(manifest)))  # entries that nobody has finished
        self._attempts: dict[int, int] = {}
        self._workers: dict[str, _Worker] = {}
        self._usable: list[_Worker] = []
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
            The output is full or gone; NoWorker: the scheduler is gone, or no worker came for longer than `patience`.
        """
        start = looked = alone = asked = time.monotonic()
        for _, message in self._manifest.errors:
            self._entry_failed(message)
        try:
            self._look_for_workers()
            while self._open:
                now = time.monotonic()
                if now - looked > 0.5:
                    self._look_for_workers()
                    self._look_for_hung(now)
                    looked = now
                if self._ask and now - asked > ASK_AGAIN_SECONDS:
                    self._ask()
                    asked = now
                if self._usable:
                    alone = now
                elif now - alone > self._patience:
                    why = f"; the last trouble was: {self._last_trouble}" if self._last_trouble else ""
                    raise NoWorker(f"no worker for {self._patience:.0f} s{why}")
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
            self._readers.shutdown(wait=False, cancel_futures=True)
            with contextlib.suppress(Exception):  # the scheduler may be gone
                self._client.cancel([f for worker in self._workers.values() for f in worker.pieces], force=True)
            self.summary.total_ms = 1e3 * (time.monotonic() - start)
            self.summary.per_second = self.summary.made / max(time.monotonic() - start, 1e-9)
            self._display.show(self.summary.entries - len(self._open), last=True)
        return self.summary

    # --- workers come and go ---

    def _look_for_workers(self) -> None:
        try:
            present = self._client.nthreads()
        except (OSError, TimeoutError, asyncio.TimeoutError) as e:
            raise NoWorker(f"the scheduler {self._address} does not answer any more ({e}); what is made is kept, and the same call goes on from "
                           "there when a scheduler is back") from e
        for address, threads in present.items():
            if address not in self._workers:
                self._workers[address] = _Worker(address, threads)
        gone = [self._workers.pop(address) for address in set(self._workers) - set(present)]
        for worker in gone:
            if self._dismissed.pop(worker.address, None) is None:
                self.summary.workers_lost += 1
                self._trouble(f"worker {worker.address} is gone")
        self._usable = [w for w in self._workers.values() if w.address not in self._dismissed]
        for worker in gone:
            self._take_back(worker)

    def _look_for_hung(self, now: float) -> None:
        for worker in list(self._usable):
            if worker.pieces and now - worker.since > self._timeout:
                self._dismiss(worker, f"worker {worker.address} did nothing for {self._timeout:g} s")

    def _dismiss(self, worker: _Worker, why: str, restart: bool = True) -> None:
        """Gives it no more work; a nanny, where there is one, puts a fresh process in its place unless that would be no better."""
        if worker.address in self._dismissed:
            return
        self._dismissed[worker.address] = why
        self._usable = [w for w in self._usable if w is not worker]
        self.summary.workers_dismissed += 1
        self._trouble(why)
        self._take_back(worker, blamed=restart)

        def renew() -> None:
            with contextlib.suppress(Exception):
                self._client.restart_workers([worker.address], timeout=30, raise_for_error=False)

        if restart:
            threading.Thread(target=renew, daemon=True).start()

    def _take_back(self, worker: _Worker, blamed: bool = True) -> None:
        pieces, worker.pieces, worker.making = worker.pieces, {}, 0
        if pieces:
            self._client.cancel(list(pieces), force=True)
        for piece in pieces.values():
            self._lost(piece, blamed)

    def _lost(self, piece: _Piece, blamed: bool = True) -> None:
        """Gives a piece to another worker. `blamed`: something in it may be why."""
        if piece.writer:
            piece.tries += 1
            self._have_read(piece)
        elif blamed:
            self._again(piece.indices)
        else:
            self._pending.appendleft(piece.indices)

    def _trouble(self, message: str) -> None:
        self._last_trouble = message
        self._display.message(message)

    # --- work goes out ---

    def _hand_out(self, now: float) -> None:
        for worker in sorted(self._usable, key=lambda w: w.making):
            while self._pending and worker.making <= worker.threads:  # one waits while the others run
                indices = self._next_piece(worker, len(self._usable))
                if not indices:
                    break
                self._submit(worker, _Piece(indices), work.make_entries.__name__, self._device, self._jobs)

    def _submit(self, worker: _Worker, piece: _Piece, task: str, *arguments: Any) -> None:
        packed = None if worker.has_manifest else self._packed
        worker.has_manifest = True
        arguments = (self._digest, packed, __version__, piece.indices, self._store.out, *arguments)
        future = self._client.submit(eval, CALL, {"task": task, "arguments": arguments}, key=next(self._names),
                                     workers=[worker.address], allow_other_workers=False, pure=False, retries=0,
                                     priority=1 if piece.writer else 0)
        sent = time.monotonic()
        if not worker.pieces:
            worker.since = sent
        worker.pieces[future] = piece
        worker.making += not piece.writer

        async def fetch() -> None:
            try:
                result = await self._client.gather(future, asynchronous=True)
            except (Exception, asyncio.CancelledError) as e:  # also what cannot be unpickled
                result = e
            self._events.put(("answered", worker.address, future, sent, time.monotonic(), result))

        # A worker that stops answering between its work and this must not stop the others.
        self._client.loop.add_callback(fetch)

    def _have_read(self, piece: _Piece) -> None:
        """Finds a reader for files that a worker wrote: another one, on another machine where there is one, else this process."""
        others = [w for w in random.sample(self._usable, min(4, len(self._usable))) if w.address != piece.writer]
        if not others or piece.tries >= ATTEMPTS:
            self._readers.submit(self._judge, piece.writer, piece.answers)
            return
        machine = piece.writer.rpartition(":")[0]
        reader = min(others, key=lambda w: (w.address.rpartition(":")[0] == machine, len(w.pieces)))
        self._submit(reader, piece, work.read_entries.__name__, self._jobs)

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

    def _answered(self, address: str, future: Any, sent: float, now: float, result: Any) -> None:
        worker = self._workers.get(address)
        if worker is None or future not in worker.pieces:
            return  # taken back before
        piece = worker.pieces.pop(future)
        worker.making -= not piece.writer
        began, worker.since = max(worker.since, sent), now
        if isinstance(result, BaseException):
            self._raised(worker, piece, result, future.status)
        elif piece.writer:
            self._compare(address, piece, result)
        else:
            worker.entry_seconds = max(now - began, 1e-6) / len(piece.indices)
            self._made(worker, piece, result)

    def _raised(self, worker: _Worker, piece: _Piece, error: BaseException, status: str) -> None:
        if status != "error" or "KilledWorker" in type(error).__name__:
            self._trouble(f"worker {worker.address} lost work")
            self._lost(piece)
        elif isinstance(error, (work.UnfitWorker, ImportError)):  # no entry is to blame, and a restart is no help
            hint = " (install pellucid[batch] in the environment of the workers)" if isinstance(error, ImportError) else ""
            self._dismiss(worker, f"worker {worker.address} gets no work: {error}{hint}", restart=False)
            self._lost(piece, blamed=False)
        else:
            self._dismiss(worker, f"worker {worker.address} cannot work: {type(error).__name__}: {error}")
            self._lost(piece)

    def _made(self, worker: _Worker, piece: _Piece, answers: Any) -> None:
        good, bad = sort_out(self._manifest, piece.indices, answers)
        written, failed_here, broken = [], [], 0
        for answer in good:
            index, what = answer["index"], answer["what"]
            if index not in self._open:
                continue  # another worker was as quick
            if what == work.NO_STORE:
                raise BatchError(f"worker {worker.address}: {answer['message']}")
            if what == work.BAD:
                self._close_failed(index, answer["message"])
            elif what in (work.NO_ROOM, work.DEVICE_FAILED):  # another device may do it
                failed_here.append(index)
                broken += what == work.DEVICE_FAILED
                self._last_trouble = answer["message"]
            elif what == work.NO_MANIFEST:
                self._pending.append([index])
                worker.has_manifest = False
            else:
                written.append(answer)
        self._again(failed_here)
        self._again(bad)
        if bad:
            self._dismiss(worker, f"worker {worker.address} gave garbage for {len(bad)} entries: no answer of a known form")
        elif broken and broken == len(good):
            self._dismiss(worker, f"worker {worker.address}: its device fails: {self._last_trouble}")
        if written and self._read_back:
            self._have_read(_Piece([a["index"] for a in written], worker.address, written))
        elif written:
            self._close(worker.address, written)

    # --- no worker is believed ---

    def _compare(self, reader: str, piece: _Piece, sums: Any) -> None:
        said = vouched_for(piece.answers, sums)
        self._close(piece.writer, [a for a, s in zip(piece.answers, said) if s])
        doubtful = [(a, s) for a, s in zip(piece.answers, said) if not s]
        if doubtful:
            self._readers.submit(self._judge, piece.writer, [a for a, _ in doubtful], reader,
                                 {a["index"] for a, s in doubtful if s is False})

    def _judge(self, writer: str, answers: list[dict[str, Any]], reader: str = "", denied: Any = ()) -> None:
        """On a thread of this process, which reads the files itself. `denied`: where the reader claims another check sum."""
        try:
            there = [is_there(self._manifest, self._store, a) for a in answers]
        except StoreError as e:
            self._events.put(("no_store", str(e)))
        else:
            self._events.put(("judged", writer, [a for a, t in zip(answers, there) if t],
                              [a for a, t in zip(answers, there) if not t], reader, denied))

    def _judged(self, writer: str, good: list[dict[str, Any]], bad: list[dict[str, Any]], reader: str, denied: Any) -> None:
        self._close(writer, good)
        self._again([a["index"] for a in bad])
        if bad and writer in self._workers:
            self._dismiss(self._workers[writer], f"worker {writer} gave garbage for {len(bad)} entries: {bad[0]['file']} is not in "
                          f"{self._store.out}, or is not what it says that it wrote (all machines must see one and the same folder)")
        lies = sum(a["index"] in denied for a in good)
        if lies and reader in self._workers:
            self._dismiss(self._workers[reader], f"worker {reader} misread {lies} files of others, such as {good[0]['file']}")

    def _close(self, writer: str, answers: list[dict[str, Any]]) -> None:
        for answer in answers:
            if answer["index"] not in self._open:
                continue  # counts once
            self._open.discard(answer["index"])
            if answer["what"] == work.KEPT:
                self.summary.kept += 1
            else:
                self.summary.made += 1
                self.summary.redone += answer["what"] == work.REDONE
                self.summary.made_by[writer] = self.summary.made_by.get(writer, 0) + 1

    def _no_store(self, message: str) -> None:
        raise BatchError(message)

    def _close_failed(self, index: int, message: str) -> None:
        self._open.discard(index)
        self._entry_failed(f"{self._manifest.path}:{self._manifest.entries[index].line}: {message}")

    def _entry_failed(self, message: str) -> None:
        self.summary.failed += 1
        self.summary.warnings.append(message)
        self._display.message(message)
