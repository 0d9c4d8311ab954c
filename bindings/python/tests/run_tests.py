"""Runs the tests of the Python package that a build laid out, in a virtual environment with what they import.

    run_tests.py PACKAGE_FOLDER ENVIRONMENT [PYTEST_ARGUMENT ...]
    run_tests.py --prepare ENVIRONMENT

--prepare makes the environment, once: pip downloads for minutes, so it has a step and a time limit of its
own. PELLUCID_SANITIZE set: the tests run with the sanitizer's library loaded first. Ends with 77 where
nothing failed and something was skipped, so that CTest says so.
"""
import os
import subprocess
import sys
import venv
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ["bindings/python/tests", "apps/viewer/tests", "apps/batch/tests", "apps/blender/tests"]
NEEDS = ["numpy", "pytest>=7", "tqdm", "pyopencl", "pillow", "distributed", "fsspec", "matplotlib", "nicegui",
         "moderngl", "selenium"]


def prepare(environment):
    """Creates the environment unless it is complete; returns whether it is."""
    complete = environment / "complete"
    if complete.exists() and complete.read_text() == "\n".join(NEEDS):
        return True
    venv.create(environment, clear=True, with_pip=True)
    # Most modules of most packages are never imported; compiling them all takes longer than installing them.
    pip = subprocess.run([environment / "bin/python", "-m", "pip", "--disable-pip-version-check", "install",
                          "-q", "--no-compile", *NEEDS],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if pip.returncode == 0:
        complete.write_text("\n".join(NEEDS))
        return True
    print(pip.stdout)
    if "No matching distribution" in pip.stdout or "Failed to establish a new connection" in pip.stdout:
        return False
    raise SystemExit("pip failed")


def sanitized():
    """Variables of the tests' environment where the package was built with a sanitizer; else None."""
    if not os.environ.get("PELLUCID_SANITIZE"):
        return {}
    compiler = os.environ.get("CXX", "c++")
    # The C++ library too, for the sanitizer looks for its __cxa_throw when it is loaded.
    first = [subprocess.run([compiler, f"-print-file-name={name}"], stdout=subprocess.PIPE, text=True,
                            check=True).stdout.strip()
             for name in ("libasan.so", "libstdc++.so.6")]
    # CPython keeps what it allocates until the end, which the leak check would report; and LLVM's signal
    # stacks, which compilers of kernels set up, collide with the sanitizer's own.
    options = os.environ.get("ASAN_OPTIONS", "")
    return {"LD_PRELOAD": " ".join(first), "ASAN_OPTIONS": f"{options}:detect_leaks=0:use_sigaltstack=0"}


def main(package, environment, *arguments):
    package, environment = Path(package).resolve(), Path(environment).absolute()
    if not prepare(environment):
        print("bindings/python/tests::packages_from_PyPI SKIPPED (pip cannot reach what the tests need)")
        raise SystemExit(77)
    report = environment / "report.xml"
    # Bytecode beside the environment: processes of tests import the same modules again and again.
    variables = {**os.environ, **sanitized(), "PYTHONPATH": str(package),
                 "PYTHONPYCACHEPREFIX": str(environment / "bytecode")}
    variables.pop("PYTHONDONTWRITEBYTECODE", None)
    folders = [ROOT / f for f in FOLDERS] if not any(Path(a).exists() for a in arguments) else []
    status = subprocess.run([environment / "bin/python", "-m", "pytest", "-v", "-rs", "-p",
                             "no:cacheprovider", "--tb=short",
                             f"--junitxml={report}", "--rootdir", ROOT, *folders, *arguments],
                            cwd=environment, env=variables).returncode
    skipped = int(ElementTree.parse(report).find("testsuite").get("skipped")) if status == 0 else 0
    raise SystemExit(77 if skipped else status)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--prepare"] and len(sys.argv) == 3:
        prepare(Path(sys.argv[2]).absolute())
    elif len(sys.argv) > 2:
        main(*sys.argv[1:])
    else:
        raise SystemExit(__doc__)
