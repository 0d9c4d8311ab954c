"""Where the files of a batch go: a folder that all workers see, or an object store."""
from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Any, Optional

from .. import _native


class StoreError(Exception):
    """The output is full, gone or not writable: no other entry can succeed either."""


class InTheWay(Exception):
    """Something that is no file has the name of an entry's file."""


class Store:
    """A folder, or whatever fsspec knows by a URL ("s3://bucket/tables", "gs://...", "memory://tables").

    Files appear complete or not at all: in a folder as the command writes them (a temporary name, a flush to
    the disk, a rename); an object store's `put` is so by itself.
    """

    def __init__(self, out: str | os.PathLike[str]) -> None:
        self.out = os.fspath(out).removeprefix("file://")
        self._files: Any = None
        if "://" in self.out:
            try:
                import fsspec  # type: ignore[import-untyped,unused-ignore]

                self._files, self._root = fsspec.core.url_to_fs(self.out)
            except (ImportError, ValueError) as e:
                raise StoreError(f"{self.out}: {e} (URLs need fsspec: pip install pellucid[batch])") from e

    def prepare(self) -> None:
        """Makes the folder if need be."""
        try:
            if self._files is None:
                Path(self.out).mkdir(parents=True, exist_ok=True)
            else:
                self._files.makedirs(self._root, exist_ok=True)
        except Exception as e:  # of an object store: whatever its library raises
            raise StoreError(f"{self.out}: is not a folder and cannot be created: "
                             f"{getattr(e, 'strerror', None) or e}") from e

    def read(self, name: str) -> Optional[bytes]:
        """The file's bytes, None if there is none."""
        try:
            if self._files is None:
                path = Path(self.out) / name
                if not stat.S_ISREG(path.stat().st_mode):
                    raise InTheWay(f"{path} is in the way: it is not a file")
                return path.read_bytes()
            return bytes(self._files.cat_file(f"{self._root}/{name}"))
        except FileNotFoundError:
            return None
        except OSError as e:
            if e.errno == errno.ELOOP:
                raise InTheWay(f"{self.out}/{name} is in the way: {e.strerror}") from e
            raise StoreError(f"{self.out}/{name}: cannot be read: {e.strerror or e}") from e

    def write(self, name: str, data: bytes) -> None:
        """Puts a file there, in place of what had its name."""
        try:
            if self._files is None:
                _native.write_file(os.path.join(self.out, name), data)
            else:
                self._files.pipe_file(f"{self._root}/{name}", data)
        except OSError as e:
            raise StoreError(str(e) if self._files is None
                             else f"{self.out}/{name}: cannot be written: {e.strerror or e}") from e
