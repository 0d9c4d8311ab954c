"""The package as the build lays it out."""
import re
import sys
from importlib import resources

import pytest
from places import ROOT

import pellucid as pel


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
