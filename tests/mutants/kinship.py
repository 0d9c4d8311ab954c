"""Which tests could notice a fault: by the lines that they execute, the kernels that they launch, and the words that they share with a file."""
import collections
import contextlib
import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import threading
from pathlib import Path

from workplace import BUILD, PASSED, TREE, WORK, say

SAME_SUBJECT = 3  # a test in the folder of a file's subject counts as so many others of the same words


@contextlib.contextmanager
def launched(kernels):
    """A pipe for PoCL's tracing; the names of kernels go into the set."""
    pipe = WORK / "trace"
    pipe.unlink(missing_ok=True)
    os.mkfifo(pipe)
    stream = os.open(pipe, os.O_RDWR)

    def read():
        with os.fdopen(stream, errors="replace") as lines:
            for line in lines:
                if line == "end\n":
                    return
                if found := re.search(r"ndrange_kernel .* name=(\w+)", line):
                    kernels.add(found[1])

    reader = threading.Thread(target=read)
    reader.start()
    try:
        yield pipe
    finally:
        with open(pipe, "w") as out:
            out.write("\nend\n")
        reader.join()


def words_of(text):
    """The words of names, also of those written together."""
    return [w.lower() for w in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", text) if len(w) > 2]


class Coverage:
    """Which test executes which lines and launches which kernels, and how long it takes."""

    def __init__(self, place):
        self.place, self.file = place, WORK / "map.json"
        self.tests = json.loads(self.file.read_text()) if self.file.exists() else {}
        self.folders = {p.stem: p.parent.name for p in TREE.glob("tests/*/test_*.cpp")}
        self.scripts = sorted(str(p.relative_to(TREE)) for p in TREE.glob("bindings/python/tests/test_*.py"))
        self.words, self.rarity = {}, {}
        self.digests = {str(p.relative_to(TREE)): hashlib.sha256(p.read_bytes()).hexdigest()[:8]
                        for folder in ("host", "bindings/cli", "tests") for p in (TREE / folder).rglob("*") if p.is_file()}

    def known(self, name, fault):
        """Whether a test was measured, and the file was there then."""
        return name in self.tests and (not fault.path.startswith(("host", "bindings/cli")) or fault.path in self.tests[name]["digests"])

    def of(self, name, fault):
        """What is known of a test: measured once, without any fault."""
        if not self.known(name, fault):
            self.tests[name] = self.measure(name)
            self.file.write_text(json.dumps(self.tests))
        return self.tests[name]

    def measure(self, name):
        counts, log = WORK / "counts", WORK / "test.log"
        shutil.rmtree(counts, ignore_errors=True)
        counts.mkdir()
        kernels = set()
        if name.endswith(".py"):
            status, seconds = self.place.test(name, 3000, log) if self.place.python() else ("cannot be installed", 0)
        elif not self.place.build(name):
            status, seconds = "does not build", 0
            shutil.copy(WORK / "build.log", log)
        else:
            with launched(kernels) as trace:
                status, seconds = self.place.test(name, 3000, log, GCOV_PREFIX=counts, POCL_TRACING="text", POCL_TRACING_OPT=trace)
        test = {"good": status in PASSED, "seconds": seconds, "kernels": sorted(kernels), "lines": self.lines(counts),
                "digests": dict(self.digests)}
        if not test["good"]:
            say(f"{name} fails without any fault ({status}) and is left out:\n{log.read_text(errors='replace')[-1500:]}")
        say(f"{seconds:7.1f} s  {len(kernels):3} kernels  {len(test['lines']):3} files  {name}")
        return test

    @staticmethod
    def lines(counts):
        """{file: {line: executed?}} of the counters below `counts`."""
        found = {}
        notes = []
        for data in counts.rglob("*.gcda"):
            note = Path("/", data.relative_to(counts)).with_suffix(".gcno")
            shutil.copy(note, data.with_suffix(".gcno"))
            notes.append(data)
        out = subprocess.run(["gcov", "--json-format", "--stdout", *notes], cwd=counts, capture_output=True, text=True).stdout
        for text in out.splitlines():
            for file in json.loads(text)["files"]:
                path = os.path.normpath(os.path.join(BUILD, file["file"]))
                if path.startswith(str(TREE)):
                    rows = found.setdefault(os.path.relpath(path, TREE), {})
                    for line in file["lines"]:
                        row = str(line["line_number"])
                        rows[row] = rows.get(row, 0) or int(line["count"] > 0)
        return found

    def kernels_with(self, path):
        """The kernels whose source includes this file."""
        texts = {str(p.relative_to(TREE / "kernels")): p.read_text() for p in (TREE / "kernels").rglob("*") if p.is_file()}
        inside = {path[len("kernels/"):]}
        while True:
            more = {name for name, text in texts.items() if any(f'#include "{i}"' in text for i in inside)} - inside
            if not more:
                break
            inside |= more
        return {kernel for name in inside
                for kernel in re.findall(r"__kernel\b[^{;]*?\bvoid\s+(\w+)\s*\(", texts.get(name, ""))}

    def kin(self, fault):
        """Every test that could execute a fault, the likeliest and quickest first: by the words that the two files share."""
        path = Path(fault.path)
        names = self.scripts if fault.path.startswith("bindings/python") else sorted(self.folders)
        if not self.words:
            for p in [*TREE.glob("tests/*/test_*.cpp"), *(TREE / script for script in self.scripts)]:
                key = str(p.relative_to(TREE)) if p.suffix == ".py" else p.stem
                self.words[key] = words_of(p.stem) * 5 + words_of(p.parent.name) * 5 + words_of(p.read_text())
            known = [set(words) for words in self.words.values()]
            self.rarity = {word: math.log(len(known) / sum(word in k for k in known)) for word in set().union(*known)}
        own = self.weighed(words_of(str(path.with_suffix(""))) * 5 + words_of((TREE / path).read_text()))

        def distance(name):
            other = self.weighed(self.words[name])
            near = sum(weight * other.get(word, 0) for word, weight in own.items())
            if self.folders.get(name) in path.parts:
                near *= SAME_SUBJECT
            return -near / (1 + self.tests.get(name, {}).get("seconds", 10) / 20) ** 0.5, name

        return sorted(names, key=distance)

    def weighed(self, words):
        """{word: weight}, of length 1: rare words count most, and the tenth of a kind little more than the first."""
        row = {word: (1 + math.log(n)) * self.rarity.get(word, 0) for word, n in collections.Counter(words).items()}
        length = math.sqrt(sum(w * w for w in row.values())) or 1
        return {word: w / length for word, w in row.items()}

    def executes(self, name, fault):
        test = self.of(name, fault)
        if not test["good"]:
            return False
        if fault.path.startswith("bindings/python"):
            return True
        if fault.path.startswith("kernels"):
            return bool(self.kernels_with(fault.path) & set(test["kernels"]))
        rows = test["lines"].get(fault.path, {})
        same = test["digests"].get(fault.path) == self.digests[fault.path]
        return self.counted(rows, fault.line) if same else any(rows.values())

    @staticmethod
    def counted(rows, line):
        """The compiler counts a statement where it begins, or where parts of it are; constants nowhere."""
        for row in range(line, max(line - 8, 0), -1):
            if str(row) in rows:
                return bool(rows[str(row)])
        return any(rows.values())
