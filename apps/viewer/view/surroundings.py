"""Light from all round: a studio of soft boxes, or an image of one's own."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import files
from .._show import linear
from .camera import direction, unit

STUDIO = "studio"
# Azimuth and elevation of the middle, width and height, all in degrees; radiance.
_BOXES = ((50, 35, 60, 40, 4.0), (-70, 5, 50, 70, 0.7), (165, 25, 24, 80, 3.0))


def directions(height: int) -> NDArray[np.float64]:
    """Of the pixels of an equirectangular image, (height, 2 height, 3): y up, z in the middle, x left."""
    down = np.pi * (np.arange(height) + 0.5)[:, None] / height
    turn = np.pi * (1 - (np.arange(2 * height) + 0.5)[None, :] / height)
    return np.stack(np.broadcast_arrays(np.sin(down) * np.sin(turn), np.cos(down),
                                        np.sin(down) * np.cos(turn)), -1)


def studio(height: int = 128) -> NDArray[np.float32]:
    """A key, a fill and a rim light with soft edges, a dim room and a floor."""
    d = directions(height)
    image = np.full(d.shape, 0.04) + 0.03 * np.maximum(d[..., 1:2], 0) + 0.06 * np.maximum(-d[..., 1:2], 0)
    up, front = (0, 1, 0), (0, 0, 1)
    for azimuth, elevation, width, tall, radiance in _BOXES:
        middle = direction(up, front, azimuth, elevation)
        right = unit(np.cross(up, middle))
        above = np.cross(middle, right)
        ahead = np.maximum(d @ middle, 1e-6)
        inside = [np.clip((np.tan(np.radians(size / 2)) - np.abs(d @ axis) / ahead) / 0.06 + 0.5, 0, 1)
                  for axis, size in ((right, width), (above, tall))]
        image += (radiance * (d @ middle > 0) * inside[0] * inside[1])[..., None]
    return image.astype(np.float32)


def read_linear(path: Any, what: str) -> NDArray[np.float32]:
    """The linear colours of a file, (h, w, 3); all but EXR and HDR files are of sRGB. Raises FileError, and
    ValueError without colours, which `what` needs."""
    channels = files.read_image(path)
    if not set("RGB") <= set(channels):
        raise ValueError(f"{path} has the channels {', '.join(channels)}; R, G and B are needed for {what}")
    image = np.stack([channels[c] for c in "RGB"], 2)
    return image if str(path).lower().endswith((".exr", ".hdr")) else linear(image)


def read(path: Any) -> NDArray[np.float32]:
    """The studio, or the linear image of a file, (n, 2 n, 3). Raises FileError and ValueError."""
    if path == STUDIO:
        return studio()
    image = read_linear(path, "surroundings")
    height, width, _ = image.shape
    if width != 2 * height:
        raise ValueError(f"{path} is {width} x {height}; surroundings are twice as wide as high")
    return image


def axes(up: Any, front: Any, turn: float) -> NDArray[np.float32]:
    """Rows: x, y and z of the image in the mesh's coordinates; z is the front, turned by degrees."""
    y, z = unit(up), direction(up, front, turn, 0)
    return np.array([np.cross(y, z), y, z], np.float32)


def _cells(n: int, of: int) -> NDArray[np.float32]:
    """Weights of pixels in the means of n even cells, (n, of)."""
    edges, at = np.linspace(0, of, n + 1)[:, None], np.arange(of)
    shares = np.minimum(edges[1:], at + 1) - np.maximum(edges[:-1], at)
    return (np.maximum(shares, 0) * n / of).astype(np.float32)


def irradiance(image: NDArray[np.float32], rows: NDArray[np.float32],
               normals: NDArray[Any]) -> NDArray[np.float32]:
    """Irradiance / pi along normals, (n, 3): the sum over 16 rows of the image."""
    height = min(16, len(image))
    small = np.einsum("ai,bj,ijc->abc", _cells(height, image.shape[0]), _cells(2 * height, image.shape[1]),
                      image, optimize=True)
    d = directions(height)
    solid = np.sin(np.pi * (np.arange(height) + 0.5) / height)[:, None] * (np.pi / height)**2
    light = (small * (solid / np.pi)[..., None]).reshape(-1, 3).astype(np.float32)
    return np.maximum(normals @ (d.reshape(-1, 3) @ rows).T.astype(np.float32), 0) @ light
