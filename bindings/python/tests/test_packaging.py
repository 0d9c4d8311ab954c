"""The package as the build lays it out: its files, its command, and OpenCL found at run time."""
import json
import os
import re
import subprocess
import sys
from importlib import resources
from pathlib import Path

import pytest
from places import ROOT

import pellucid as pel
from pellucid import _command, _driver


def test_version_is_the_projects():
    version = re.search(r"project\(pellucid VERSION ([0-9.]+)",
                        (ROOT / "CMakeLists.txt").read_text()).group(1)
    assert pel.__version__ == version


@pytest.mark.skipif(sys.version_info < (3, 11), reason="tomllib is not installed")
def test_pip_installs_what_the_pages_name():
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    for module in project["scripts"].values():
        name, function = module.split(":")
        source = resources.files("pellucid").joinpath(*name.split(".")[1:-1], name.split(".")[-1] + ".py")
        assert f"def {function}(" in source.read_text()
    assert {"view", "batch", "cpu"} <= set(project["optional-dependencies"])


def test_types_and_the_library_are_inside():
    files = {f.name for f in resources.files("pellucid").iterdir()}
    assert {"py.typed", "_types.py", "_native.pyi", "libpellucid.so", "view", "batch"} <= files


def python(*arguments, **variables):
    return subprocess.run([sys.executable, *arguments], env={**os.environ, **variables}, capture_output=True,
                          text=True, timeout=120)


def run(*arguments):
    return python("-m", "pellucid._command", *arguments)


def test_the_compiled_program_answers():
    if not _command.program().exists():
        pytest.skip("this build has no program")
    devices = run("devices", "--json")
    assert devices.returncode == 0 and json.loads(devices.stdout)["devices"]
    assert run("shade", "--help").returncode == 0
    assert run("shade").returncode == 2
    assert "view" in run("--help").stdout


def test_its_own_subcommands():
    pytest.importorskip("nicegui", reason="nicegui is not installed")
    for name, flag in (("view", "--unit-mm"), ("gallery", "--pictures-only")):
        done = run(name, "--help")
        assert done.returncode == 0 and flag in done.stdout


def test_without_the_program(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(_command, "program", lambda: tmp_path / "none")
    monkeypatch.setattr(sys, "argv", ["pellucid", "devices"])
    assert _command.main() == 2
    assert "libcli11-dev" in capsys.readouterr().err


COMPUTE = """
import numpy as np, pellucid as pel
print(pel.Device().info.platform)
print(np.asarray(pel.Lut.curvature(pel.Device(), width=4, height=4).read()).tobytes().hex())
"""


def driver_of(platform):
    """The library of an installed driver, by its file in the folder of drivers."""
    for file in Path("/etc/OpenCL/vendors").glob("*.icd"):
        if platform in file.name:
            return file.read_text().strip()
    pytest.skip(f"{platform} is not installed")


def test_without_a_library_the_package_loads_and_says_what_to_install():
    failed = python("-c", "import pellucid; print(pellucid.devices()); pellucid.Device()",
                    PELLUCID_OPENCL="/nowhere/libOpenCL.so.1")
    assert failed.stdout.strip() == "[]"
    for word in ("/nowhere/libOpenCL.so.1", "apt-get install ocl-icd-libopencl1", "pellucid[cpu]",
                 "PELLUCID_OPENCL"):
        assert word in failed.stderr


def test_another_library_is_named_and_the_next_of_the_list_is_taken():
    failed = python("-c", "import pellucid; pellucid.Device()", PELLUCID_OPENCL="libm.so.6")
    assert "libm.so.6 is not an OpenCL library" in failed.stderr
    assert python("-c", COMPUTE, PELLUCID_OPENCL="/nowhere.so:libm.so.6::libOpenCL.so.1").returncode == 0


def test_a_driver_without_a_loader_computes_the_same_bits():
    by_loader = python("-c", COMPUTE, PELLUCID_DEVICE="Portable")
    by_itself = python("-c", COMPUTE, PELLUCID_OPENCL=driver_of("pocl"), PELLUCID_DEVICE="Portable")
    assert by_itself.returncode == 0, by_itself.stderr
    assert by_itself.stdout == by_loader.stdout and "Portable Computing Language" in by_itself.stdout


def test_the_driver_of_the_extra_comes_last(monkeypatch, tmp_path):
    monkeypatch.delenv("PELLUCID_OPENCL", raising=False)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    (tmp_path / "lib").mkdir()
    before = dict(os.environ)
    _driver.offer()
    here = os.environ.get("PELLUCID_OPENCL", "")  # another environment may have it
    assert str(tmp_path) not in here
    monkeypatch.delenv("PELLUCID_OPENCL", raising=False)
    driver = tmp_path / "lib/libintelocl.so"
    driver.touch()
    _driver.offer()
    assert os.environ["PELLUCID_OPENCL"].split(":") == ["libOpenCL.so.1", "libOpenCL.so", str(driver)]
    monkeypatch.setenv("PELLUCID_OPENCL", "mine.so")
    _driver.offer()
    assert os.environ["PELLUCID_OPENCL"] == "mine.so" and set(os.environ) - set(before) <= {"PELLUCID_OPENCL"}
