"""A deferred renderer in OpenGL 3.3 (moderngl on EGL; llvmpipe where there is no GPU).

One thread makes a Renderer and uses it: an OpenGL context belongs to its thread.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from .._show import linear
from ..conventions import light_from_view_projection
from ..files import Mesh
from . import shaders
from .camera import look_at, parallel, unit
from .paint import SKIN_ALBEDO, Paint
from .preview import levels


@dataclass
class GBuffer:
    """Images as Pellucid takes them, row 0 on top; float32, views of what OpenGL wrote."""

    position: NDArray[np.float32]          # (h, w, 3), world
    material: NDArray[np.float32]          # (h, w), id, 0 background
    normal_geometric: NDArray[np.float32]  # (h, w, 3)
    curvature: NDArray[np.float32]         # (h, w)
    normal_shading: NDArray[np.float32]    # (h, w, 3)
    albedo: NDArray[np.float32]            # (h, w, 3)
    u: NDArray[np.float32]                 # (h, w), texture coordinates
    v: NDArray[np.float32]


@dataclass
class _Level:
    """The mesh in OpenGL, with as many triangles as `spacing` says."""

    spacing: float  # length of an edge, about
    parts: list[Any]  # what draws it, what draws its shadow, and their buffers


@dataclass
class _Target:
    """Images of one size in OpenGL, and the memory that they are read into."""

    parts: list[Any]  # the framebuffer, and its attachments
    memory: list[NDArray[np.float32]]


def _release(made: _Level | _Target) -> None:
    for part in made.parts:
        part.release()


class Renderer:
    """Draws a mesh into the images of a G-buffer, and from its lights into shadow maps."""

    def __init__(self) -> None:
        try:
            self.context = moderngl.create_standalone_context(backend="egl", require=330)
        except Exception as error:  # moderngl raises bare Exceptions
            raise RuntimeError("OpenGL 3.3 through EGL is needed: install libegl1 and libgl1-mesa-dri "
                               f"(or a GPU's driver); {error}") from error
        self._gbuffer_program = self.context.program(shaders.GBUFFER_VERTEX, shaders.GBUFFER_FRAGMENT)
        self._shadow_program = self.context.program(shaders.SHADOW_VERTEX, shaders.SHADOW_FRAGMENT)
        self._targets: dict[tuple[int, int], _Target] = {}
        self._levels: list[_Level] = []
        self._shadow_targets: dict[int, Any] = {}  # by size
        self._pictures: list[Any] = []
        self.mesh: Mesh | None = None

    @property
    def name(self) -> str:
        return str(self.context.info["GL_RENDERER"])

    def set_mesh(self, mesh: Mesh, curvature: ArrayLike, millimetres_per_unit: float = 1.0,
                 albedo: ArrayLike = SKIN_ALBEDO, paint: Paint | None = None) -> None:
        """Takes a mesh and its curvature per vertex (1/length). `albedo`: of meshes that have none."""
        self.context.__enter__()
        paint = Paint() if paint is None else paint
        n = len(mesh.positions)
        vertices = np.zeros((n, 14), np.float32)
        vertices[:, 0:3] = mesh.positions
        vertices[:, 3:6] = mesh.normals
        vertices[:, 6:9] = np.asarray(albedo, np.float32) if mesh.albedo is None else mesh.albedo
        vertices[:, 9] = 1 if mesh.ids is None else mesh.ids
        vertices[:, 10] = curvature
        if mesh.uvs is not None:
            vertices[:, 11:13] = mesh.uvs
        vertices[:, 13] = -1 if paint.layers is None else paint.layers
        fresh = [self._upload(*level)
                 for level in levels(vertices, np.ascontiguousarray(mesh.triangles, np.uint32))]
        for old in self._levels:
            _release(old)
        self._levels = fresh
        self._set_pictures(paint)
        self.mesh = mesh
        used = mesh.positions[np.unique(mesh.triangles)]
        low, high = used.min(0).astype(float), used.max(0).astype(float)
        self.centre, self.radius = (low + high) / 2, max(float(np.linalg.norm(high - low)) / 2, 1e-6)
        self._mm = millimetres_per_unit

    def _set_pictures(self, paint: Paint) -> None:
        for old in self._pictures:
            old.release()
        size = tuple(max((p.shape[i] for p in paint.albedo), default=1) for i in (1, 0))  # width, height
        layers = [np.asarray(Image.fromarray(p).resize(size)) for p in paint.albedo] or [
            np.full((1, 1, 3), 255, np.uint8)]
        light = linear(np.arange(256) / 255).astype(np.float16)[np.stack(layers)]
        pictures = self.context.texture_array((*size, len(layers)), 3, light.tobytes(), alignment=1,
                                              dtype="f2")
        normal = np.full((1, 1, 3), 128, np.uint8) if paint.normal is None else paint.normal
        bumps = self.context.texture(normal.shape[1::-1], 3, np.ascontiguousarray(normal).tobytes(),
                                     alignment=1)
        self._pictures = [pictures, bumps]
        for made in self._pictures:
            made.build_mipmaps()
            made.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        self._bumps_up = 0.0 if paint.normal is None else 1.0 if paint.v_up else -1.0

    def _upload(self, spacing: float, vertices: NDArray[np.float32], triangles: NDArray[np.uint32]) -> _Level:
        buffer, indices = self.context.buffer(vertices.tobytes()), self.context.buffer(triangles.tobytes())
        draw = self.context.vertex_array(self._gbuffer_program,
            [(buffer, "3f 3f 3f 2f 3f", "in_position", "in_normal", "in_albedo", "in_material", "in_uv")],
            indices)
        shadow = self.context.vertex_array(self._shadow_program, [(buffer, "3f 44x", "in_position")], indices)
        return _Level(spacing, [draw, shadow, buffer, indices])

    def level(self, length: float) -> int:
        """The coarsest version of the mesh with edges of at most about `length`: 0 is the mesh itself."""
        return max((i for i, level in enumerate(self._levels) if level.spacing <= length), default=0)

    def _target(self, width: int, height: int) -> _Target:
        target = self._targets.pop((width, height), None)
        if target is None:
            while len(self._targets) >= 3:  # a moving picture, one at rest, one that is exported
                _release(self._targets.pop(next(iter(self._targets))))
            parts = [self.context.texture((width, height), 4, dtype="f4") for _ in range(4)]
            depth = self.context.depth_renderbuffer((width, height))
            target = _Target([self.context.framebuffer(parts, depth), *parts, depth],
                             [np.empty((height, width, 4), np.float32) for _ in range(4)])
        self._targets[width, height] = target
        return target

    def gbuffer(self, view_projection: ArrayLike, width: int, height: int, pores: float = 0.1, level: int = 0,
                shift: tuple[float, float] = (0.0, 0.0)) -> GBuffer:
        """Draws the mesh. The images stay as they are until the next call of the same size, and change then.

        level : int
            Which version of the mesh, see `level`.
        shift : pair of floats
            Pixels that the picture is moved by, to the right and down.
        """
        assert self.mesh is not None
        self.context.__enter__()  # another renderer of this thread may have been the last
        target = self._target(width, height)
        frame = target.parts[0]
        frame.use()
        frame.clear(0.0, 0.0, 0.0, 0.0)
        self.context.enable_only(moderngl.DEPTH_TEST)
        program = self._gbuffer_program
        turned = np.diag([1.0, -1.0, 1.0, 1.0])
        turned[:2, 3] = 2 * shift[0] / width, 2 * shift[1] / height
        program["clip"].write((turned @ np.asarray(view_projection, np.float64)).T.astype("f4").tobytes())
        program["pores"].value, program["mm"].value = pores, self._mm
        for unit_, name in enumerate(("pictures", "bumps")):
            self._pictures[unit_].use(unit_)
            program[name].value = unit_
        program["bumps_up"].value = self._bumps_up
        program["eyes"].value = bool(self.mesh.eyes)
        if self.mesh.eyes:
            program["sclera"].value = tuple(self.mesh.eyes[0]["sclera"])
        self._levels[level].parts[0].render()
        for attachment, memory in enumerate(target.memory):
            frame.read_into(memory, components=4, attachment=attachment, dtype="f4")
        position, geometric, shading, albedo = target.memory
        return GBuffer(position[..., :3], position[..., 3], geometric[..., :3], geometric[..., 3],
                       shading[..., :3], albedo[..., :3], shading[..., 3], albedo[..., 3])

    def shadow_map(self, to_light: ArrayLike, size: int, up: ArrayLike = (0.0, 1.0, 0.0),
                   level: int = 0) -> tuple[NDArray[np.float32], Any]:
        """Depth from a distant light, (size, size), of the whole mesh, and the Light that describes it."""
        assert self.mesh is not None
        self.context.__enter__()
        direction, r = unit(to_light), 1.02 * self.radius
        matrix = parallel(r, 0.0, 2 * r) @ look_at(self.centre + direction * r, self.centre, up)
        if size not in self._shadow_targets:
            texture = self.context.texture((size, size), 1, dtype="f4")
            self._shadow_targets[size] = self.context.framebuffer(
                [texture], self.context.depth_renderbuffer((size, size)))
        frame = self._shadow_targets[size]
        frame.use()
        frame.clear(1.0, 1.0, 1.0, 1.0)
        self.context.enable_only(moderngl.DEPTH_TEST)
        self._shadow_program["clip"].write(matrix.T.astype("f4").tobytes())
        self._levels[level].parts[1].render()
        depth = np.empty((size, size), np.float32)
        frame.read_into(depth, components=1, dtype="f4")
        return depth, light_from_view_projection(matrix, first_row="bottom")
