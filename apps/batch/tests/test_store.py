"""Where the files of a batch go. How a file becomes complete or stays away is the command's code and tested
with it."""
import os
import resource

import pytest

pytest.importorskip("distributed", reason="distributed is not installed: pip install pellucid[batch]")
pytest.importorskip("pellucid.batch", reason="the package was built without toml++")
from pellucid.batch.store import Store, StoreError  # noqa: E402

NAME = "curvature-0123456789abcdef.exr"


def test_a_disk_that_takes_no_more_is_an_error_and_leaves_what_was_there(tmp_path):
    store = Store(tmp_path)
    store.write(NAME, b"old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(StoreError, match=f"{NAME}: cannot be written: File too large"):
            store.write(NAME, bytes(2000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert os.listdir(tmp_path) == [NAME] and store.read(NAME) == b"old"
    store.write(NAME, b"new")
    assert os.listdir(tmp_path) == [NAME] and store.read(NAME) == b"new"


def test_what_is_no_file_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe.exr")
    with pytest.raises(StoreError, match="must be the name of a file"):
        Store(tmp_path).write("pipe.exr", b"new")


def test_a_folder_that_has_gone(tmp_path):
    store = Store(tmp_path / "gone")
    assert store.read(NAME) is None
    with pytest.raises(StoreError, match="there is no folder"):
        store.write(NAME, b"new")
