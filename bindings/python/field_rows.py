"""Reads the rows of pellucid_fields.h."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

CONSTANTS = {
    "PEL_TINY": 1e-6,
    "PEL_HUGE": 1e18,
    "PEL_ABOVE_0": 1.401298464e-45,
    "PEL_FINITE": 3.402823466e38,
}


class Row(NamedTuple):
    """A field: its range, and its key, documentation and slider."""

    kind: str  # FLOAT, UINT, COLOR, FREE, FREE_UINT, VECTOR or MATRIX
    name: str  # in C
    default: float | tuple[float, ...] | None  # None: the identity matrix
    min: float
    max: float
    special: float | None
    unit: str
    key: str  # in files
    slider: tuple[str, float, float, float] | None  # label, min, max, step
    words: str


class Words(dict):
    """Words that have no value stand for themselves: types, and names of fields."""

    def __missing__(self, word: str) -> str:
        return word


def as_floats(value: Any) -> Any:
    """The integers in a value as floats."""
    if isinstance(value, tuple):
        return tuple(map(as_floats, value))
    return float(value) if isinstance(value, int) else value


def parse(path: str | Path) -> dict[str, list[Row]]:
    """The rows of each list, such as MATERIAL. They are evaluated as Python, which they nearly are."""
    text = re.sub(r"\\\n\s*", " ", Path(path).read_text(encoding="utf-8"))
    text = re.sub(r"(?<=\d)f\b", "", text)
    bodies = dict(re.findall(r"#define PEL_EACH_(\w+)_FIELD\(X\)(.*)", text))
    words = Words(CONSTANTS, PEL_NONE=None, PEL_IDENTITY=None, PEL_NO_SLIDER=None,
                  PEL_SLIDER=lambda *slider: slider, X=lambda *fields: [Row(*as_floats(fields))])

    def rows_of(name: str) -> list[Row]:
        separated = re.sub(r"\) (?=X\(|PEL_EACH_)", "), ", re.sub(r"\s+", " ", bodies[name]).strip())
        return sum(eval(f"[{separated}]", {}, words), [])

    for name in bodies:
        words[f"PEL_EACH_{name}_FIELD"] = lambda _, name=name: rows_of(name)
    return {name: rows_of(name) for name in bodies}


def describe(r: Row) -> str:
    """The range as the guide says it, such as "0 to 1, or -1"."""
    low, high = r.min, r.max
    if low <= -CONSTANTS["PEL_HUGE"]:
        text = ""
    elif high < CONSTANTS["PEL_HUGE"]:
        text = f"{low:g} to {high:g}"
    else:
        text = "> 0" if 0 < low <= CONSTANTS["PEL_TINY"] else f"≥ {low:g}"
    return f"{text}, or {r.special:g}" if r.special is not None else text
