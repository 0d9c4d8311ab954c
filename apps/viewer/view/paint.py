"""Pictures on a mesh: albedo and normal maps that the page was given, and glTF files with theirs."""
from __future__ import annotations

import dataclasses
import io
from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..files import Mesh, load_mesh
from ..gltf import load_gltf
from .look import CUT, SKIN

SKIN_ALBEDO = 0.76, 0.54, 0.44  # of meshes that have none
LARGEST = 4096  # texels a side


@dataclasses.dataclass
class Paint:
    """Pictures drawn on a mesh by its texture coordinates. Row 0 of a picture is at v = 0."""

    albedo: list[NDArray[np.uint8]] = dataclasses.field(default_factory=list)  # (n, m, 3), sRGB
    layers: Optional[NDArray[np.int32]] = None  # per vertex: which picture of albedo; -1: none
    normal: Optional[NDArray[np.uint8]] = None  # (n, m, 3), of skin, as 0.5 + 0.5 n
    v_up: bool = True  # whether v grows upwards in the picture as its painter saw it

    def __bool__(self) -> bool:
        return bool(self.albedo) or self.normal is not None


def read(source: Any) -> NDArray[np.uint8]:
    """A picture of a file or of its bytes. Raises ValueError and OSError."""
    try:
        with Image.open(io.BytesIO(source) if isinstance(source, bytes) else source) as image:
            if max(image.size) > LARGEST:
                image.thumbnail((LARGEST, LARGEST))
            return np.asarray(image.convert("RGB"))
    except Image.DecompressionBombError as error:
        raise ValueError(str(error)) from None


def painted(paint: Paint, mesh: Mesh, kind: str, picture: NDArray[np.uint8]) -> tuple[Mesh, Paint]:
    """A copy with another picture on skin: `kind` is "albedo", which replaces the mesh's own, or "normal".
    Raises ValueError without texture coordinates."""
    if mesh.uvs is None:
        raise ValueError("this mesh has no texture coordinates; OBJ, PLY and glTF files can have some")
    made = dataclasses.replace(paint)
    picture = picture[::-1] if made.v_up else picture
    if kind == "normal":
        made.normal = picture
        return mesh, made
    skin = np.ones(len(mesh.positions), bool) if mesh.ids is None else mesh.ids == SKIN
    layers = np.full(len(skin), -1, np.int32) if made.layers is None else made.layers
    made.albedo = [picture, *made.albedo]
    made.layers = np.where(skin, 0, np.where(layers < 0, -1, layers + 1))
    own = np.float32(SKIN_ALBEDO) if mesh.albedo is None else mesh.albedo
    return dataclasses.replace(mesh, albedo=np.where(skin[:, None], np.float32(1), own)), made


def load(path: Any, subdivide: Optional[int], up: str) -> tuple[Mesh, Paint, str]:
    """A mesh, its pictures, and a text about its materials. Raises as load_mesh and load_gltf do."""
    if Path(path).suffix.lower() not in (".glb", ".gltf"):
        return load_mesh(path, subdivide, up), Paint(), ""
    scene = load_gltf(path)
    ids = scene.mesh.ids
    assert ids is not None
    soft = {id for id, kind in scene.taken_for.items() if kind in ("volume", "profile", "thin sheet")}
    told = f"scattering: {', '.join(scene.names[id] for id in sorted(soft))}"
    if not soft:
        soft = {id for id, kind in scene.taken_for.items() if kind == "plain"} or set(scene.names)
        told = ("no material scatters by itself; scattering is applied to "
                f"{', '.join(scene.names[id] for id in soft)}")
    albedo, layers = np.zeros((len(ids), 3), np.float32), np.full(len(ids), -1, np.int32)
    pictures = []
    for id, material in scene.materials.items():
        albedo[ids == id] = material.albedo
        if id in scene.textures and scene.mesh.uvs is not None:
            layers[ids == id] = len(pictures)
            pictures.append(read(scene.textures[id]))
    mesh = dataclasses.replace(scene.mesh, albedo=albedo, ids=np.where(
        np.isin(ids, sorted(soft)), SKIN, CUT).astype(np.uint32))
    return mesh, Paint(pictures, layers if pictures else None, v_up=False), told
