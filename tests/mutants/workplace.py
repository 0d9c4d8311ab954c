"""The copy of the tree in build/mutants that faults are put into, its build, and its Python environment."""
import contextlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "mutants"
TREE = (WORK / "tree").resolve()
BUILD = TREE / "build" / "release"
PASSED = (0, 77)  # 77: something was skipped
# Scripts that compare the command or the headers with the pages, and what they are given.
COMMAND = BUILD / "bin/pellucid"
CHECKS = {"tests/cli/test_command_pages.py": COMMAND, "tests/docs/test_tree.py": COMMAND,
          "docs/field_tables": "--check"}


def say(*words):
    print(*words, flush=True)


def command(words, limit, log, **environment):
    """(exit status, processor seconds) of a command whose output goes to `log`. One that takes too long
    counts as failed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(log, "wb") as out:
        process = subprocess.Popen(list(map(str, words)), cwd=BUILD, stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=subprocess.STDOUT, start_new_session=True,
                                   env={**os.environ, **{k: str(v) for k, v in environment.items()}})
        try:
            status = process.wait(limit)
        except subprocess.TimeoutExpired:
            status = "took too long"
        finally:
            with contextlib.suppress(ProcessLookupError):  # children of a test that crashed or hangs
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return status, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Workplace:
    """The copy of the tree, its build, and its Python environment."""

    def __init__(self, as_is):
        for folder in (WORK / "tmp", WORK / "pocl", WORK / "cache", BUILD):
            folder.mkdir(parents=True, exist_ok=True)
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
        """Updates the copy from the tree, unless it is the tree itself; unchanged files keep their time."""
        if TREE == ROOT:
            return
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT,
                                capture_output=True, check=True)
        wanted = {name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()}
        for name in wanted:
            source, target = ROOT / name, TREE / name
            if not target.exists() or target.read_bytes() != source.read_bytes():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, target)
        for path in [p for p in TREE.rglob("*") if p.is_file() and not p.is_relative_to(TREE / "build")]:
            if str(path.relative_to(TREE)) not in wanted:
                path.unlink()

    def build(self, *targets):
        if not (BUILD / "build.ninja").exists():
            launcher = [f"-DCMAKE_{language}_COMPILER_LAUNCHER=ccache" for language in ("C", "CXX")
                        if shutil.which("ccache")]
            status, _ = command(["cmake", "-G", "Ninja", "-S", TREE, "-B", BUILD,
                                 "-DCMAKE_BUILD_TYPE=Release", "-DPELLUCID_UNITY=OFF", *launcher],
                                600, WORK / "build.log")
            if status:
                sys.exit((WORK / "build.log").read_text())
        targets = ["pellucid_cli" if target in CHECKS else target for target in targets]
        return command(["ninja", "-C", BUILD, *targets], 3000, WORK / "build.log")[0] == 0

    def test(self, name, limit, log, **extra):
        """A test program, one of CHECKS, or a file of Python tests."""
        environment = {"POCL_CACHE_DIR": WORK / "pocl", "XDG_CACHE_HOME": WORK / "cache",
                       "TMPDIR": WORK / "tmp", "PELLUCID_COMMAND": COMMAND, **extra}
        words = [BUILD / "bin" / name, "--gtest_fail_fast", "--gtest_brief=1", "--gtest_color=no"]
        if name in CHECKS:
            words = [sys.executable, TREE / name, CHECKS[name]]
        elif name.endswith(".py"):
            environment["PYTHONPATH"] = BUILD / "python"
            words = [WORK / "python-environment/bin/python", "-m", "pytest", "-x", "-q", "-p",
                     "no:cacheprovider", "--tb=short", "--rootdir", TREE, TREE / name]
        result = command(words, limit, log, **environment)
        shutil.rmtree(WORK / "tmp", ignore_errors=True)
        (WORK / "tmp").mkdir()
        return result

    def python(self):
        """The package as the build lays it out, and the environment of its tests."""
        words = [sys.executable, TREE / "bindings/python/tests/run_tests.py", "--prepare",
                 WORK / "python-environment"]
        return command(words, 3000, WORK / "build.log")[0] == 0 and self.build("python_package")
