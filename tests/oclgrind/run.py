#!/usr/bin/env python3
"""Every test case of the device by itself in Oclgrind: accesses out of bounds, and races.

    run.py BUILD_DIR PROGRAM... [--widths 16] [--only REGEX] [--jobs N] [--seconds S]

Fails when a case fails, when Oclgrind reports anything, when a case takes more
than S seconds of processor time, when a line of left_out.txt matches no case, and when a kernel of
kernels/*.cl was never launched. test_small runs with 16, 8 and 1 lanes in any case.
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Unoptimised and not inlined: version 21.10 lacks some intrinsics of optimised code. Integer operations,
# mostly for addresses, are more than a compiler leaves.
OPTIONS = "-cl-opt-disable -Dalways_inline= -DPEL_NO_PREFETCH"


def plugin(build, name="watch"):
    """Compiles watch.cpp or warps.cpp where it is newer than what was compiled."""
    target, source = build / "oclgrind" / f"{name}.so", HERE / f"{name}.cpp"
    if target.exists() and target.stat().st_mtime > source.stat().st_mtime:
        return target
    libraries = subprocess.run(["ldd", "/usr/lib/oclgrind/liboclgrind-rt.so"], capture_output=True,
                               text=True).stdout
    version = re.search(r"libLLVM-(\d+)", libraries)
    llvm = pathlib.Path(f"/usr/lib/llvm-{version[1] if version else 14}")
    if not pathlib.Path("/usr/include/oclgrind/Plugin.h").exists() or not (llvm / "include/llvm/IR").exists():
        sys.exit(f"the plugin needs headers: apt-get install liboclgrind-dev {llvm.name}-dev")
    target.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([os.environ.get("CXX", "c++"), "-std=c++17", "-O2", "-fno-rtti", "-fPIC", "-shared", "-w",
                    "-Wl,-z,nodelete", "-I/usr/include/oclgrind", f"-I{llvm}/include", source, "-o",
                    target], check=True)
    return target


def cases_of(program):
    """(suite.case, arguments) of a GoogleTest program; an example is one case."""
    if program.name.startswith("example_"):
        yield "whole", []
        return
    listing = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True,
                             check=True).stdout
    suite = ""
    for line in listing.splitlines():
        name = line.split("#")[0].strip()
        if line.startswith("  "):
            if not name.startswith("DISABLED_"):
                yield suite + name, [f"--gtest_filter={suite}{name}"]
        elif name.endswith("."):
            suite = name


Result = collections.namedtuple("Result", "verdict seconds name kernels reports")


def run_case(name, command, environment, limit, scratch):
    """One process, and those that it starts, in Oclgrind."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=scratch))

    def text(pattern):
        return "".join(p.read_text(errors="replace") for p in sorted(folder.glob(pattern)))

    with open(folder / "output", "w") as output:
        process = subprocess.Popen(
            ["oclgrind", "--num-threads", "1", "--log", "/dev/null", *command], cwd=folder, stdout=output,
            stdin=subprocess.DEVNULL, stderr=subprocess.STDOUT,
            env=dict(environment, PELLUCID_OCLGRIND_DIR=str(folder)),
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 2)))
        status, used = os.wait4(process.pid, 0)[1:]
    process.returncode = status = os.waitstatus_to_exitcode(status)
    seconds, reports, said = used.ru_utime + used.ru_stime, text("reports"), text("output")
    late = status in (-signal.SIGXCPU, -signal.SIGKILL) or seconds > limit
    verdict = ("reports" if reports else "too slow" if late else "failed" if status else
               "skipped" if "[  SKIPPED ]" in said else "clean")
    result = Result(verdict, seconds, name, set(text("kernels").split()),
                    reports[:6000] or f"{said[-3000:]}\nended with {status}")
    shutil.rmtree(folder, ignore_errors=True)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("programs", nargs="+", help="test programs in BUILD_DIR/bin")
    parser.add_argument("--widths", default="16",
                        help="lanes of the explicit vectors: 16 and 8 as on CPUs, 1 as on GPUs")
    parser.add_argument("--only", default="", help="cases whose name matches this regular expression")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seconds", type=int, default=60, help="processor time of a case (60)")
    o = parser.parse_args()
    if not shutil.which("oclgrind"):
        print("oclgrind is not installed: apt-get install oclgrind liboclgrind-dev llvm-14-dev",
              file=sys.stderr)
        sys.exit(2)
    environment = dict(os.environ, PELLUCID_TEST_SMALL="1", OCLGRIND_BUILD_OPTIONS=OPTIONS,
                       OCLGRIND_DATA_RACES="1", OCLGRIND_PLUGINS=str(plugin(o.build.resolve())))

    rules = [line.partition("  ")[0] for line in (HERE / "left_out.txt").read_text().splitlines()
             if line.strip() and not line.startswith("#")]
    stale, skipped, work, widths = set(rules), 0, [], o.widths.split(",")
    for program in o.programs:
        path = o.build.resolve() / "bin" / program
        for case, arguments in cases_of(path):
            for width in sorted({*widths, "16", "8", "1"}) if program == "test_small" else widths:
                name = f"{program}/{case}@{width}"
                hits = {rule for rule in rules if re.match(f"({rule})(@[0-9]+)?$", name)}
                stale, skipped = stale - hits, skipped + bool(hits)
                if not hits and re.search(o.only, name):
                    work.append((name, [str(path), *arguments], dict(environment, PELLUCID_MATH_WIDTH=width)))

    bad, done, started = [], [], time.monotonic()
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        running = [pool.submit(run_case, *w, o.seconds, scratch) for w in work]
        for future in concurrent.futures.as_completed(running):
            r = future.result()
            done.append(r)
            print(f"[{len(done)}/{len(work)}] {r.verdict:8} {r.seconds:6.1f} s  {r.name}", flush=True)
            if r.verdict not in ("clean", "skipped"):
                print(r.reports, flush=True)
    bad += [f"{r.verdict}: {r.name}" for r in done if r.verdict not in ("clean", "skipped")]
    every = {name for path in (ROOT / "kernels").rglob("*.cl*")
             for name in re.findall(r"__kernel\b[^{;]*?\bvoid\s+(\w+)\s*\(", path.read_text())}
    if not o.only:
        bad += [f"left_out.txt: {rule} matches no case" for rule in sorted(stale)]
        for width in widths:
            launched = set().union(*(r.kernels for r in done if r.name.endswith("@" + width)))
            bad += [f"never launched with {width} lanes: {k}" for k in sorted(every - launched)]
            print(f"{len(launched & every)} of {len(every)} kernels launched with {width} lanes")
    verdicts = ("clean", "skipped", "reports", "failed", "too slow")
    print(", ".join(f"{sum(r.verdict == v for r in done)} {v}" for v in verdicts)
          + f", {skipped} left out (tests/oclgrind/left_out.txt)")
    print(f"{sum(r.seconds for r in done):.0f} s of processor time in {time.monotonic() - started:.0f} s")
    print("\n".join(bad))
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
