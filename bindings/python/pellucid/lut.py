"""Look-up tables."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _in_flight, _native, _show
from ._arrays import output_array
from ._struct import OfThisProcess, to_enum
from ._types import (
    CurvatureLutDesc,
    EyeLutDesc,
    LutAxis,
    LutEncoding,
    LutInfo,
    ShadowLutDesc,
    SpecularLutDesc,
)
from .device import Device, Event, _filled, _handles
from .profile import Profile

_TEXELS = {LutEncoding.FLOAT: (np.float32, 3), LutEncoding.HALF: (np.float16, 3),
           LutEncoding.FACEWORKS8: (np.uint8, 4)}


class Lut(OfThisProcess):
    """A table on the device; made by `curvature`, `shadow`, `specular`, `eye` or `from_texels`.

    Attributes
    ----------
    device : Device
    ready : Event or None
        Done when a submitted table is integrated; reading and shading on the same device wait for it. None:
        it is integrated already.
    """

    _instead = "pass its info and texels, Lut.read, to Lut.from_texels there"

    device: Device
    ready: Optional[Event]
    _handle: _native.Lut

    def __init__(self) -> None:
        raise TypeError("make a table by Lut.curvature, Lut.shadow, Lut.specular, Lut.eye or Lut.from_texels")

    @classmethod
    def _made(cls, device: Device, handle: _native.Lut, event: Optional[_native.Event]) -> Lut:
        self = cls.__new__(cls)
        self.device, self._handle = device, handle
        self.ready = None if event is None else Event(event)
        if event is not None:
            _in_flight.hold(event, self._handle)
        return self

    @classmethod
    def curvature(cls, device: Device, desc: Optional[CurvatureLutDesc] = None, *,
                  profile: Profile | str | None = None,
                  preset: Optional[str] = None, wait: bool = True, waits: Iterable[Event] = (),
                  **fields: Any) -> Lut:
        """Integrates a curvature table: texel (x, y) is D(N.L, r) per channel, row 0 the smallest curvature.

        Parameters
        ----------
        desc : CurvatureLutDesc, optional
            The defaults without it; `fields` are fields of it by themselves (width=256, form="sphere", ...).
        profile : Profile or name of one of the library, optional
            Skin without it.
        preset : "material" or "faceworks", optional
            The defaults of a table without `desc`: as a material makes it from its profile, or as FaceWorks
            does.
        wait : bool
            False: return once it is submitted; `ready` says when it is done.
        """
        return cls._integrated(device, _native.Lut.curvature, CurvatureLutDesc, desc, fields, profile, wait,
                               waits, preset)

    @classmethod
    def shadow(cls, device: Device, desc: Optional[ShadowLutDesc] = None, *,
               profile: Profile | str | None = None,
               preset: Optional[str] = None, wait: bool = True, waits: Iterable[Event] = (),
               **fields: Any) -> Lut:
        """Integrates a shadow table: transmitted light per channel, row 0 of the widest penumbra.

        The parameters are as for `curvature`, with ShadowLutDesc.
        """
        return cls._integrated(device, _native.Lut.shadow, ShadowLutDesc, desc, fields, profile, wait, waits,
                               preset)

    @classmethod
    def specular(cls, device: Device, desc: Optional[SpecularLutDesc] = None, *, wait: bool = True,
                 waits: Iterable[Event] = (), **fields: Any) -> Lut:
        """Tabulates Beckmann's distribution P(n.h, m) as P^0.1 / 2, row 0 the smallest m; see
        SpecularLutDesc."""
        return cls._integrated(device, _native.Lut.specular, SpecularLutDesc, desc, fields, None, wait, waits)

    @classmethod
    def eye(cls, device: Device, desc: Optional[EyeLutDesc] = None, *, profile: Profile | str | None = None,
            wait: bool = True, waits: Iterable[Event] = (), **fields: Any) -> Lut:
        """Integrates the caustic of a cornea: irradiance on the iris, slice below slice from light along the
        gaze on.

        The parameters are as for `curvature`, with EyeLutDesc; `profile` is that of the iris, none without
        it.
        """
        return cls._integrated(device, _native.Lut.eye, EyeLutDesc, desc, fields, profile, wait, waits)

    @classmethod
    def _integrated(cls, device: Device, create: Any, kind: Any, desc: Any, fields: dict[str, Any],
                    profile: Profile | str | None, wait: bool, waits: Iterable[Event],
                    preset: Optional[str] = None) -> Lut:
        if preset not in (None, "material", "faceworks"):
            raise ValueError(f"preset is {preset!r}; it must be one of material, faceworks")
        if preset is not None and desc is not None:
            raise ValueError("preset and desc exclude one another: a preset is where a description begins")
        if preset == "faceworks":
            desc = kind()
            desc._data = np.frombuffer(bytearray(_native.faceworks_defaults(kind._c_name)), kind._dtype)
        settings = kind._with(desc, fields)
        if profile is not None:
            settings.profile = profile
        return cls._made(device, *create(device._handle, settings._data, _handles(waits)))._waited(wait)

    @classmethod
    def from_texels(cls, device: Device, info: LutInfo, texels: NDArray[np.float32]) -> Lut:
        """A table from texels that were integrated before: (height, width, 3) float32, described by `info`.
        """
        if texels.dtype != np.float32:
            raise ValueError(f"texels are {texels.dtype}; float32 is needed")
        packed = np.ascontiguousarray(texels)
        handle = _in_flight.interruptible(
            lambda: _native.Lut.from_texels(device._handle, info._data, packed.ctypes.data, packed.nbytes),
            packed, info)
        return cls._made(device, handle, None)

    def _waited(self, wait: bool) -> Lut:
        if wait and self.ready is not None:
            self.ready.wait()
            self.ready = None
        return self

    @property
    def info(self) -> LutInfo:
        """The table's description."""
        info = _filled(LutInfo, self._handle.info())
        # The handle of a profile that this structure may outlive.
        for part in ("curvature", "shadow", "eye"):
            info._data[part]["profile"] = 0
        return info

    def clipped_texels(self) -> int:
        """Texels of a curvature table that "faceworks8" clips: |D - max(N.L, 0)| is above 1/4 in a channel.

        0 for other kinds. Waits for the table.
        """
        return _in_flight.interruptible(self._handle.clipped)

    def read(self, encoding: LutEncoding | str = LutEncoding.FLOAT,
             out: Optional[NDArray[Any]] = None) -> NDArray[Any]:
        """The texels, top row first.

        Returns
        -------
        (height, width, 3) float32 or float16 for "float" and "half", (height, width, 4) uint8 for
        "faceworks8".
        """
        result, event = self._submit_read(encoding, out, ())
        event.wait()
        return result

    @staticmethod
    def read_stack(device: Device, tables: Sequence[CurvatureLutDesc] | Sequence[ShadowLutDesc],
                   encoding: LutEncoding | str = LutEncoding.FLOAT) -> NDArray[Any]:
        """The texels of many tables of one size, axis and form (or closed ends), made together: several times
        as fast as one by one if they are small. Waits.

        Returns
        -------
        (len(tables), height, width, 3 or 4), types as of `read`; each to the same bits.
        """
        e = to_enum(LutEncoding, encoding, "encoding")
        if len(tables) == 0:
            raise ValueError("tables is empty; a CurvatureLutDesc or ShadowLutDesc for each table is needed")
        kind = type(tables[0])
        if kind not in (CurvatureLutDesc, ShadowLutDesc):
            raise TypeError(f"tables hold {kind.__name__}; CurvatureLutDesc or ShadowLutDesc is needed")
        first = LutInfo(kind="curvature" if kind is CurvatureLutDesc else "shadow")
        infos = np.repeat(first._data, len(tables))
        for info, desc in zip(infos, tables):
            info[first.kind.name.lower()] = kind._bytes_of(desc)[0]
        dtype, components = _TEXELS[e]
        texels = np.empty((len(tables), tables[0].height, tables[0].width, components), dtype)
        _in_flight.interruptible(
            lambda: _native.Lut.read_stack(device._handle, infos.ctypes.data, len(infos), int(e),
                                           texels.ctypes.data, texels.nbytes),
            infos, texels, tables)
        return texels

    def __repr__(self) -> str:
        info = self.info
        height, width = self._size(info)
        return f"<pellucid.Lut {info.kind.name.lower()}, {width} x {height}, {info.profile or 'no profile'}>"

    @staticmethod
    def _size(info: LutInfo) -> tuple[int, int]:
        """Rows and columns; of an eye's table the rows of all slices."""
        size = getattr(info, info.kind.name.lower())
        return size.height * getattr(size, "depth", 1), size.width

    def _repr_png_(self) -> bytes:
        return _show.png(_show.srgb(self.read()))

    def plot(self, ax: Optional[Any] = None) -> Any:
        """Shows the table with its axes; returns matplotlib's axes (new ones without `ax`). Lengths in mm,
        as the library's."""
        info, ax = self.info, _show.axes(ax)
        kind, quarters = info.kind.name, np.linspace(0, 1, 5)
        labels = {"CURVATURE": ("N.L", "curvature, 1/mm"), "SHADOW": ("shadow", "1 / penumbra width, 1/mm"),
                  "SPECULAR": ("N.H", "roughness"),
                  "EYE": ("position on the iris", "slice by the light's angle")}
        ax.imshow(_show.srgb(self.read()), aspect="auto", extent=(0, 1, 1, 0))
        desc = getattr(info, kind.lower())
        across, at, down = quarters, quarters, quarters
        if kind in ("CURVATURE", "SHADOW"):
            root = desc.axis == LutAxis.ROOT
            high, low = (desc.radius_min, desc.radius_max) if kind == "CURVATURE" else (
                desc.width_min, desc.width_max)
            power = 2 if root else 1
            down = ((1 - quarters) * low ** (-1 / power) + quarters * high ** (-1 / power)) ** power
            if kind == "CURVATURE":
                across = 2 * quarters - 1
                at = 0.5 + 0.5 * np.sign(across) * np.abs(across) ** (1 / power)
            elif root:
                at = 0.5 + 0.5 * (np.sqrt(across) - np.sqrt(1 - across))
        elif kind == "EYE":
            down = quarters * desc.depth
        ax.set_xticks(at, [f"{value:g}" for value in across])
        ax.set_yticks(quarters, [f"{value:.3g}" for value in down])
        ax.set_xlabel(labels[kind][0])
        ax.set_ylabel(labels[kind][1])
        return ax

    def submit_read(self, encoding: LutEncoding | str, out: NDArray[Any],
                    waits: Iterable[Event] = ()) -> Event:
        """The same into `out` after `waits`, without waiting."""
        return self._submit_read(encoding, out, waits)[1]

    def _submit_read(self, encoding: LutEncoding | str, out: Optional[NDArray[Any]],
                     waits: Iterable[Event]) -> tuple[NDArray[Any], Event]:
        e = to_enum(LutEncoding, encoding, "encoding")
        info = self.info
        dtype, components = _TEXELS[e]
        result = output_array(out, (*self._size(info), components), dtype, "out")
        if not result.flags.c_contiguous or not result.flags.writeable:
            raise ValueError("out must be C-contiguous and writable")
        with _in_flight.kept(self.device._handle, self, result):
            event = self._handle.read(int(e), result.ctypes.data, result.nbytes, _handles(waits))
            _in_flight.hold(event, self, result)
        return result, Event(event)

