"""The command that the package brings."""
import json
import subprocess
import sys

import pytest

from pellucid import _command


def run(*arguments):
    return subprocess.run([sys.executable, "-m", "pellucid._command", *arguments], capture_output=True,
                          text=True, timeout=120)


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
