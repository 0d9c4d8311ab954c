"""Where the files of a batch go: complete or not at all, whatever the disk says."""
import errno
import fcntl
import os
import re
import stat
import time

import pytest

pytest.importorskip("distributed", reason="distributed is not installed: pip install pellucid[batch]")
pytest.importorskip("pellucid.batch", reason="the package was built without toml++")
from pellucid.batch import store as module  # noqa: E402
from pellucid.batch.store import Store, StoreError  # noqa: E402

NAME = "curvature-0123456789abcdef.exr"


@pytest.fixture
def store(tmp_path):
    (tmp_path / NAME).write_bytes(b"old")
    return Store(tmp_path)


def fails(code):
    def call(*_args, **_keywords):
        raise OSError(code, os.strerror(code))
    return call


@pytest.mark.parametrize("call", ["replace", "fsync", "write", "open"])
@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EIO, errno.EACCES])
def test_a_failing_disk_is_an_error_and_leaves_what_was_there(store, tmp_path, monkeypatch, call, code):
    with monkeypatch.context() as patch:
        patch.setattr(module.os, call, fails(code))
        with pytest.raises(StoreError, match=f"{NAME}: cannot be written: {os.strerror(code)}"):
            store.write(NAME, b"new")
    assert os.listdir(tmp_path) == [NAME] and (tmp_path / NAME).read_bytes() == b"old"
    store.write(NAME, b"new")
    assert os.listdir(tmp_path) == [NAME] and (tmp_path / NAME).read_bytes() == b"new"


def test_an_interrupt_leaves_nothing_behind(store, tmp_path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt
    monkeypatch.setattr(module.os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        store.write(NAME, b"new")
    assert os.listdir(tmp_path) == [NAME] and (tmp_path / NAME).read_bytes() == b"old"


def test_file_and_folder_are_flushed_in_turn(store, tmp_path, monkeypatch):
    done, fsync, replace = [], os.fsync, os.replace

    def flushed(fd):
        done.append("folder" if stat.S_ISDIR(os.fstat(fd).st_mode) else "file")
        return fsync(fd)

    def renamed(*names):
        done.append("renamed")
        return replace(*names)
    monkeypatch.setattr(module.os, "fsync", flushed)
    monkeypatch.setattr(module.os, "replace", renamed)
    store.write(NAME, b"new")
    assert done == ["file", "renamed", "folder"]


def test_a_folder_that_cannot_be_flushed(store, tmp_path, monkeypatch):
    fsync = os.fsync

    def flush(code):
        return lambda fd: fails(code)() if stat.S_ISDIR(os.fstat(fd).st_mode) else fsync(fd)
    with monkeypatch.context() as patch:
        patch.setattr(module.os, "fsync", flush(errno.EINVAL))  # of a file system that has no such thing
        store.write(NAME, b"new")
        patch.setattr(module.os, "fsync", flush(errno.EIO))
        with pytest.raises(StoreError, match="Input/output error"):
            store.write(NAME, b"newer")
    assert os.listdir(tmp_path) == [NAME]


def test_temporary_names_are_random_locked_and_never_followed(store, tmp_path, monkeypatch):
    seen, replace = [], os.replace

    def look(temporary, target):
        assert re.fullmatch(r"\.curvature-0123456789abcdef\.[0-9a-f]{8}-[0-9a-f]{16}\.tmp\.exr", temporary.name)
        with open(temporary, "rb") as other, pytest.raises(BlockingIOError):
            fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
        seen.append(temporary.name)
        replace(temporary, target)
    monkeypatch.setattr(module.os, "replace", look)
    store.write(NAME, b"new")
    store.write(NAME, b"new")
    assert len(set(seen)) == 2
    # A link that somebody planted under the next name is not written through.
    monkeypatch.setattr(module.secrets, "token_hex", lambda _: "0123456789abcdef")
    victim = tmp_path / "victim"
    victim.write_text("precious")
    planted = tmp_path / f".curvature-0123456789abcdef.{module._native.machine_tag()}-0123456789abcdef.tmp.exr"
    planted.symlink_to(victim)
    with pytest.raises(StoreError, match="File exists"):
        store.write(NAME, b"newer")
    assert victim.read_text() == "precious" and planted.is_symlink()


def test_what_is_no_file_is_not_replaced(store, tmp_path):
    os.mkfifo(tmp_path / "pipe.exr")
    with pytest.raises(StoreError, match="is not a file"):
        store.write("pipe.exr", b"new")


def test_the_command_sweeps_what_a_worker_left(tmp_path):
    """The names are those that `pellucid batch` knows, with its own idea of this machine."""
    command = os.environ.get("PELLUCID_COMMAND")
    if not command:
        pytest.skip("PELLUCID_COMMAND names no command")
    import subprocess
    left = tmp_path / f".t.{module._native.machine_tag()}-0123456789abcdef.tmp.exr"
    left.write_bytes(b"half")
    os.utime(left, (time.time() - 100,) * 2)
    subprocess.run([command, "profile", "fit", "marble", "--gaussians", "1", "-o", tmp_path / "p.toml"], check=True,
                   capture_output=True)
    assert os.listdir(tmp_path) == ["p.toml"]
