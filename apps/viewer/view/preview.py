"""A mesh of fewer triangles, for pictures while something moves."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def clustered(vertices: NDArray[np.float32], triangles: NDArray[np.uint32],
              cell: float) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices that share a cell of a grid become one, their mean [Rossignac and Borrel 1993].

    Lips that touch and the two sides of a thin sheet stay apart: only vertices of one material whose normals
    point into the same octant are joined.

    Parameters
    ----------
    vertices : (n, 10 or more)
        Position, normal, albedo, id, and what else is to be averaged.
    triangles : (m, 3)
    cell : float
        Side of a cell, in the unit of the positions.
    """
    used = np.unique(triangles)
    v = vertices[used].astype(np.float64)
    place = np.floor((v[:, 0:3] - v[:, 0:3].min(0)) / cell).astype(np.int64)
    # Vertices at one point stay together: no cracks between faces with normals of their own.
    _, point = np.unique(v[:, 0:3], axis=0, return_inverse=True)
    point = point.reshape(-1)
    normal = np.stack([np.bincount(point, v[:, c]) for c in (3, 4, 5)], 1)[point]
    octant = (normal > 0) @ np.array([1, 2, 4])
    keys = np.column_stack([place, octant, v[:, 9]])
    _, member, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    member = member.reshape(-1)
    mean = np.stack([np.bincount(member, v[:, c]) for c in range(v.shape[1])], 1) / count[:, None]
    mean[:, 3:6] /= np.maximum(np.linalg.norm(mean[:, 3:6], axis=1, keepdims=True), 1e-12)
    to = np.zeros(len(vertices), np.uint32)
    to[used] = member
    joined = to[triangles]
    a, b, c = joined.T
    joined = joined[(a != b) & (b != c) & (c != a)]
    # Triangles that fell together are drawn once.
    first = np.sort(joined, axis=1)
    return mean.astype(np.float32), joined[np.unique(first, axis=0,
                                                     return_index=True)[1]] if len(joined) else joined


def spacing(vertices: NDArray[np.float32], triangles: NDArray[np.uint32]) -> float:
    """The side of a square that has the area of two triangles, on average."""
    p = vertices[:, 0:3].astype(np.float64)[triangles]
    area = 0.5 * np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum()
    return float(np.sqrt(2 * area / max(len(triangles), 1)))


def levels(vertices: NDArray[np.float32], triangles: NDArray[np.uint32],
           most: tuple[int, ...] = (50000, 20000)) -> list[tuple[float, NDArray[np.float32],
                                                                 NDArray[np.uint32]]]:
    """The mesh, and coarser ones of about `most` triangles: (spacing, vertices, triangles), finest first."""
    whole = spacing(vertices, triangles)
    made = [(whole, vertices, triangles)]
    for wanted in most:
        if len(triangles) <= 1.5 * wanted:
            continue
        cell = whole * (len(triangles) / wanted) ** 0.5
        v, t = clustered(vertices, triangles, cell)
        if 0 < len(t) < len(made[-1][2]):
            made.append((cell, v, t))
    return made
