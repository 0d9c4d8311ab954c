"""A mesh of fewer triangles, for pictures while something moves."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def coarser(v: NDArray[np.float32], triangles: NDArray[np.uint32],
            wanted: int = 40000) -> tuple[float, NDArray[np.uint32]]:
    """The length of an edge, and about `wanted` triangles of the same vertices, (n, 3). One vertex represents
    all vertices in a cell of a grid [Rossignac and Borrel 1993].

    `v`: position, normal, albedo, id and curvature in each row. Lips that touch and the two sides of a thin
    sheet stay apart, because merged vertices have one material, normals in one octant, and similar albedos.
    Cells are a quarter as wide where curvature is high, such as at lids, lips and ears, and at the rim.
    """
    if len(triangles) < 1.5 * wanted:
        return 0.0, triangles
    place = v[:, 0:3].astype(np.float64)
    a, b, c = (place[triangles[:, i]] for i in range(3))
    # Larger than needed for this count, because curved places have smaller cells.
    cell = 1.5 * np.sqrt(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / wanted)
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    edge, count = np.unique(edges[:, 0] << 32 | edges[:, 1], return_counts=True)
    fine = np.abs(v[:, 10]) * cell > 0.6
    fine[np.concatenate([edge[count == 1] >> 32, edge[count == 1] & 0xffffffff])] = True  # the rim
    # Vertices at one point stay together: no cracks between faces with normals of their own.
    _, point = np.unique(place, axis=0, return_inverse=True)
    normal = np.stack([np.bincount(point.reshape(-1), v[:, i]) for i in (3, 4, 5)], 1)[point.reshape(-1)]
    keys = np.column_stack([np.floor((place - place.min(0)) / np.where(fine, cell / 4, cell)[:, None]), fine,
                            (normal > 0) @ (1, 2, 4), v[:, 9], np.round(8 * v[:, 6:9].sum(1))])
    _, first, member = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    joined = first.astype(np.uint32)[member.reshape(-1)][triangles]
    joined = joined[(joined != np.roll(joined, 1, axis=1)).all(1)]
    # Triangles that coincide are drawn once.
    joined = joined[np.unique(np.sort(joined, axis=1), axis=0, return_index=True)[1]]
    return float(cell), np.ascontiguousarray(joined)
