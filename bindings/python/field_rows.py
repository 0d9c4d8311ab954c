"""Reads the rows of pellucid_fields.h."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

CONSTANTS = {
    "PEL_TINY": 1e-6,
    "PEL_HUGE": 1e18,
    "PEL_ABOVE_0": 1.401298464e-45,
    "PEL_FINITE": 3.402823466e38,
}
ROW = re.compile(
    r"X\((?P<kind>\w+), (?P<name>\w+), (?P<default>\([^)]*\)|[^,]+), (?P<min>[^,]+), (?P<max>[^,]+), "
    r'(?P<special>[^,]+), "(?P<unit>[^"]*)", "(?P<key>\w+)", '
    r"(?:PEL_NO_SLIDER|PEL_SLIDER\((?P<slider>[^)]*)\)), "
    r'(?P<words>"(?:[^"\\]|\\.)*"(?: "(?:[^"\\]|\\.)*")*)\)|PEL_EACH_(?P<list>\w+)_FIELD\(X\)')


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


def number(text: str) -> float:
    sign = -1 if text.startswith("-") else 1
    text = text.lstrip("-")
    return sign * (CONSTANTS[text] if text in CONSTANTS else float(text.removesuffix("f")))


def row(m: re.Match[str]) -> Row:
    default: float | tuple[float, ...] | None
    if m["default"].startswith("("):
        default = tuple(number(v.strip()) for v in m["default"].strip("()").split(","))
    else:
        default = None if m["default"] == "PEL_IDENTITY" else number(m["default"])
    slider = None
    if m["slider"]:
        label, *numbers = re.match(r'"([^"]*)", (.*)', m["slider"]).groups()
        low, high, step = (float(v) for v in numbers[0].split(","))
        slider = (label, low, high, step)
    words = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', m["words"])).replace('\\"', '"')
    special = None if m["special"] == "PEL_NONE" else number(m["special"])
    return Row(m["kind"], m["name"], default, number(m["min"]), number(m["max"]), special, m["unit"],
               m["key"], slider, words)


def parse(path: str | Path) -> dict[str, list[Row]]:
    """The rows of each list, such as MATERIAL."""
    text = re.sub(r"\\\n\s*", " ", Path(path).read_text(encoding="utf-8"))
    lists: dict[str, list[Row]] = {}
    bodies = dict(re.findall(r"#define PEL_EACH_(\w+)_FIELD\(X\)(.*)", text))

    def rows_of(name: str) -> list[Row]:
        if name not in lists:
            body, found, end = re.sub(r"\s+", " ", bodies[name]).strip(), [], 0
            for m in ROW.finditer(body):
                if body[end : m.start()].strip():
                    break
                found += rows_of(m["list"]) if m["list"] else [row(m)]
                end = m.end()
            if body[end:].strip():
                raise SystemExit(f"{path}: PEL_EACH_{name}_FIELD: not understood: {body[end : end + 80]}")
            lists[name] = found
        return lists[name]

    for name in bodies:
        rows_of(name)
    return lists


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
