"""Where the files of a batch go: a folder that all workers see, or an object store."""
from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import secrets
from pathlib import Path
from typing import Any, Optional

from .. import _native


class StoreError(Exception):
    """The output is full, gone or not allowed: no entry will fare better."""


class Store:
    """A folder, or whatever fsspec knows by a URL ("s3://bucket/tables", "gs://...", "memory://tables").

    Files appear complete or not at all: in a folder by a temporary name, a flush to the disk and a rename, as the command does
    it; an object store's `put` is so by itself.
    """

    def __init__(self, out: str | os.PathLike[str]) -> None:
        self.out = os.fspath(out)
        if self.out.startswith("file://"):
            self.out = self.out[len("file://"):]
        self._files: Any = None
        if "://" in self.out:
            try:
                import fsspec  # type: ignore[import-untyped,unused-ignore]
            except ImportError as e:
                raise StoreError(f"{self.out} needs fsspec: pip install pellucid[batch]") from e
            try:
                self._files, self._root = fsspec.core.url_to_fs(self.out)
            except (ImportError, ValueError) as e:
                raise StoreError(f"{self.out}: {e}") from e

    def __reduce__(self) -> tuple[Any, ...]:
        return Store, (self.out,)

    def prepare(self) -> None:
        """Makes the folder if need be."""
        try:
            if self._files is None:
                Path(self.out).mkdir(parents=True, exist_ok=True)
            else:
                self._files.makedirs(self._root, exist_ok=True)
        except Exception as e:  # of an object store: whatever its library raises
            raise StoreError(f"{self.out}: is not a folder and cannot be made one: {getattr(e, 'strerror', None) or e}") from e

    def read(self, name: str) -> Optional[bytes]:
        """The file's bytes, None if there is none."""
        try:
            if self._files is None:
                return (Path(self.out) / name).read_bytes()
            return bytes(self._files.cat_file(f"{self._root}/{name}"))
        except FileNotFoundError:
            return None
        except OSError as e:
            raise StoreError(f"{self.out}/{name}: cannot be read: {e.strerror or e}") from e

    def write(self, name: str, data: bytes) -> None:
        """Puts a file there, in place of what had its name."""
        try:
            if self._files is None:
                self._write_local(Path(self.out), name, data)
            else:
                self._files.pipe_file(f"{self._root}/{name}", data)
        except OSError as e:
            raise StoreError(f"{self.out}/{name}: cannot be written: {e.strerror or e}") from e

    @staticmethod
    def _write_local(folder: Path, name: str, data: bytes) -> None:
        target = folder / name
        if target.exists() and not target.is_file():
            raise OSError(errno.EINVAL, "is not a file; a file must have this name")
        stem, _, extension = name.rpartition(".")
        # Of the form that the command removes when it finds it abandoned, which the lock tells.
        temporary = folder / f".{stem}.{_native.machine_tag()}-{secrets.token_hex(8)}.tmp.{extension}"
        fd = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        try:
            with contextlib.suppress(OSError):  # where there are no locks, age alone tells
                fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
            view = memoryview(data)
            while view:
                view = view[os.write(fd, view):]
            os.fsync(fd)
            os.replace(temporary, target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
        finally:
            os.close(fd)
        _flush_folder(folder)


def _flush_folder(folder: Path) -> None:
    """Puts names in a folder on the disk, where the file system can."""
    try:
        fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except PermissionError:  # it may hold files and not be listed
        return
    try:
        os.fsync(fd)
    except OSError as e:
        if e.errno not in (errno.EINVAL, errno.EBADF, errno.ENOTSUP):
            raise
    finally:
        os.close(fd)
