"""Skin from its pigments: colour, spectrum, and maps of melanin and blood."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _in_flight, _native
from ._types import Skin, SkinInfo
from .device import _filled


def skin_info(skin: Optional[Skin] = None, **fields: Any) -> SkinInfo:
    """Albedo, mean free path, mean distance and more of skin: skin_info(melanin=0.05, blood=0.02)."""
    return _filled(SkinInfo, _native.skin_info(Skin._with(skin, fields)._data))


def skin_reflectance(nanometres: ArrayLike, skin: Optional[Skin] = None,
                     **fields: Any) -> NDArray[np.float32]:
    """Share of diffuse light that skin reflects at wavelengths from 380 to 720 nm."""
    at = np.ascontiguousarray(nanometres, np.float32)
    out = np.empty_like(at)
    _native.skin_reflectance(Skin._with(skin, fields)._data, at.ctypes.data, at.size, out.ctypes.data)
    return out


def skin_albedo(melanin: ArrayLike, blood: ArrayLike, skin: Optional[Skin] = None,
                **fields: Any) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Maps of melanin and blood as linear RGB albedo (..., 3), and as lengths relative to the profile of
    `skin` (...), for the second component of a scatter weight."""
    m, b = (np.ascontiguousarray(a, np.float32) for a in np.broadcast_arrays(melanin, blood))
    albedo, radius = np.empty((*m.shape, 3), np.float32), np.empty(m.shape, np.float32)
    made = Skin._with(skin, fields)
    _native.skin_albedo(made._data, m.ctypes.data, b.ctypes.data, m.size, albedo.ctypes.data,
                        radius.ctypes.data)
    return albedo, radius


def skin_from_albedo(albedo: ArrayLike, skin: Optional[Skin] = None, **fields: Any,
                     ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Melanin, blood and the CIEDE2000 difference that remains, (...) each, of linear RGB (..., 3)."""
    a = np.ascontiguousarray(albedo, np.float32)
    if a.ndim < 1 or a.shape[-1] != 3:
        raise ValueError(f"albedo has the shape {a.shape}; (..., 3) is needed")
    maps = np.empty((3, a.size // 3), np.float32)
    made = Skin._with(skin, fields)
    _in_flight.interruptible(lambda: _native.skin_from_albedo(
        made._data, a.ctypes.data, a.size // 3, *(m.ctypes.data for m in maps)), made, a, maps)
    melanin, blood, difference = maps.reshape(3, *a.shape[:-1])
    return melanin, blood, difference
