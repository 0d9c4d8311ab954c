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
from .preview import coarser

FAR = np.float32(1e9)


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


def depth(g: GBuffer, view_projection: NDArray[np.float64]) -> NDArray[np.float32]:
    """From the eye, (h, w); FAR on background."""
    x, y, z, one = view_projection[3].astype(np.float32)
    p = g.position
    return np.where(g.material > 0, x * p[..., 0] + y * p[..., 1] + z * p[..., 2] + one, FAR)


def _pixel(view_projection: NDArray[np.float64], height: int) -> float:
    """Height of a pixel at depth 1."""
    # The second row of a projection is the view's upward direction times the cotangent of half the angle.
    return float(2 / (np.linalg.norm(view_projection[1, :3]) * height))


def _flipped(view_projection: ArrayLike, right: float = 0.0, down: float = 0.0) -> bytes:
    """For OpenGL, with the first row on top, shifted by fractions of half the picture."""
    turned = np.diag([1.0, -1.0, 1.0, 1.0])
    turned[:2, 3] = right, down
    return (turned @ np.asarray(view_projection, np.float64)).T.astype("f4").tobytes()


def _box(seen: NDArray[np.bool_], size: tuple[int, int]) -> tuple[int, ...]:
    """Left, top, width, height in a picture of `size` of the part `seen` in a small one, with a margin."""
    box = [0, 0, 0, 0]
    for i, n in enumerate(size):
        places, margin = np.flatnonzero(seen.any(i)) * n // seen.shape[1 - i], n // 20
        if len(places):
            box[i] = max(places[0].item() - margin, 0)
            box[2 + i] = min(places[-1].item() + margin, n) - box[i]
    return tuple(box)


def _release(parts: list[Any]) -> None:
    for part in parts:
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
        detailed = shaders.ENLARGE_FRAGMENT.replace("core\n", "core\n#define DETAILED\n")
        self._enlarge_programs = [self.context.program(shaders.ENLARGE_VERTEX, fragment)
                                  for fragment in (shaders.ENLARGE_FRAGMENT, detailed)]
        self._reuse_program = self.context.program(shaders.WHOLE_VERTEX, shaders.REUSE_FRAGMENT)
        self._reuse = self.context.vertex_array(self._reuse_program, [])
        # of the last enlarged picture: two framebuffers, the second with weights too, and their attachments
        self._screen: list[Any] = []
        self._view: tuple[Any, ...] = ()  # what its weights depend on, and whether they were kept
        self._details: list[Any] = []  # what the picture at rest shows beyond a small one, and its depth
        # by size: the framebuffer and its attachments, and the memory that they are read into
        self._targets: dict[tuple[int, int], tuple[list[Any], list[NDArray[np.float32]]]] = {}
        self._levels: list[list[Any]] = []  # of the mesh, and of one with fewer triangles
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
        triangles = np.ascontiguousarray(mesh.triangles, np.uint32)
        self.coarse_edge, coarse = coarser(vertices, triangles)
        buffer = self.context.buffer(vertices.tobytes())
        fresh = [self._upload(buffer, indices) for indices in (triangles, coarse)]
        for old in self._levels:
            _release(old)
        self._levels = fresh
        self._levels[0].append(buffer)  # to be released with it
        self._set_pictures(paint)
        self.mesh = mesh
        used = mesh.positions[np.unique(mesh.triangles)]
        low, high = used.min(0).astype(float), used.max(0).astype(float)
        self.centre, self.radius = (low + high) / 2, max(float(np.linalg.norm(high - low)) / 2, 1e-6)
        self._mm = millimetres_per_unit
        # Whether no light reaches a back side, seen from six sides: half of the triangles need not be drawn.
        pairs = ([self._depth_from(side, 128, (0, 1, 0), 1, cull)[0] for cull in (False, True)]
                 for side in np.concatenate([np.eye(3), -np.eye(3)]))
        self._closed = all((one != two).mean() < 1e-3 for one, two in pairs)

    def _set_pictures(self, paint: Paint) -> None:
        _release(self._pictures)
        self._view = ()
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

    def _upload(self, buffer: Any, triangles: NDArray[np.uint32]) -> list[Any]:
        """Vertex arrays for a G-buffer, a shadow map, a picture without and with details; their indices."""
        indices = self.context.buffer(triangles.tobytes())
        draw = self.context.vertex_array(self._gbuffer_program,
            [(buffer, "3f 3f 3f 2f 3f", "in_position", "in_normal", "in_albedo", "in_material", "in_uv")],
            indices)
        others = [self.context.vertex_array(program, [(buffer, "3f 44x", "in_position")], indices)
                  for program in (self._shadow_program, *self._enlarge_programs)]
        return [draw, *others, indices]

    def _target(self, width: int, height: int) -> tuple[list[Any], list[NDArray[np.float32]]]:
        target = self._targets.pop((width, height), None)
        if target is None:
            while len(self._targets) >= 3:  # a moving picture, one at rest, one that is exported
                _release(self._targets.pop(next(iter(self._targets)))[0])
            parts = [self.context.texture((width, height), 4, dtype="f4") for _ in range(4)]
            depth = self.context.depth_renderbuffer((width, height))
            target = ([self.context.framebuffer(parts, depth), *parts, depth],
                      [np.empty((height, width, 4), np.float32) for _ in range(4)])
        self._targets[width, height] = target
        return target

    def gbuffer(self, view_projection: ArrayLike, width: int, height: int, pores: float = 0.1, level: int = 0,
                shift: tuple[float, float] = (0.0, 0.0)) -> GBuffer:
        """Draws the mesh. The images stay as they are until the next call of the same size, and change then.

        level : int
            Which version of the mesh: 0, or 1 for the coarse one.
        shift : pair of floats
            Pixels that the picture is moved by, to the right and down.
        """
        assert self.mesh is not None
        self.context.__enter__()  # another renderer of this thread may have been the last
        (frame, *_), images = self._target(width, height)
        frame.use()
        frame.clear(0.0, 0.0, 0.0, 0.0)
        self.context.enable_only(moderngl.DEPTH_TEST)
        program = self._gbuffer_program
        program["clip"].write(_flipped(view_projection, 2 * shift[0] / width, 2 * shift[1] / height))
        program["pores"].value, program["mm"].value = pores, self._mm
        for unit_, name in enumerate(("pictures", "bumps")):
            self._pictures[unit_].use(unit_)
            program[name].value = unit_
        program["bumps_up"].value = self._bumps_up
        program["eyes"].value = bool(self.mesh.eyes)
        if self.mesh.eyes:
            program["sclera"].value = tuple(self.mesh.eyes[0]["sclera"])
        self._levels[level][0].render()
        for attachment, memory in enumerate(images):
            frame.read_into(memory, components=4, attachment=attachment, dtype="f4")
        position, geometric, shading, albedo = images
        return GBuffer(position[..., :3], position[..., 3], geometric[..., :3], geometric[..., 3],
                       shading[..., :3], albedo[..., :3], shading[..., 3], albedo[..., 3])

    def enlarged(self, view_projection: ArrayLike, pixels: NDArray[np.uint8], away: NDArray[np.float32],
                 small: NDArray[np.float64], size: tuple[int, int], level: int,
                 rest: ArrayLike | None = None, inside: bool = True) -> NDArray[np.uint8]:
        """The mesh in the colours of a small picture, (height, width, 3).

        `away`, `small`: depth, and view and projection, of the small picture. `rest`: view and projection of
        the picture whose details were kept; None: none are added. `inside`: whether back sides are seen.
        """
        self.context.__enter__()
        farthest = away.argmax()  # background, if there is any
        clear = (*(pixels.reshape(-1, 3)[farthest] / 255 if away.flat[farthest] == FAR else (0, 0, 0)), 0.0)
        if not self._screen or self._screen[0].size != size:
            _release(self._screen)
            parts = [self.context.renderbuffer(size, 3), self.context.depth_renderbuffer(size)]
            kept = [self.context.texture(size, 4, dtype="f2") for _ in range(2)]
            both = self.context.framebuffer([parts[0], *kept], parts[1])
            self._screen = [self.context.framebuffer(*parts), both, *kept, *parts]
            self._view = ()
        view = (np.asarray(view_projection).tobytes(), None if rest is None else np.asarray(rest).tobytes(),
                level, inside)
        # The second picture of a view keeps its weights for those after it. A new G-buffer has a new `away`.
        again = view[0] == small.tobytes() and self._view[:4] == view and self._view[4] is away
        reused = again and self._view[5]
        self._view = (*view, away, again)
        frame = self._screen[again and not reused]
        frame.use()
        frame.clear(*clear)
        own = [self._texture(pixels), self._texture(away)]
        program = self._reuse_program if reused else self._enlarge_programs[rest is not None]
        program["scale"].value = tuple(np.divide(away.shape[::-1], size)) if again else (0, 0)
        if reused:
            self._use(program, ("shaded", "weights", "more"), own[:1] + self._screen[2:4])
            self.context.enable_only(moderngl.NOTHING)
            frame.scissor = _box(away < FAR, size)
            frame.use()
            self._reuse.render(vertices=3)
            frame.scissor = None
        else:
            program["clip"].write(_flipped(view_projection))
            program["small"].write(_flipped(small))
            program["angle"].value = _pixel(small, len(away))
            if rest is not None:
                program["rest"].write(_flipped(rest))
            self._use(program, ("shaded", "depths", "details", "rest_depths"),
                      own + (self._details if rest is not None else []))
            # First the front sides, which hide the rest (y is flipped). A coarse mesh has a few flipped
            # triangles; their holes are closed if the picture is used for longer.
            self.context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
            for self.context.cull_face in ("front", "back") if inside or again else ("front",):
                self._levels[level][2 if rest is None else 3].render()
        made = np.empty((size[1], size[0], 3), np.uint8)
        frame.read_into(made, components=3, alignment=1)
        _release(own)
        return made

    @staticmethod
    def _use(program: Any, names: tuple[str, ...], textures: list[Any]) -> None:
        for unit_, (name, texture) in enumerate(zip(names, textures)):
            texture.use(unit_)
            program[name].value = unit_

    def keep_details(self, pixels: NDArray[np.uint8], g: GBuffer, view_projection: NDArray[np.float64],
                     rough: NDArray[np.uint8], eyes: list[int]) -> None:
        """Keeps the details of a picture at rest beyond a rough one of this view; all of the ids `eyes`."""
        whole = np.isin(g.material, eyes)[..., None]
        more = np.clip(pixels.astype(np.int16) - rough, -32, 32)  # more is a hole in the rough picture
        more = 128 + np.where(whole, pixels, more) // 2
        # Not at outlines, and not where the surface is seen from the side.
        z, kept = depth(g, view_projection), np.zeros_like(g.material)
        middle, across, down = z[2:-2, 2:-2], z[2:-2, 4:] - z[2:-2, :-4], z[4:, 2:-2] - z[:-4, 2:-2]
        steep = np.maximum(np.abs(across), np.abs(down)) > 12 * _pixel(view_projection, len(z)) * middle
        kept[2:-2, 2:-2] = np.where(steep, 0, middle)
        _release(self._details)
        self._view = ()
        more = np.concatenate([more, 255 * whole], 2).astype(np.uint8)
        self._details = [self._texture(more), self._texture(kept)]
        self._details[0].filter = moderngl.LINEAR, moderngl.LINEAR

    def _texture(self, image: NDArray[Any]) -> Any:
        made = self.context.texture(image.shape[1::-1], image.shape[2] if image.ndim == 3 else 1,
                                    np.ascontiguousarray(image).tobytes(), alignment=1,
                                    dtype="f1" if image.dtype == np.uint8 else "f4")
        made.filter, made.repeat_x, made.repeat_y = (moderngl.NEAREST, moderngl.NEAREST), False, False
        return made

    def shadow_map(self, to_light: ArrayLike, size: int, up: ArrayLike = (0.0, 1.0, 0.0),
                   level: int = 0) -> tuple[NDArray[np.float32], Any]:
        """Depth from a distant light, (size, size), of the whole mesh, and the Light that describes it."""
        depth, matrix = self._depth_from(unit(to_light), size, up, level, level > 0 and self._closed)
        return depth, light_from_view_projection(matrix, first_row="bottom")

    def _depth_from(self, direction: NDArray[np.float64], size: int, up: ArrayLike, level: int,
                    cull: bool) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        self.context.__enter__()
        r = 1.02 * self.radius
        matrix = parallel(r, 0.0, 2 * r) @ look_at(self.centre + direction * r, self.centre, up)
        if size not in self._shadow_targets:
            texture = self.context.texture((size, size), 1, dtype="f4")
            self._shadow_targets[size] = self.context.framebuffer(
                [texture], self.context.depth_renderbuffer((size, size)))
        frame = self._shadow_targets[size]
        frame.use()
        frame.clear(1.0, 1.0, 1.0, 1.0)
        self.context.enable_only(moderngl.DEPTH_TEST | (moderngl.CULL_FACE if cull else moderngl.NOTHING))
        self.context.cull_face = "back"
        self._shadow_program["clip"].write(matrix.T.astype("f4").tobytes())
        self._levels[level][1].render()
        depth = np.empty((size, size), np.float32)
        frame.read_into(depth, components=1, dtype="f4")
        return depth, matrix
