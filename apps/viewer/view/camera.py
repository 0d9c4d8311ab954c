"""Where the viewer looks from."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


def unit(v: ArrayLike) -> NDArray[np.float64]:
    a = np.asarray(v, np.float64)
    return a / max(np.linalg.norm(a), 1e-30)


def direction(up: ArrayLike, front: ArrayLike, azimuth: float, elevation: float) -> NDArray[np.float64]:
    """Unit vector away from a head. Degrees: azimuth 0 is its front, 90 its left ear, elevation 90 is up."""
    a, e = np.radians(azimuth), np.radians(elevation)
    u, f = unit(up), unit(front)
    return unit((f * np.cos(a) + np.cross(u, f) * np.sin(a)) * np.cos(e) + u * np.sin(e))


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike) -> NDArray[np.float64]:
    """World to view: x right, y up, looking along -z."""
    forward = unit(np.subtract(target, eye))
    right = np.cross(forward, np.asarray(up, np.float64))
    if np.linalg.norm(right) < 1e-6:  # along `up`: any side will do
        right = np.cross(forward, np.roll(np.asarray(up, np.float64), 1))
    right = unit(right)
    rows = np.array([right, np.cross(right, forward), -forward])
    m = np.eye(4)
    m[:3, :3], m[:3, 3] = rows, -rows @ np.asarray(eye, np.float64)
    return m


def perspective(fov: float, aspect: float, near: float, far: float) -> NDArray[np.float64]:
    """OpenGL's: z from -1 at the near plane to 1 at the far one. `fov`: degrees from bottom to top."""
    h = 1 / np.tan(np.radians(fov) / 2)
    return np.array([[h / aspect, 0, 0, 0], [0, h, 0, 0],
                     [0, 0, (near + far) / (near - far), 2 * near * far / (near - far)], [0, 0, -1, 0]])


def parallel(half: float, near: float, far: float) -> NDArray[np.float64]:
    """OpenGL's, of a square `2 half` wide."""
    return np.array([[1 / half, 0, 0, 0], [0, 1 / half, 0, 0],
                     [0, 0, 2 / (near - far), (near + far) / (near - far)], [0, 0, 0, 1]])


@dataclass
class Orbit:
    """A camera that looks at a point from around."""

    azimuth: float = 20.0    # degrees
    elevation: float = 2.0
    distance: float = 1.0    # length
    fov: float = 20.0        # degrees from bottom to top
    pan: tuple[float, float] = (0.0, 0.0)  # length the target moves to the right and up
    pivot: tuple[float, float, float] = (0.0, 0.0, 0.0)  # from the centre to the point that it turns about

    def frame(self, low: ArrayLike, high: ArrayLike, aspect: float, fill: float = 0.94) -> None:
        """So far away that the box takes `fill` of the picture."""
        size = np.subtract(high, low)
        tall = max(float(np.max(size)) if aspect >= 1 else float(np.max(size)) / aspect, 1e-6)
        self.distance = float(0.5 * tall / (fill * np.tan(np.radians(self.fov) / 2)) + 0.5 * np.max(size))
        self.pan, self.pivot = (0.0, 0.0), (0.0, 0.0, 0.0)

    def matrices(self, up: ArrayLike, front: ArrayLike, centre: ArrayLike, radius: float, aspect: float):
        """Eye, and world to clip space; near and far plane enclose a ball of `radius` about `centre`."""
        back, about = direction(up, front, self.azimuth, self.elevation), np.add(centre, self.pivot)
        view = look_at(about + back * self.distance, about, up)
        target = about + self.pan[0] * view[0, :3] + self.pan[1] * view[1, :3]
        eye = target + back * self.distance
        view = look_at(eye, target, up)
        depth = float(np.linalg.norm(eye - centre))
        far = depth + 1.05 * radius
        near = max(depth - 1.05 * radius, 0.01 * far)
        return eye, perspective(self.fov, aspect, near, far) @ view
