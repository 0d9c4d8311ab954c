"""What a worker answered: whether it has the form that was agreed on, and whether its files are there."""
from __future__ import annotations

from typing import Any

from . import worker as work
from .manifest import Manifest
from .store import Store

FILE_THERE = (work.MADE, work.KEPT, work.REDONE)
WITH_MESSAGE = (work.BAD, work.NO_ROOM, work.DEVICE_FAILED, work.NO_STORE)


def _has_form(manifest: Manifest, index: int, answer: dict[str, Any]) -> bool:
    what = answer["what"]
    if what in FILE_THERE:
        return answer["file"] == manifest.entries[index].file and isinstance(answer["sum"], str) and len(answer["sum"]) == 64
    return what == work.NO_MANIFEST or what in WITH_MESSAGE and isinstance(answer["message"], str)


def sort_out(manifest: Manifest, indices: list[int], answers: Any) -> tuple[list[dict[str, Any]], list[int]]:
    """The answers of the form agreed on, and the entries without one."""
    good, bad = [], []
    try:
        by_index = {a["index"]: a for a in answers}
        if len(answers) != len(indices) or set(by_index) != set(indices):
            return [], indices
        for i in indices:
            if _has_form(manifest, i, by_index[i]):
                good.append(by_index[i])
            else:
                bad.append(i)
    except Exception:  # nothing of that form at all
        return [], indices
    return good, bad


def vouched_for(answers: list[dict[str, Any]], sums: Any) -> list[Any]:
    """For each answer of a writer what a reader says of the file: True where it found the writer's sum, None where it found no
    such file, else False."""
    if not isinstance(sums, list) or len(sums) != len(answers):
        return [False] * len(answers)
    return [None if s is None else isinstance(s, str) and s == a["sum"] for a, s in zip(answers, sums)]


def is_there(manifest: Manifest, store: Store, answer: dict[str, Any]) -> bool:
    """Reads the file and compares.

    Raises
    ------
    StoreError
        The output cannot be read.
    """
    return work.read_entry(manifest, answer["index"], store) == answer["sum"]
