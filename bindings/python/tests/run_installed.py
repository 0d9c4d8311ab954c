"""Builds the wheel, installs it into a fresh virtual environment and runs the tests there.

    run_installed.py SOURCE WORK [PYTEST_ARGUMENT ...]

The wheel's build keeps its files in WORK, so that a second run compiles only what changed. With compiler flags in PELLUCID_SANITIZE
the wheel is built with them, and the tests run with the sanitizer's library loaded first. Ends with 77 where nothing failed and
something was skipped, so that CTest says so.
"""
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path
from xml.etree import ElementTree

BUILD_NEEDS = ["scikit-build-core>=0.10", "pybind11>=2.10"]
TEST_NEEDS = ["pytest>=7", "tqdm", "pyopencl", "pillow", "distributed", "fsspec",
              "matplotlib", "nicegui", "moderngl", "selenium", "dask-jobqueue", "cryptography", "dask-kubernetes", "jsonschema"]


def run(*command, **options):
    return subprocess.run([str(c) for c in command], **options)


def compiler_cache():
    """The environment with ccache before the compilers, where it is installed: most files were compiled a moment ago for the tests in C++."""
    launchers = {f"CMAKE_{language}_COMPILER_LAUNCHER": "ccache" for language in ("C", "CXX")} if shutil.which("ccache") else {}
    return {**launchers, **os.environ}


def pip(environment, *arguments):
    result = run(environment / "bin/python", "-m", "pip", "--disable-pip-version-check", *arguments,
                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=compiler_cache())
    if result.returncode:
        print(result.stdout)
        if "No matching distribution" in result.stdout or "Failed to establish a new connection" in result.stdout:
            print("bindings/python/tests::packages_from_PyPI SKIPPED (pip cannot reach what the tests need)")
            raise SystemExit(77)
        raise SystemExit("pip failed")


def sanitized():
    """Options of the wheel's build and variables of the tests' environment."""
    flags = os.environ.get("PELLUCID_SANITIZE")
    if not flags:
        return [], None
    compiler = os.environ.get("CXX", "c++")
    # The C++ library too, for the sanitizer looks for its __cxa_throw when it is loaded.
    first = [run(compiler, f"-print-file-name={name}", stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
             for name in ("libasan.so", "libstdc++.so.6")]
    # CPython keeps what it allocates until the end, which the leak check would report; and LLVM's signal stacks, which compilers of
    # kernels set up, collide with the sanitizer's own.
    options = os.environ.get("ASAN_OPTIONS", "")
    # A build type of no flags of its own, for those of an optimised one would win over these.
    return (["--config-settings=cmake.build-type=Sanitized", f"--config-settings=cmake.define.CMAKE_CXX_FLAGS={flags}"],
            {**os.environ, "LD_PRELOAD": " ".join(first), "ASAN_OPTIONS": f"{options}:detect_leaks=0:use_sigaltstack=0"})


def main(source, work, *arguments):
    source, work = Path(source).resolve(), Path(work).resolve()
    builder, clean, wheels = work / "build-environment", work / "test-environment", work / "wheels"
    if not (builder / "complete").exists():
        venv.create(builder, clear=True, with_pip=True)
        pip(builder, "install", "-q", *BUILD_NEEDS)
        (builder / "complete").touch()
    for old in wheels.glob("*.whl"):
        old.unlink()
    build, environment = sanitized()
    pip(builder, "wheel", "-q", "--no-build-isolation", "--no-deps", f"--config-settings=build-dir={work / 'build'}",
        *build, "-w", wheels, source)
    # The other way in has the same CMake project behind it: that it resolves is enough.
    pip(builder, "install", "-q", "--dry-run", "--no-build-isolation", "--no-deps", source / "bindings/python")
    (wheel,) = wheels.glob("*.whl")

    venv.create(clean, clear=True, with_pip=True)
    # Most modules of most packages are never imported; compiling them all takes longer than installing them.
    pip(clean, "install", "-q", "--no-compile", wheel, *TEST_NEEDS)
    report = work / "report.xml"
    # Not from the source tree, where the package of the same name has no native module.
    status = run(clean / "bin/python", "-m", "pytest", "-v", "-rs", "-p", "no:cacheprovider", "--tb=short", f"--junitxml={report}",
                 "--rootdir", source, source / "bindings/python/tests", *arguments, cwd=work, env=environment).returncode
    skipped = int(ElementTree.parse(report).find("testsuite").get("skipped")) if status == 0 else 0
    raise SystemExit(77 if skipped else status)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
