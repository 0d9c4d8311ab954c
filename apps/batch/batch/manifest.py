"""Manifests: which tables to make, and each of them as the bytes of a file."""
from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

from .. import _in_flight, _native
from ..device import Device

if not hasattr(_native, "Manifest"):
    raise ImportError("this package was built without toml++, which manifests need: install "
                      "libtomlplusplus-dev and pip install pellucid again")


@dataclass(frozen=True)
class Entry:
    """One table to make.

    Attributes
    ----------
    file : str
        Its name: the one that the manifest gives it, or kind and hash of the key.
    key : str
        All that determines its texels.
    line : int
        Where the manifest asks for it.
    """

    file: str
    key: str
    line: int


class Manifest:
    """The entries of a manifest, each file once.

    Parameters
    ----------
    path : str or path
        TOML, read with the profile files that it names.

    Raises
    ------
    ValueError
        It is no manifest. Entries that make no sense are in `errors` instead; the others stand.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._fill(_native.Manifest.read(os.fspath(path)), os.fspath(path))

    def _fill(self, handle: _native.Manifest, path: str) -> None:
        self._handle, self.path = handle, path
        self.entries = [Entry(*handle.entry(i)) for i in range(len(handle))]
        #: (line, message) of each invalid entry.
        self.errors = handle.errors()
        #: How many entries repeat an earlier one.
        self.duplicates = handle.duplicates()

    def __len__(self) -> int:
        return len(self.entries)

    def make(self, device: Device, index: int) -> bytes:
        """Integrates entry `index` and returns its file, an EXR. The same bytes on every device of one kind.

        Raises
        ------
        PellucidError
            INVALID_ARGUMENT and the like: the entry cannot be made anywhere. DEVICE, OUT_OF_MEMORY: not here.
        """
        return bytes(_in_flight.interruptible(lambda: self._handle.make(device._handle, index)))

    def holds(self, index: int, file: bytes) -> bool:
        """Whether these bytes are entry `index`: whole, unchanged, and made for this request."""
        return _native.verify_file(file, self.entries[index].key)

    @property
    def index_name(self) -> str:
        """Of the index beside the tables."""
        return str(self._handle.index_name(self.path))

    def index(self, there: Sequence[bool]) -> bytes:
        """The index, JSON: `there` says per entry whether its file is there (docs/guide/batch.md)."""
        if len(there) != len(self):
            raise ValueError(f"there has {len(there)} values; one for each of the {len(self)} entries "
                             "is needed")
        return str(self._handle.index(self.path, list(there))).encode()

    # A manifest travels as texts, so that workers need no file of it.
    def __getstate__(self) -> tuple[str, str, dict[str, str]]:
        return self.path, self._handle.text(), self._handle.profiles()

    def __setstate__(self, state: tuple[str, str, dict[str, str]]) -> None:
        self._fill(_native.Manifest.parse(*state), state[0])
