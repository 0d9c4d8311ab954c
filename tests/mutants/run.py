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
import difflib
import hashlib
import json
import re
import shutil
import sys
import time
from pathlib import Path

import faults
from kinship import Coverage, launched
from workplace import PASSED, TREE, WORK, Workplace, say

EQUIVALENT = Path(__file__).with_name("equivalent.txt")
SOURCES = ["kernels/**/*.cl", "kernels/**/*.clh", "kernels/**/*.h", "host/**/*.cpp", "host/**/*.h", "bindings/cli/*.cpp",
           "bindings/python/pellucid/**/*.py", "bindings/python/native/*.cpp"]
# Declarations that every program is built from: tests/abi has their values.
LEFT_OUT = {"host/include/pellucid/pellucid.h"}
OTHER_SYSTEMS = re.compile("/windows/")  # not compiled here
GOAL = 0.92
MOST_MEASURED = 4  # tests that one fault may be the first to run, once one executes it


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
    names, wanted, measured = [], coverage.kernels_with(fault.path) if kernel else set(), 0
    for name in coverage.kin(fault):
        if len(names) == nearest or (names and measured >= 4 * nearest):
            break
        start = time.monotonic()
        test = plain(place, name)
        measured += time.monotonic() - start > 0.05  # what was not known
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
            if name not in LEFT_OUT and not OTHER_SYSTEMS.search(name) and re.search(only, name):
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
