#!/usr/bin/env python3
"""How many of the small faults that one could make do the tests notice?

    run.py [N] [SEED] [--only REGEX] [--again] [--list] [--seconds S] [--nearest K] [--as-is]

Takes N lines (50) of kernels, host, command and Python package by SEED (1), puts one fault into each (faults.py), one at a time, builds
what changed, and runs the tests that execute the line until one fails. Prints killed or survived, the diff of each survivor, and the
rate. Works in a copy of the tree in build/mutants; results stay there, so that a second run goes on.

Tests come in the order of their kinship to the file: its own subject first. The first time that a test's turn comes it is run without
any fault, to see which lines it executes (gcov), which kernels it launches (PoCL's tracing), and how long it takes.
--seconds: how long the tests of one fault may take by that measurement (120); those that do not fit are not run. A line that no
test executes is a survivor. A test that hangs has noticed; a fault that does not compile does not count, nor does one whose name
stands in equivalent.txt.
--nearest: a first sieve for machines with little time. No line is counted: of each fault the K tests of nearest kinship run, by the
words that a test and the file share; of a fault in a kernel, those that launch it. What they notice is noticed; the rest is
judged again by a run without this option and with --again.
--only: faults in files whose path matches. --again: survivors of earlier runs once more, after tests were added. --list: names only.
--as-is: goes on with the copy as it is, while the tree changes.
Ends with 1 when less than 92 % were noticed. build/mutants/tree may be a link to a folder where the compiler's cache knows the tree.
"""
import argparse
import collections
import contextlib
import difflib
import hashlib
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import faults

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "mutants"
TREE = (WORK / "tree").resolve()
BUILD = TREE / "build" / "release"
EQUIVALENT = Path(__file__).with_name("equivalent.txt")
SOURCES = ["kernels/**/*.cl", "kernels/**/*.clh", "kernels/**/*.h", "host/**/*.cpp", "host/**/*.h", "bindings/cli/*.cpp",
           "bindings/python/pellucid/**/*.py", "bindings/python/native/*.cpp"]
# Declarations that every program is built from: tests/abi has their values.
LEFT_OUT = {"host/include/pellucid/pellucid.h"}
GOAL = 0.92
MOST_MEASURED = 4  # tests that one fault may be the first to run, once one executes it
PASSED = (0, 77)  # 77: something was skipped


def say(*words):
    print(*words, flush=True)


def command(words, limit, log, **environment):
    """(exit status, processor seconds) of a command whose output goes to `log`. One that takes too long counts as failed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(log, "wb") as out:
        process = subprocess.Popen([str(w) for w in words], cwd=BUILD, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                                   start_new_session=True, env={**os.environ, **{k: str(v) for k, v in environment.items()}})
        try:
            status = process.wait(limit)
        except subprocess.TimeoutExpired:
            status = "took too long"
        finally:
            # Children of a test that crashed or hangs.
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return status, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Workplace:
    """The copy of the tree, its build, and its Python environment."""

    def __init__(self, as_is):
        for folder in ("tmp", "pocl", "cache", "counts"):
            (WORK / folder).mkdir(parents=True, exist_ok=True)
        BUILD.mkdir(parents=True, exist_ok=True)
        self.scratch = WORK / "tmp"
        self.environment = {"TMPDIR": self.scratch, "XDG_CACHE_HOME": WORK / "cache", "PELLUCID_COMMAND": BUILD / "bin/pellucid",
                            "GTEST_COLOR": "no"}
        if self.applied.exists():  # a run was killed
            path, text = json.loads(self.applied.read_text())
            self.restore(path, text)
        if not as_is:
            self.copy()

    applied = WORK / "applied.json"

    def apply(self, fault, original):
        self.applied.write_text(json.dumps([fault.path, original]))
        (TREE / fault.path).write_text(fault.apply(original))

    def restore(self, path, original):
        (TREE / path).write_text(original)
        self.applied.unlink(missing_ok=True)

    def copy(self):
        """Makes the copy as the tree is; what did not change keeps its time."""
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, capture_output=True, check=True)
        wanted = {name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()}
        for name in wanted:
            source, target = ROOT / name, TREE / name
            if not target.exists() or target.read_bytes() != source.read_bytes():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, target)
        for path in [p for p in TREE.rglob("*") if p.is_file() and not p.is_relative_to(TREE / "build")]:
            if str(path.relative_to(TREE)) not in wanted:
                path.unlink()

    counting = True  # whether the build counts lines

    def build(self, *targets):
        if not (BUILD / "build.ninja").exists():
            launcher = ["-DCMAKE_C_COMPILER_LAUNCHER=ccache", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
            counting = [f"-DCMAKE_PROJECT_pellucid_INCLUDE={TREE}/tests/mutants/count_lines.cmake",
                        "-DCMAKE_EXE_LINKER_FLAGS=--coverage", "-DCMAKE_SHARED_LINKER_FLAGS=--coverage"] if self.counting else []
            status, _ = command(["cmake", "-G", "Ninja", "-S", TREE, "-B", BUILD, "-DCMAKE_BUILD_TYPE=Release", *counting, *launcher],
                                600, WORK / "build.log")
            if status:
                sys.exit((WORK / "build.log").read_text())
        return command(["ninja", "-C", BUILD, *targets], 3000, WORK / "build.log")[0] == 0

    def test(self, name, limit, log, **extra):
        """A test program, or a file of Python tests."""
        environment = {"POCL_CACHE_DIR": WORK / "pocl", "GCOV_PREFIX": WORK / "tmp" / "gcov", **self.environment, **extra}
        if name.endswith(".py"):
            words = [WORK / "python/test-environment/bin/python", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--tb=short",
                     "--rootdir", TREE, TREE / name]
        else:
            words = [BUILD / "bin" / name, "--gtest_fail_fast", "--gtest_brief=1"]
        result = command(words, limit, log, **environment)
        shutil.rmtree(self.scratch, ignore_errors=True)
        self.scratch.mkdir()
        return result

    def python(self):
        """The package in a virtual environment of its own; made again when anything compiled in it changed."""
        home = WORK / "python"
        text = hashlib.sha256()
        faster = {"CMAKE_CXX_COMPILER_LAUNCHER": "ccache"} if shutil.which("ccache") else {}
        for folder in ("host", "kernels", "bindings/python/native"):
            for path in sorted(p for p in (TREE / folder).rglob("*") if p.is_file()):
                text.update(path.read_bytes())
        key = home / "key"
        if key.exists() and key.read_text() == text.hexdigest():
            installed = next((home / "test-environment").glob("lib/python*/site-packages/pellucid"))
            shutil.copytree(TREE / "bindings/python/pellucid", installed, dirs_exist_ok=True)
            return True
        key.unlink(missing_ok=True)
        log = WORK / "build.log"
        environment = home / "test-environment/bin/python"
        if environment.exists():
            status, _ = command([home / "build-environment/bin/python", "-m", "pip", "wheel", "-q", "--no-build-isolation", "--no-deps",
                                 f"--config-settings=build-dir={home / 'build'}", "-w", home / "wheels", TREE], 1800, log, **faster)
            if not status:
                status, _ = command([environment, "-m", "pip", "install", "-q", "--no-deps", "--force-reinstall",
                                     *(home / "wheels").glob("*.whl")], 600, log)
        else:
            status, _ = command([sys.executable, TREE / "bindings/python/tests/run_installed.py", TREE, home, "--collect-only", "-q"],
                                3000, log, **faster)
        if status in PASSED:
            key.write_text(text.hexdigest())
        return status in PASSED


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


def judge(place, coverage, fault, seconds):
    """(verdict, by what)."""
    original = (TREE / fault.path).read_text()
    python, kernel = fault.path.startswith("bindings/python"), fault.path.startswith("kernels")
    known = {p for p in (WORK / "pocl").glob("*/*")}
    log = WORK / "test.log"
    applied, ran, left, used, measured = False, 0, 0, 0.0, 0
    try:
        for name in coverage.kin(fault):
            if not coverage.known(name, fault):
                if ran and (used >= seconds or measured >= MOST_MEASURED):
                    left += 1
                    continue
                # Without the fault.
                measured += 1
                place.restore(fault.path, original)
                applied = False
            if not coverage.executes(name, fault):
                continue
            expected = coverage.tests[name]["seconds"]
            if used + expected > seconds:
                left += 1
                continue
            if not applied:
                place.apply(fault, original)
                applied = True
                if not (place.python() if python else place.build("pellucid")):
                    return "does not compile", ""
            if not python and not place.build(name):
                return "does not compile", ""
            # Ten times as long as usual is a hang; other processes may take their share of the machine.
            status, _ = place.test(name, 60 + 10 * expected, log)
            ran, used = ran + 1, used + expected
            if status not in PASSED:
                if kernel and "did not build with" in log.read_text(errors="replace"):
                    return "does not compile", ""
                return "killed", name if isinstance(status, int) else f"{name}, which {status}"
        return "survived", f"{ran} tests that execute it passed, {left} were not tried" if ran + left else "no test executes this line"
    finally:
        if applied:
            place.restore(fault.path, original)
        for path in set((WORK / "pocl").glob("*/*")) - known if kernel else ():
            shutil.rmtree(path, ignore_errors=True)


def plain(place, name):
    """A test without any fault, measured once: whether it passes, its time, the kernels that it launches."""
    file, log = WORK / "plain.json", WORK / "test.log"
    tests = json.loads(file.read_text()) if file.exists() else {}
    if name not in tests:
        kernels = set()
        python = name.endswith(".py")
        if place.python() if python else place.build(name):
            with launched(kernels) as trace:
                status, seconds = place.test(name, 900, log, POCL_TRACING="text", POCL_TRACING_OPT=trace)
        else:
            status, seconds = "does not build", 0
        tests[name] = {"good": status in PASSED, "seconds": seconds, "kernels": sorted(kernels)}
        file.write_text(json.dumps(tests))
        say(f"{seconds:7.1f} s  {len(kernels):3} kernels  {name}{'' if status in PASSED else f' fails without any fault ({status})'}")
    return tests[name]


def sieve(place, coverage, fault, nearest):
    """(verdict, by what) by the nearest tests alone."""
    original = (TREE / fault.path).read_text()
    python, kernel = fault.path.startswith("bindings/python"), fault.path.startswith("kernels")
    known = set((WORK / "pocl").glob("*/*"))
    log = WORK / "test.log"
    names, wanted, tried = [], coverage.kernels_with(fault.path) if kernel else set(), 0
    for name in coverage.kin(fault):
        if len(names) == nearest or tried == 4 * nearest:
            break
        tried += 1
        test = plain(place, name)
        if test["good"] and (not kernel or wanted & set(test["kernels"])):
            names.append(name)
    place.apply(fault, original)
    try:
        if not (place.python() if python else place.build("pellucid")):
            return "does not compile", ""
        for name in names:
            if not python and not place.build(name):
                return "does not compile", ""
            status, _ = place.test(name, 120 + 10 * plain(place, name)["seconds"], log)
            if status not in PASSED:
                if kernel and "did not build with" in log.read_text(errors="replace"):
                    return "does not compile", ""
                return "killed", name if isinstance(status, int) else f"{name}, which {status}"
        return "survived", f"the nearest: {', '.join(names)}"
    finally:
        place.restore(fault.path, original)
        for path in set((WORK / "pocl").glob("*/*")) - known if kernel else ():
            shutil.rmtree(path, ignore_errors=True)


def diff(fault):
    old = (TREE / fault.path).read_text()
    lines = difflib.unified_diff(old.split("\n"), fault.apply(old).split("\n"), "a/" + fault.path, "b/" + fault.path, n=2, lineterm="")
    return "\n".join(lines)


def equivalent():
    """{name: reason} of the faults that change nothing."""
    rows = [line.split(None, 1) for line in EQUIVALENT.read_text().splitlines() if line.strip() and not line.startswith("#")]
    return dict(rows)


def sample(seed, only):
    """Every fault, in an order that `seed` gives and that edits elsewhere leave alone."""
    found = []
    for pattern in SOURCES:
        for path in sorted(TREE.glob(pattern)):
            name = str(path.relative_to(TREE))
            if name not in LEFT_OUT and re.search(only, name):
                found += faults.faults(name, path.read_text())
    return sorted(found, key=lambda f: hashlib.sha256(f"{seed} {f.name}".encode()).digest())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("n", type=int, nargs="?", default=50)
    parser.add_argument("seed", nargs="?", default="1")
    parser.add_argument("--only", default="")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--as-is", action="store_true")
    parser.add_argument("--nearest", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=120)
    o = parser.parse_args()
    Workplace.counting = not o.nearest
    place = Workplace(o.as_is)
    same, every = equivalent(), sample(o.seed, o.only)
    if o.list:
        for fault in every[:o.n]:
            say(f"{fault.name}  {fault.path}:{fault.line}  {fault.kind}")
        return 0
    coverage = Coverage(place)
    if not place.build("pellucid"):
        sys.exit((WORK / "build.log").read_text()[-3000:])
    results = WORK / "results.jsonl"
    known = {r["name"]: r for r in map(json.loads, results.read_text().splitlines())} if results.exists() else {}
    counted, survivors, broken, alike = 0, [], 0, 0
    for fault in every:
        if counted == o.n:
            break
        if fault.name in same:
            alike += 1
            continue
        result = known.get(fault.name)
        if not result or (o.again and result["verdict"] == "survived"):
            start = time.monotonic()
            verdict, reason = (sieve(place, coverage, fault, o.nearest) if o.nearest else
                               judge(place, coverage, fault, o.seconds))
            result = {"name": fault.name, "verdict": verdict, "reason": reason, "seconds": round(time.monotonic() - start, 1)}
            with results.open("a") as out:
                out.write(json.dumps(result) + "\n")
        verdict = result["verdict"]
        broken += verdict == "does not compile"
        counted += verdict != "does not compile"
        say(f"[{counted}] {verdict:16} {result['seconds']:6.1f} s  {fault.name}  {fault.path}:{fault.line}  {fault.kind}: {result['reason']}")
        if verdict == "survived":
            survivors.append(fault)
            say(diff(fault))
    killed = counted - len(survivors)
    say(f"{killed} of {counted} faults were noticed ({100 * killed / max(counted, 1):.1f} %), {len(survivors)} survived; "
        f"{broken} did not compile, {alike} change nothing (equivalent.txt)")
    return 0 if killed >= GOAL * counted else 1


if __name__ == "__main__":
    sys.exit(main())
