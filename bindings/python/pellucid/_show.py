"""Pictures of objects for notebooks: PNG bytes, and plots with matplotlib where it is installed."""
from __future__ import annotations

import struct
import zlib
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray


def srgb(linear: ArrayLike) -> NDArray[np.uint8]:
    """Linear values to sRGB bytes, cut to 0 .. 1; NaN is 0 (IEC 61966-2-1)."""
    x = np.clip(np.nan_to_num(np.asarray(linear, np.float64), nan=0.0), 0, 1)
    return np.rint(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)).astype(np.uint8)


def linear(encoded: ArrayLike) -> NDArray[np.float32]:
    """The inverse, for values from 0 to 1."""
    x = np.asarray(encoded, np.float64)
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4).astype(np.float32)


def png(pixels: NDArray[np.uint8]) -> bytes:
    """(height, width, 3) sRGB bytes as a PNG file [ISO/IEC 15948]."""
    height, width, _ = pixels.shape

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    # no filter in any row
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], 1)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b""))


def axes(ax: Optional[Any]) -> Any:
    """The given matplotlib axes, or new ones."""
    if ax is not None:
        return ax
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("plots need matplotlib: pip install 'pellucid[plot]'") from error
    return Figure(figsize=(5, 3), layout="constrained").add_subplot()
