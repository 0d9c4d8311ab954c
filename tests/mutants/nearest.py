"""Which tests could notice a fault: those that share most words with its file, and whose kernels are mostly
those that it is in."""
import collections
import contextlib
import json
import math
import os
import re
import threading
from pathlib import Path

from workplace import CHECKS, PASSED, TREE, WORK, say

SAME_SUBJECT = 2  # factor for each word that the paths of a test and of a file share
COMPILED = 1  # processor seconds for each kernel that a fault is in


def words_of(text, shortest=3):
    """The words of names; camelCase is split."""
    return [w.lower() for w in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", text) if len(w) >= shortest]


def subjects_of(path):
    """The words of a path without its extension, such as those of the folder "cl"."""
    return {*words_of(str(path.with_suffix("")), 2)}


@contextlib.contextmanager
def launched():
    """(a pipe for PoCL's trace, the names of kernels that go through it). Each process of a test opens the
    trace anew: a file would keep the last one's kernels alone."""
    trace, kernels = WORK / "trace", set()
    trace.unlink(missing_ok=True)
    os.mkfifo(trace)

    def read(lines):
        kernels.update(found[1] for line in lines
                       if (found := re.search(r"ndrange_kernel .* name=(\w+)", line)))

    own = os.open(trace, os.O_RDWR)  # neither end waits for the other
    with open(trace, errors="replace") as lines:
        reader = threading.Thread(target=read, args=[lines])
        reader.start()
        try:
            yield trace, kernels
        finally:
            os.close(own)
            reader.join()
            trace.unlink()


class Tests:
    def __init__(self, place):
        self.place, self.file = place, WORK / "tests.json"
        self.measured = json.loads(self.file.read_text()) if self.file.exists() else {}
        self.programs = {p.stem: p for folder in ("tests/*", "apps/*/tests")
                         for p in TREE.glob(f"{folder}/test_*.cpp")}
        self.programs |= {name: TREE / name for name in CHECKS}
        self.scripts = {str(p.relative_to(TREE)): p for folder in ("bindings/python", "apps/*")
                        for p in TREE.glob(f"{folder}/tests/test_*.py")}
        self.texts = {name: p.read_text() for name, p in {**self.programs, **self.scripts}.items()}
        self.words = {name: {*words_of(f"{p.stem} {p.parent.name} {self.texts[name]}")}
                      for name, p in {**self.programs, **self.scripts}.items()}
        self.subjects = {name: subjects_of(p.relative_to(TREE))
                         for name, p in {**self.programs, **self.scripts}.items()}
        known = collections.Counter(word for words in self.words.values() for word in words)
        self.rarity = {word: math.log(len(self.words) / count) for word, count in known.items()}

    def measure(self, name):
        """Runs a test without any fault: whether it passes, its processor seconds, and its kernels."""
        if name not in self.measured:
            status, seconds, kernels = "does not build", 0, set()
            if self.place.python() if name in self.scripts else self.place.build(name):
                with launched() as (trace, kernels):
                    status, seconds = self.place.test(name, 900, WORK / "test.log", POCL_TRACING="text",
                                                      POCL_TRACING_OPT=trace)
                for _ in range(2):  # until its programs are in our cache, and their code in PoCL's
                    if status in PASSED:
                        status, seconds = self.place.test(name, 900, WORK / "test.log")
            self.measured[name] = {"good": status in PASSED, "seconds": seconds, "kernels": sorted(kernels)}
            self.file.write_text(json.dumps(self.measured))
            failed = "" if status in PASSED else f" fails without any fault ({status})"
            say(f"{seconds:7.1f} s  {len(kernels):3} kernels  {name}{failed}")
        return self.measured[name]

    def choose(self, fault, seconds):
        """The tests to run for a fault, the likeliest and quickest first: for that many processor seconds.
        Those that were never measured are, for about four times as many."""
        kernels = kernels_with(fault.path) if fault.path.startswith("kernels") else None
        names, unmeasured = [], 4 * seconds
        for name in self.nearest_first(fault, kernels):
            if seconds <= 0:
                break
            if name not in self.measured:
                if unmeasured <= 0:
                    continue
                unmeasured -= self.measure(name)["seconds"]
            test = self.measured[name]
            runs = kernels is None or self.includes(name, fault) or kernels & set(test["kernels"])
            if test["good"] and runs:
                names.append(name)
                seconds -= test["seconds"]
        return names

    def includes(self, name, fault):
        """Whether a test has kernels of its own that include the fault's file."""
        return fault.path.endswith(".clh") and fault.path.removeprefix("kernels/lib/") in self.texts[name]

    def nearest_first(self, fault, kernels):
        """All tests: first those that include the fault's file, then those that share most rare words with
        it, and launch few kernels but `kernels`."""
        path = Path(fault.path)
        subjects = subjects_of(path)
        own = subjects | {*words_of((TREE / path).read_text())}

        def distance(name):
            shared = sum(self.rarity.get(word, 0) for word in own & self.words[name])
            near = shared / sum(self.rarity[word] for word in self.words[name]) ** 0.5
            near *= SAME_SUBJECT ** len(subjects & self.subjects[name])
            measured = self.measured.get(name, {"seconds": 10, "kernels": []})
            seconds = measured["seconds"]
            if kernels and measured["kernels"]:
                inside = len(kernels & set(measured["kernels"]))
                near *= inside / len(measured["kernels"])
                seconds += COMPILED * inside
            return not self.includes(name, fault), -near / (1 + seconds) ** 0.5, name

        names = self.scripts if fault.is_python() else self.programs
        if path.is_relative_to("bindings/cli"):  # only tests that run the command can notice
            names = [name for name in names if "cli" in self.subjects[name] or name in CHECKS]
        return sorted(names, key=distance)


def kernels_with(path):
    """The kernels whose source includes this file."""
    texts = {str(p.relative_to(TREE / "kernels")): p.read_text()
             for p in (TREE / "kernels").rglob("*") if p.is_file()}
    inside, more = set(), {path[len("kernels/"):]}
    while more:
        inside |= more
        more = {name for name, text in texts.items() if any(f'#include "{i}"' in text for i in more)} - inside
    return {kernel for name in inside
            for kernel in re.findall(r"__kernel\b[^{;]*?\bvoid\s+(\w+)\s*\(", texts.get(name, ""))}
