"""Scattering in texture space: irradiance of the skin, drawn into its texture and scattered there."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._types import Ambient, Material, TextureScatterParams
from ..scatter import TextureScatter
from ..shader import Shader
from .look import Look, skin_triangles

if TYPE_CHECKING:
    from .session import Session


class Texture:
    """The scattered light of a mesh, updated for a new light or profile. ValueError: the mesh has no UVs."""

    def __init__(self, session: Session, size: int) -> None:
        mesh = session.mesh
        if mesh.uvs is None:
            raise ValueError("this mesh has no texture coordinates, which scattering in a texture needs; "
                             "choose another method")
        triangles = skin_triangles(mesh)
        self._scatter = TextureScatter(session.device, size, size, triangles, mesh.uvs)
        self._scatter.set_positions(mesh.positions)
        position = self._scatter.draw(mesh.positions)
        normal = self._scatter.draw(mesh.normals, unit=True)
        self._inputs = {"position": position, "normal_shading": normal,
                        "material": np.float32(np.abs(normal).max(2) > 0)}
        self._irradiance = np.zeros((size, size, 3), np.float32)
        self._shader = Shader(session.device).set_image("radiance", self._irradiance)
        for slot, image in self._inputs.items():
            self._shader.set_image(slot, image)
        self._shader.set_material(1, Material(scattering="none", thickness_taps=0, specular=0.0,
                                              albedo=(1.0, 1.0, 1.0), shadow_filter_width=1.0 / session.mm))
        self._key: Any = None
        self.light: NDArray[np.float32] = np.zeros((size, size, 3), np.float32)

    def make(self, session: Session, look: Look, small: bool) -> Texture:
        lights = session.lights(look, small)
        profile = session.profile(look)
        key = ([(light._data.tobytes(), id(map)) for light, map in lights], session.ambient(look),
               id(profile), look.radius_scale, look.surroundings, look.surroundings_light,
               look.surroundings_turn)
        if key != self._key:
            self._shader.set_lights([light for light, _ in lights])
            for i, (_, map) in enumerate(lights):
                self._shader.set_light_image(i, "shadow_map", None if map is None else map.depth)
            self._shader.set_ambient(Ambient(constant=[session.ambient(look)] * 3))
            self._shader.set_environment(*(session.surroundings(look) or (None,)))
            self._irradiance[...] = 0
            self._shader.commit().execute()
            params = TextureScatterParams(scale=look.radius_scale / session.mm)
            params.profile = profile
            self._scatter.execute(self._irradiance, out=self.light, params=params)
            self._key = key
        return self
