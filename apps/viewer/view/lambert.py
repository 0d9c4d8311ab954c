"""The lighting of a look with NumPy only: for the reference, and for pictures before any kernel is built."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .look import Look
from .surroundings import irradiance

if TYPE_CHECKING:
    from .session import Session


def _lit(map: Any, positions: NDArray[Any], normals: NDArray[Any], texel: float) -> NDArray[np.float32]:
    """Share of 3 x 3 texels that are lit, with a bias of a texel along the normal."""
    matrix = np.asarray(map.light.world_to_shadow, float).reshape(4, 4)
    p = positions + normals * (1.5 * texel)
    uvz = p @ matrix[:3, :3].T + matrix[:3, 3]
    size = len(map.depth)
    x, y = (np.floor(uvz[:, k] * size).astype(int) for k in (0, 1))
    share = np.zeros(len(p), np.float32)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            share += uvz[:, 2] <= map.depth[np.clip(y + dy, 0, size - 1), np.clip(x + dx, 0, size - 1)] + 1e-4
    return share / 9


def irradiance_at(session: Session, look: Look, positions: NDArray[Any], normals: NDArray[Any],
                  small: bool = False) -> NDArray[np.float32]:
    """Irradiance / pi at points of the mesh, (n, 3), by NumPy alone."""
    e = np.full((len(positions), 3), look.ambient, np.float32)
    around = session.surroundings(look)
    if around is not None:
        e += irradiance(*around, normals)
    p, n = positions.astype(float), normals.astype(float)
    for light, map in session.lights(look, small):
        cosine = np.maximum(n @ np.asarray(light.to_light, float), 0).astype(np.float32)
        if map is not None:
            cosine *= _lit(map, p, n, 2.04 * session.renderer.radius / len(map.depth))
        e += cosine[:, None] * np.asarray(light.color, np.float32)
    return e
