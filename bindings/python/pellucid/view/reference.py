"""The picture that every diffusion method approximates, for what the viewer shows.

Irradiance is made at the vertices, with the shadows of the lights' maps there; the surface integral then spreads it. Edges of
shadows are therefore as sharp as the mesh is fine: `pellucid reference` traces them exactly.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..reference import surface_integral
from .look import SKIN, Look
from .passes import tinted

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


def vertex_irradiance(session: Session, look: Look) -> NDArray[np.float32]:
    """Irradiance / pi at each vertex of skin, (n, 3); 0 elsewhere."""
    mesh = session.mesh
    p, n = mesh.positions.astype(float), mesh.normals.astype(float)
    e = np.full((len(p), 3), look.ambient, np.float32)
    for light, map in session.lights(look):
        cosine = np.maximum(n @ np.asarray(light.to_light, float), 0).astype(np.float32)
        if map is not None:
            cosine *= _lit(map, p, n, 2.04 * session.renderer.radius / len(map.depth))
        e += cosine[:, None] * np.asarray(light.color, np.float32)
    if mesh.ids is not None:
        e[mesh.ids != SKIN] = 0
    return e


def reference(session: Session, look: Look, width: int, height: int, small: bool = False) -> NDArray[np.float32]:
    """Diffuse radiance of the skin that is seen, (height, width, 3); 0 elsewhere. Kept until light, camera or profile change."""
    g = session.gbuffer(width, height, small)
    lights = [(lamp.azimuth, lamp.elevation, lamp.color, lamp.intensity, lamp.shadow, lamp.on) for lamp in look.lamps]
    key = (session.drawn_state(width, height, small), lights, look.ambient, look.profile, look.distance, look.radius_scale, look.shadow_size)
    if session.reference_made is None or session.reference_made[0] != key:
        mesh, seen = session.mesh, g.material == SKIN
        triangles = mesh.triangles if mesh.ids is None else mesh.triangles[mesh.ids[mesh.triangles[:, 0]] == SKIN]
        profile = session.profile(look)
        scattered = np.zeros((height, width, 3), np.float32)
        if seen.any() and len(triangles):
            scattered[seen] = surface_integral(session.device, mesh.positions, triangles, vertex_irradiance(session, look),
                                               np.ascontiguousarray(g.position[seen]), profile=profile,
                                               diffusion_radius=profile.info.radius * look.radius_scale,
                                               millimetres_per_unit=session.mm)
        session.reference_made = (key, scattered)
    return session.reference_made[1] * tinted(g, look)
