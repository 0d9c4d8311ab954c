"""Scenes of glTF 2.0: what `pellucid import` reads, as arrays and structures."""
from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Optional, Union

from ._types import Ambient, Light, Material
from .device import _filled
from .files import Mesh, _files, _framed, _profile


@dataclass
class GltfCamera:
    """A perspective camera of the file; the place is in mm, directions are unit."""

    position: tuple[float, float, float]
    forward: tuple[float, float, float]
    up: tuple[float, float, float]
    vertical_fov: float  # radians
    aspect: float        # width / height; 0: the picture's own


@dataclass
class Gltf:
    """A glTF scene; made by `load_gltf`. Materials are numbered from 1, in the file's order; lengths in mm.

    `materials` go to `Shader.set_material` as they are, `lights` to `set_lights` and `ambient` to
    `set_ambient`; curvature comes from `MeshTopology.curvature` of the mesh, and `mesh.ids` are the
    materials of vertices.
    """

    mesh: Mesh                              # in the world; y up, front z
    names: dict[int, str]                   # of materials in the file
    taken_for: dict[int, str]               # "volume", "thin sheet", "profile", "clear", "metal" or "plain"
    materials: dict[int, Material]          # with their profiles
    # PNG or JPEG files: sRGB pictures that multiply `albedo`; row 0 is at v = 0, repeated
    textures: dict[int, bytes]
    lights: list[Light]                     # of the file, or one lamp where it has none
    ambient: Ambient                        # black, or a little sky beside that lamp
    cameras: list[GltfCamera] = field(default_factory=list)
    source: str = ""
    _native: Any = field(default=None, repr=False)

    def save(self, folder: Any) -> None:
        """Writes scene.toml, mesh.obj and the profiles as `pellucid import` does, without a G-buffer.

        The folder is created if needed. Changes of the structures here are not written: change the scene that
        `load_scene` reads from there.

        Raises
        ------
        files.FileError, OSError
            Something cannot be written.
        """
        self._native.save(str(folder))


def load_gltf(path: Any, *, profiles: Union[str, Mapping[str, Any], None] = None, unit_mm: float = 1000.0,
              lights: Optional[float] = None) -> Gltf:
    """Reads a glTF 2.0 scene as docs/guide/gltf.md describes it.

    Parameters
    ----------
    path : str or path
        .glb, or .gltf with its files beside it.
    profiles : str, or dict of str to str or path, optional
        In place of what the file says: a profile of the library or a .toml file for all materials, or by the
        names of materials.
    unit_mm : float
        Millimetres per unit; glTF's unit is the metre.
    lights : float, optional
        Factor of the lights' brightness in lux and candela. Without it a factor is chosen that exposes the
        scene well.

    Raises
    ------
    files.FileError
        A file that is missing or damaged; the message names the place in it. An unknown profile.
    ValueError
        A material in `profiles` that the file does not have.
    """
    for name, value in (("unit_mm", unit_mm), ("lights", lights)):
        if value is not None and not 1e-9 <= value <= 1e9:
            raise ValueError(f"{name} is {value!r}; it must be from 1e-9 to 1e9")
    if isinstance(profiles, str):
        words = [profiles]
    else:
        words = [f"{material}={os.fspath(profile)}" for material, profile in (profiles or {}).items()]
    native = _files.Gltf(str(path), words, unit_mm, lights)
    parts = native.parts()
    materials, names, taken_for, textures = {}, {}, {}, {}
    for number, (name, taken, data, profile, picture) in enumerate(parts["materials"], 1):
        names[number], taken_for[number] = name, taken
        materials[number] = _filled(Material, data)
        if profile is not None:
            materials[number].profile = _profile(profile)
        if picture is not None:
            textures[number] = picture
    return Gltf(_framed(parts["mesh"], True, str(path)), names, taken_for, materials, textures,
                [_filled(Light, data) for data in parts["lights"]], _filled(Ambient, parts["ambient"]),
                [GltfCamera(*camera) for camera in parts["cameras"]], str(path), native)
