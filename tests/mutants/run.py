#!/usr/bin/env python3
"""How many of the small faults that one could make do the tests notice?

    run.py [N] [SEED] [--meaning] [--only REGEX] [--seconds S] [--again] [--list] [--as-is]

Takes N lines (50) of kernels, host, command and Python package by SEED (1), puts one fault into each
(faults.py), one at a time, builds what changed, and runs the tests that are nearest to the file (nearest.py)
until one fails or they took S processor seconds (120). Lines of kernels that are for another number of lanes
alone are tested with that number, faults in others that nothing noticed also with one lane. Prints killed or
survived, the diff of each survivor, and the rate. Works in a copy of the tree in build/mutants; results stay
there, so that a second run continues. A test that hangs has noticed; a fault that does not compile does not
count, nor does one whose name stands in equivalent.txt.

--meaning: faults of a larger kind: a dropped clear or early return, a key or condition without one of its
parts, a neighbour left out. --only: faults in files whose path matches. --again: survivors of earlier runs
once more, after tests were added. --list: names only. --as-is: works with the copy as it is, while the tree
changes. Ends with 1 when less than 95 % were noticed. build/mutants/tree may be a link to a folder that the
compiler's cache covers.
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
from nearest import Tests
from workplace import PASSED, TREE, WORK, Workplace, say

EQUIVALENT = Path(__file__).with_name("equivalent.txt")
SOURCES = ["kernels/**/*.cl", "kernels/**/*.clh", "kernels/**/*.h", "host/**/*.cpp", "host/**/*.h",
           "apps/*/*.cpp", "bindings/cli/*.cpp", "bindings/python/pellucid/**/*.py", "apps/viewer/view/*.py",
           "apps/batch/batch/*.py", "bindings/python/native/*.cpp"]
# Declarations that every program is built from: tests/abi has their values. And what wheels alone are built
# with.
LEFT_OUT = {"host/include/pellucid/pellucid.h", "host/cl/opencl_loader.cpp"}
OTHER_SYSTEMS = re.compile("/windows/")  # not compiled here
GOAL = 0.95


def judge(place, tests, fault, seconds):
    """(verdict, reason)."""
    original, kernel = (TREE / fault.path).read_text(), fault.path.startswith("kernels")
    width = faults.lanes(original, fault.line) if kernel else None
    verdict = tried(place, tests, fault, seconds, original, width)
    # A fault in code for all numbers of lanes may have no effect with the device's own number.
    return tried(place, tests, fault, seconds, original, 1) if (
        verdict[0] == "survived" and kernel and not width) else verdict


def tried(place, tests, fault, seconds, original, width):
    python, kernel = fault.is_python(), fault.path.startswith("kernels")
    lanes = {"PELLUCID_MATH_WIDTH": width} if width else {}
    log, names = WORK / "test.log", tests.choose(fault, seconds)
    compiled = set((WORK / "pocl").glob("*/*"))
    place.apply(fault, original)
    try:
        if not (place.python() if python else place.build("pellucid")):
            return "does not compile", ""
        for count, name in enumerate(names):
            if seconds <= 0:
                del names[count:]
                break
            if not python and not place.build(name):
                return "does not compile", ""
            # Ten times as long as usual is a hang; other processes may take their share of the machine.
            limit = 300 + 10 * tests.measured[name]["seconds"]
            status, spent = place.test(name, limit, log, **lanes)
            if status not in PASSED and lanes:  # some tests need the number that the device has
                place.restore(fault.path, original)
                place.build(name)
                sound, _ = place.test(name, limit, WORK / "sound.log", **lanes)
                place.apply(fault, original)
                if sound not in PASSED or not place.build(name):
                    continue
            if status not in PASSED:
                if kernel and "did not build with" in log.read_text(errors="replace"):
                    return "does not compile", ""
                return "killed", name if isinstance(status, int) else f"{name}, which {status}"
            if kernel:  # its programs are compiled anew, which `names` does not count
                seconds -= spent
        return "survived", f"the nearest: {', '.join(names)}"
    finally:
        place.restore(fault.path, original)
        for path in set((WORK / "pocl").glob("*/*")) - compiled if kernel else ():
            shutil.rmtree(path, ignore_errors=True)


def diff(fault):
    old = (TREE / fault.path).read_text()
    return "\n".join(difflib.unified_diff(old.split("\n"), fault.apply(old).split("\n"), "a/" + fault.path,
                                          "b/" + fault.path, n=2, lineterm=""))


def sample(seed, only, meaning):
    """Every fault, in an order that `seed` gives and that edits elsewhere leave alone."""
    found = []
    for pattern in SOURCES:
        for path in sorted(TREE.glob(pattern)):
            name = str(path.relative_to(TREE))
            if name not in LEFT_OUT and not OTHER_SYSTEMS.search(name) and re.search(only, name):
                found += faults.faults(name, path.read_text(), meaning)
    return sorted(found, key=lambda f: hashlib.sha256(f"{seed} {f.name}".encode()).digest())


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("n", type=int, nargs="?", default=50)
    parser.add_argument("seed", nargs="?", default="1")
    parser.add_argument("--only", default="")
    parser.add_argument("--seconds", type=float, default=120)
    for flag in ("--meaning", "--again", "--list", "--as-is"):
        parser.add_argument(flag, action="store_true")
    o = parser.parse_args()
    place, every = Workplace(o.as_is), sample(o.seed, o.only, o.meaning)
    same = set(re.findall(r"\b[0-9a-f]{12}\b", EQUIVALENT.read_text()))
    if o.list:
        for fault in every[:o.n]:
            say(f"{fault.name}  {fault.path}:{fault.line}  {fault.kind}")
        return 0
    tests = Tests(place)
    if not place.build("pellucid"):
        sys.exit((WORK / "build.log").read_text()[-3000:])
    results = WORK / "results.jsonl"
    results.touch()
    known = {r["name"]: r for r in map(json.loads, results.read_text().splitlines())}
    counted = survived = broken = alike = 0
    for fault in every:
        if counted == o.n:
            break
        if fault.name in same:
            alike += 1
            continue
        result = known.get(fault.name)
        if not result or (o.again and result["verdict"] == "survived"):
            start = time.monotonic()
            verdict, reason = judge(place, tests, fault, o.seconds)
            result = {"name": fault.name, "verdict": verdict, "reason": reason,
                      "seconds": round(time.monotonic() - start, 1)}
            with results.open("a") as out:
                out.write(json.dumps(result) + "\n")
        verdict = result["verdict"]
        broken += verdict == "does not compile"
        counted += verdict != "does not compile"
        say(f"[{counted}] {verdict:16} {result['seconds']:6.1f} s  {fault.name}  {fault.path}:{fault.line}  "
            f"{fault.kind}: {result['reason']}")
        if verdict == "survived":
            survived += 1
            say(diff(fault))
    killed = counted - survived
    say(f"{killed} of {counted} faults were noticed ({killed / max(counted, 1):.1%}), {survived} survived; "
        f"{broken} did not compile, {alike} change nothing (equivalent.txt)")
    return killed < GOAL * counted


if __name__ == "__main__":
    sys.exit(main())
