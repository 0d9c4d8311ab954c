"""Mesh, look and camera in, picture out: for the page, and for programs without a page."""
from __future__ import annotations

import contextlib
import copy
import time
from concurrent.futures import Future, wait
from dataclasses import dataclass, field, fields
from typing import Any, Callable, Iterator, Optional, TypeVar

import numpy as np
from numpy.typing import NDArray

from .. import files
from .._types import Eye, Light, Material, MaterialValues, Skin
from ..device import Device
from ..mesh import MeshTopology
from ..profile import Profile
from ..skin import skin_info
from . import surroundings
from .camera import Orbit, direction
from .look import CUT, EYES, PIGMENTS, RIGHT_EYE, SKIN, TEETH, TONGUE, Lamp, Look, skin_triangles
from .paint import SKIN_ALBEDO, Paint, load, painted, read
from .passes import BESIDE, PATIENCE, Pass
from .pictures import LINEAR, picture, scattered_tiles, srgb_bytes
from .reference import Reference
from .renderer import GBuffer, Renderer, depth
from .texture import Texture

T = TypeVar("T")


@dataclass
class Frame:
    """One picture, and what it took."""

    pixels: NDArray[np.uint8]                                   # (h, w, 3), sRGB
    milliseconds: dict[str, float] = field(default_factory=dict)  # per stage
    counts: dict[str, Any] = field(default_factory=dict)        # of the shader
    warnings: list[str] = field(default_factory=list)
    kernels: int = 0                                            # programs that the device has compiled
    compiled: int = 0                                           # of them, for this picture
    stands_in: bool = False  # without scattering, for its kernels are being built


@dataclass
class ShadowMap:
    depth: NDArray[np.float32]  # (size, size)
    light: Light


@dataclass
class Shaded:
    """Pictures, left and right, from which those of the next views are made while the camera moves."""

    key: Any  # what they depend on, but the camera
    made: list[tuple[NDArray[np.uint8], Pass]]
    depth: NDArray[np.float32]
    matrix: NDArray[np.float64]  # of the camera
    inside: bool  # whether back sides are seen
    left: int = 2  # number of further views


# (specular, roughness) of what is not skin, as in the demo.
# Eyes: that of their film of tears.
_GLOSS = {EYES: (0.0, 1.0), RIGHT_EYE: (0.0, 1.0), TEETH: (0.05, 0.2), TONGUE: (0.05, 0.2), CUT: (0.0, 1.0)}
COSTLY = "reference", "error", "tiles"  # modes with slow pictures
SAMPLES = 8  # pictures that are averaged for smooth edges
UNITS = {1.0: "millimetres", 10.0: "centimetres", 25.4: "inches", 1000.0: "metres"}
PLAUSIBLE = 30.0, 3000.0  # mm: size of an object on which scattering in skin shows


def eyes_of(mesh: files.Mesh, look: Optional[Look] = None, mm: float = 1.0) -> dict[int, Eye]:
    """The eyes of a head of the package by material id: an adult's eyes, scaled to its balls, with the
    settings of the look. `mm`: millimetres per unit."""
    look = Look() if look is None else look
    found = {}
    for id, ball in zip((EYES, RIGHT_EYE), mesh.eyes):
        same = ("limbus_width", "limbus_darkening", "cornea_radius", "chamber_depth", "iris_concavity",
                "iris_color", "iris_seed", "tear_roughness")
        eye = Eye(center=ball["centre"], gaze=direction(mesh.up, ball["gaze"], *look.gaze), up=mesh.up,
                  pupil_radius=look.pupil, **{name: getattr(look, name) for name in same})
        # The iris lies below the cornea's rim, however steep that is.
        r2, cornea = eye.limbus_radius**2, eye.cornea_radius
        rim = r2 / (cornea + np.sqrt(max(cornea**2 - (1 + eye.cornea_conic) * r2, 0)))
        eye.chamber_depth = max(eye.chamber_depth, rim + 0.05)
        scale = ball["radius"] * mm / eye.sclera_radius
        for length in ("sclera_radius", "cornea_radius", "limbus_radius", "limbus_width", "chamber_depth",
                       "pupil_radius", "iris_concavity"):
            setattr(eye, length, scale * getattr(eye, length))
        found[id] = eye
    return found


def iris_image(path: Any) -> NDArray[np.float32]:
    """The middle square of an image as linear albedo, (n, n, 3): its inscribed circle is the iris' rim.

    Raises
    ------
    FileError
        A file that is missing or damaged.
    ValueError
        An image without colours.
    """
    image = surroundings.read_linear(path, "an iris")
    n = min(image.shape[:2])
    top, left = (image.shape[0] - n) // 2, (image.shape[1] - n) // 2
    return np.ascontiguousarray(image[top:top + n, left:left + n], np.float32)


# The first elements of a sequence that fills a square evenly, by which pictures are shifted [Halton 1964].
_HALTON = list(zip((1 / 2, 1 / 4, 3 / 4, 1 / 8, 5 / 8, 3 / 8, 7 / 8),
                   (1 / 3, 2 / 3, 1 / 9, 4 / 9, 7 / 9, 2 / 9, 5 / 9)))


def _kept(cache: dict[Any, T], key: Any, most: int, make: Callable[[], T]) -> T:
    """The value of a key, made once; the oldest values are dropped."""
    if key not in cache:
        made = make()
        while len(cache) >= most:
            cache.pop(next(iter(cache)))
        cache[key] = made
    return cache[key]


def pigments(look: Look) -> Skin:
    return Skin(**{name: getattr(look, name) for name in PIGMENTS})


class Session:
    """Owns the renderer and the device. One thread makes it and uses it."""

    def __init__(self, device: Optional[Device] = None, millimetres_per_unit: float = 1.0) -> None:
        self.device = Device() if device is None else device
        self.renderer = Renderer()
        self.mm = millimetres_per_unit
        self.told = ""  # of the materials of a file
        self.read: dict[str, Any] = {}  # how the mesh was read from its file: load's further arguments
        self.orbit = Orbit()
        self.look = Look()
        self.other: Optional[Look] = None  # the look on the right of the dividing line
        self.against = ""  # a method: the right side is the left one with it, in place of `other`
        self.wipe = 0.5
        self.beside = False  # two whole pictures, in place of the wipe
        self.count = False  # fill every counter of the shader, at some cost
        self._passes: dict[str, Pass] = {}
        self._maps: dict[Any, ShadowMap] = {}
        self._profiles: dict[Any, Profile] = {}
        # by size: the state they were drawn in
        self._gbuffers: dict[tuple[int, int], tuple[Any, GBuffer]] = {}
        self._irises: dict[str, NDArray[np.float32]] = {}  # by file
        self._surroundings: dict[str, NDArray[np.float32]] = {}  # by file
        self._textures: dict[bool, Texture] = {}  # by whether something moves
        self._sum: Optional[tuple[int, NDArray[np.float32]]] = None  # of pictures shifted by parts of a pixel
        self.references: dict[str, Reference] = {}  # by pass
        # called as references advance; None: pictures wait for them, and for kernels
        self.report: Optional[Callable[[], None]] = None
        self._complete = False
        self.sketched = True  # until kernels have made a picture
        self._curvature: Optional[Future[Any]] = None  # of the mesh, while it is measured
        self._shift = (0.0, 0.0)
        self._view: Any = None  # `camera` of the frame that is being made: the page may move it meanwhile
        self._prepared: Any = None
        self.shown: Optional[GBuffer] = None  # of the last picture, and the pass that shaded its left side
        self.last_pass: Optional[Pass] = None
        self._rest: Any = None  # the last picture at rest, and its projection
        self._detailed: Any = None  # look and projection of the picture whose details the renderer keeps
        self._shaded: Optional[Shaded] = None
        self._away: Any = None  # the G-buffer of moving pictures, its depth, and whether back sides are seen
        self._scattered: Any = None  # the state that `scattering_at` was asked for, and its tiles

    def load(self, path: Any, subdivide: Optional[int] = None, up: str = "auto") -> files.Mesh:
        """Shows another mesh. Raises what files.load_mesh and MeshTopology raise; the mesh before it then
        stays."""
        mesh, paint, told = load(path, subdivide, up)
        self.show(mesh, paint)
        self.told, self.read = told, {"subdivide": subdivide, "up": up}
        return mesh

    def paint_skin(self, kind: str, path: Any) -> None:
        """Draws a picture on skin: "albedo" or "normal". Raises ValueError and OSError."""
        self._draw(*painted(self.paint, self.mesh, kind, read(path)))

    def show_bare(self) -> None:
        """Takes all pictures off the mesh."""
        self._draw(self._bare, Paint())

    def show(self, mesh: files.Mesh, paint: Optional[Paint] = None) -> files.Mesh:
        """The same with a mesh in memory."""
        self._draw(mesh, Paint() if paint is None else paint)
        self._bare = mesh
        self.orbit.frame(mesh.low, mesh.high, 16 / 9)
        return mesh

    def _draw(self, mesh: files.Mesh, paint: Paint) -> None:
        if len(mesh.triangles) == 0:
            raise ValueError(f"{mesh.source or 'the mesh'} has no triangles")
        topology = MeshTopology(self.device, mesh.triangles, len(mesh.positions), weld="exact",
                                positions=mesh.positions)
        curvature = BESIDE.submit(topology.curvature, mesh.positions, mesh.normals, smoothing_passes=2)
        # The first picture does without curvature if kernels have to be built for it.
        known = not self.sketched or wait([curvature], PATIENCE).done
        self.renderer.set_mesh(mesh, curvature.result() if known else 0.0, self.mm, paint=paint)
        self._curvature = None if known else curvature
        self.mesh, self.paint = mesh, paint
        self.centre = (np.asarray(mesh.low, float) + mesh.high) / 2
        self._forget()
        for name in list(self.references):
            self.cancel_reference(name)

    def _forget(self) -> None:
        """Drops everything that was derived from the previous mesh."""
        for made in (self._maps, self._gbuffers, self._textures):
            made.clear()
        self._rest = self._detailed = self._shaded = self._scattered = None

    def _take_curvature(self) -> None:
        if self._curvature is not None and (self._curvature.done() or not self.background):
            measured, self._curvature = self._curvature.result(), None
            self.renderer.set_mesh(self.mesh, measured, self.mm, paint=self.paint)
            self._forget()

    @property
    def measuring(self) -> bool:
        """Whether the curvature of the mesh is not known yet."""
        return self._curvature is not None

    @property
    def background(self) -> bool:
        """Whether kernels are built while pictures without scattering stand in."""
        return self.report is not None and not self._complete

    @contextlib.contextmanager
    def complete(self) -> Iterator[None]:
        """Within it, pictures wait for their kernels."""
        before, self._complete = self._complete, True
        try:
            yield
        finally:
            self._complete = before

    def still(self) -> Session:
        """The same, which the page does not change meanwhile, and whose pictures are whole at once: for
        files."""
        held = copy.copy(self)
        held.report, held.references = None, {}
        held.look, held.other, held.orbit = copy.deepcopy((self.look, self.other, self.orbit))
        return held

    def size(self) -> float:
        """Largest extent of the mesh, mm."""
        return float(np.max(np.subtract(self.mesh.high, self.mesh.low))) * self.mm

    def size_text(self) -> str:
        return f"The mesh is {self.size():.3g} mm across."

    def better_unit(self) -> Optional[float]:
        """Millimetres per unit with which the mesh is nearest to a head's size; None where its size is
        plausible."""
        if PLAUSIBLE[0] <= self.size() <= PLAUSIBLE[1]:
            return None
        bare = self.size() / self.mm
        best = min(UNITS, key=lambda mm: abs(np.log(max(bare, 1e-30) * mm / 250)))
        return best if best != self.mm else None

    def set_unit(self, mm: float) -> None:
        """Takes the lengths of the mesh in units of `mm` millimetres; the camera stays."""
        self.mm = mm
        self._draw(self.mesh, self.paint)

    def cancel_reference(self, name: str) -> None:
        made = self.references.pop(name, None)
        if made is not None:
            made.cancel()

    @property
    def work(self) -> str:
        """The state of background work, for the page."""
        running = [made.fraction for made in self.references.values() if made.fraction < 1]
        return f"reference: {100 * min(running):.0f} % (another picture cancels it)" if running else ""

    def restarted(self, device: Device) -> Session:
        """The same mesh, look and camera on another device, and in an OpenGL context of its own."""
        for name in list(self.references):
            self.cancel_reference(name)
        fresh = Session(device, self.mm)
        for name in ("look", "other", "against", "wipe", "beside", "count"):
            setattr(fresh, name, getattr(self, name))
        fresh.report = self.report
        fresh._draw(self.mesh, self.paint)
        fresh._bare, fresh.told, fresh.read = self._bare, self.told, self.read
        fresh.orbit = self.orbit
        return fresh

    def to_light(self, lamp: Lamp) -> NDArray[np.float64]:
        return direction(self.mesh.up, self.mesh.front, lamp.azimuth, lamp.elevation)

    def shadow_map(self, lamp: Lamp, size: int, small: bool = False) -> ShadowMap:
        """The map of a lamp; made once, until the lamp moves. `small`: of a coarser mesh, to go with such a
        picture."""
        level = self._coarse() if small else 0
        key = (lamp.azimuth, lamp.elevation, size, level)
        return _kept(self._maps, key, 9, lambda: ShadowMap(
            *self.renderer.shadow_map(self.to_light(lamp), size, self.mesh.up, level)))

    def _coarse(self) -> int:
        """The version of the mesh whose edges are few pixels long while something moves: 1, coarse, or 0."""
        view = self.orbit.distance * np.tan(np.radians(self.orbit.fov) / 2)
        return int(self.renderer.coarse_edge <= 20 / 270 * view)

    def _level(self, small: bool) -> int:
        """The version for a G-buffer. A texture has seams that a coarser mesh would tear apart."""
        return 0 if not small or self.look.method == "texture" or self.paint else self._coarse()

    def profile(self, look: Look) -> Profile:
        if look.profile == "pigments":
            return _kept(self._profiles, tuple(getattr(look, name) for name in PIGMENTS), 33,
                         lambda: Profile.skin_layers(pigments(look), name="pigments"))
        if look.profile == "custom":
            return _kept(self._profiles, look.distance, 33,
                         lambda: Profile.burley_distance(look.distance, "custom"))
        return _kept(self._profiles, look.profile, 33, lambda: Profile.named(look.profile))

    def take_pigments(self, look: Look) -> None:
        """Gives the look the profile and, on this mesh, the albedo of its pigments."""
        info, own = skin_info(pigments(look)), np.asarray(SKIN_ALBEDO)
        if self.mesh.albedo is not None:
            own = self.mesh.albedo[np.unique(skin_triangles(self.mesh))].mean(0)
        if self.paint.albedo:
            own = own * LINEAR[self.paint.albedo[0]].reshape(-1, 3).mean(0)
        red, green, blue = np.clip(info.albedo / np.maximum(own, 1e-3), 0, 2).round(3).tolist()
        look.profile, look.albedo = "pigments", (red, green, blue)

    def camera(self, aspect: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Eye, and world to clip space in OpenGL's convention."""
        if self._view is not None:
            return self._view
        apart = float(np.linalg.norm(self.renderer.centre - self.centre))
        return self.orbit.matrices(self.mesh.up, self.mesh.front, self.centre, self.renderer.radius + apart,
                                   aspect)

    def gbuffer(self, width: int, height: int, small: bool = False) -> GBuffer:
        if not self.background:
            self._take_curvature()
        state = self.drawn_state(width, height, small)
        made = self._gbuffers.get((width, height))
        if made is None or made[0] != state:
            _, matrix = self.camera(width / height)
            while len(self._gbuffers) > 2:
                self._gbuffers.pop(next(iter(self._gbuffers)))
            made = (state, self.renderer.gbuffer(matrix, width, height, state[3], state[4], self._shift))
            self._gbuffers[width, height] = made
        return made[1]

    def drawn_state(self, width: int, height: int, small: bool = False) -> tuple[Any, ...]:
        """The settings that a G-buffer depends on."""
        _, matrix = self.camera(width / height)
        # The reference has the mesh's own normals.
        pores = 0.0 if self.look.mode in ("error", "reference") else self.look.pores
        return (matrix.tobytes(), width, height, pores, self._level(small), self._shift)

    def materials(self, look: Look) -> dict[int, Material]:
        """The materials of the mesh by id."""
        skin = Material(scattering=look.method, specular_model="ggx" if look.ggx else "ksk")
        for value in fields(MaterialValues):
            setattr(skin, value.name, getattr(look, value.name))
        sharp = 1.0 / self.mm  # of shadows where nothing scatters: 1 mm
        if look.method == "none" and look.transmission == 0:
            skin.shadow_filter_width = sharp
        else:
            skin.profile = self.profile(look)
            skin.deep_scatter_color = look.deep_scatter
            if look.radius_scale != 1:
                skin.diffusion_radius = skin.profile.info.radius * look.radius_scale / self.mm
        made = {SKIN: skin}
        for id, (amount, roughness) in _GLOSS.items():
            made[id] = Material(scattering="none", thickness_taps=0, specular=amount, roughness=roughness,
                                shadow_filter_width=sharp)
        present = {1} if self.mesh.ids is None else set(np.unique(self.mesh.ids).tolist())
        return {id: m for id, m in made.items() if id in present}

    def eyes(self, look: Look) -> dict[int, Eye]:
        """The eyes of the mesh, by material id."""
        eyes = eyes_of(self.mesh, look, self.mm)
        for eye in eyes.values():
            eye.iris_profile = Profile.named(look.iris_profile) if look.iris_profile else None
        return eyes

    def iris(self, look: Look) -> Optional[NDArray[np.float32]]:
        """The texture of the irises, (n, n, 3), linear; None: fibres are drawn. Raises what files.read_image
        raises, and ValueError."""
        if not look.iris_texture:
            return None
        return _kept(self._irises, look.iris_texture, 1, lambda: iris_image(look.iris_texture))

    def lights(self, look: Look, small: bool = False) -> list[tuple[Light, Optional[ShadowMap]]]:
        found: list[tuple[Light, Optional[ShadowMap]]] = []
        for lamp in look.lamps:
            if not lamp.on or lamp.intensity <= 0:
                continue
            map = self.shadow_map(lamp, look.shadow_size // (3 if small else 1),
                                  small) if lamp.shadow else None
            light = map.light.copy() if map else Light(to_light=self.to_light(lamp))
            light.color = np.multiply(lamp.color, lamp.intensity)
            if map:
                light.shadow_filter_texels = 48
            found.append((light, map))
        return found

    @staticmethod
    def ambient(look: Look) -> float:
        """Irradiance / pi from everywhere. For 0 it is a value too small to see, because a frame without
        ambient light needs other kernels."""
        return max(look.ambient, 1e-6)

    def surroundings(self, look: Look) -> Optional[tuple[NDArray[np.float32], NDArray[np.float32]]]:
        """Radiance, and its axes in the mesh's coordinates. Raises what files.read_image raises, and
        ValueError."""
        if not look.surroundings or look.surroundings_light <= 0:
            return None
        image = _kept(self._surroundings, look.surroundings, 2, lambda: surroundings.read(look.surroundings))
        return (image * np.float32(look.surroundings_light),
                surroundings.axes(self.mesh.up, self.mesh.front, look.surroundings_turn))

    def texture(self, look: Look, small: bool = False) -> Texture:
        """The look's light, scattered in the mesh's texture."""
        made = _kept(self._textures, small, 2, lambda: Texture(self, 512 if small else 1024))
        return made.make(self, look, small)

    def shade(self, name: str, look: Look, width: int, height: int, small: bool = False,
              outputs: tuple[str, ...] = (), albedo: bool = True) -> Pass:
        """Shades what is seen. `name`: of a pass that keeps its settings and images from picture to picture.
        """
        kept = self._passes.setdefault(name + "/small" if small else name, Pass(self.device))
        return kept.shade(self, self.gbuffer(width, height, small), look, outputs, small, albedo)

    def radiance(self, look: Optional[Look] = None, width: int = 960,
                 height: int = 540) -> NDArray[np.float32]:
        """Linear radiance, (height, width, 3), 0 on background."""
        return self.shade("radiance", look or self.look, width, height).outputs["radiance"].copy()

    @property
    def samples(self) -> int:
        """How many pictures a smooth one takes. The reference takes seconds for one."""
        return 1 if self.look.mode in COSTLY else SAMPLES

    def frame(self, width: int, height: int, small: int = 0, sample: int = 0) -> Frame:
        """The picture of now.

        small : int
            While something moves: one of so many pixels of a row or column is shaded, the others are made
            from it and from the last picture at rest; meshes are coarser, and shadow maps have a third of the
            size.
        sample : int
            0 for a picture by itself. After it 1, 2, .. `samples` - 1: the mean with one more that is
            shifted by a part of a pixel, so that edges become smooth.
        """
        built = 0 if self.sketched else self.device.stats().programs_built  # which waits for the device
        started = time.perf_counter()
        self._take_curvature()
        self._shift = (_HALTON[sample - 1][0] - 0.5, _HALTON[sample - 1][1] - 0.5) if sample else (0.0, 0.0)
        right = self.right()
        if right is not None and self.beside:
            width = max(width // 2, 1)
        self._view = view = self.camera(width / height)
        try:
            looks = [self.look] if right is None else [self.look, right]
            pixels, p, seconds = self._shade_views(looks, width, height, small)
        finally:
            self._shift, self._view = (0.0, 0.0), None
        if self._shaded is not None:
            made, kept = self._shaded, self._detailed
            rest = kept[1] if kept is not None and kept[0] == self.look else None
            pixels = [self.renderer.enlarged(view[1], image, made.depth, made.matrix, (width, height),
                                             self._coarse(), rest, made.inside) for image in pixels]
        shown = pixels[0] if right is None else self._joined(*pixels)
        if right is None:
            self.cancel_reference("other")
        if small:
            self._rest = None
        else:
            shown = self._mean(shown, sample)
            self._rest, self._detailed = (shown, view[1]), None
        times = {"OpenGL": 1e3 * (time.perf_counter() - started - seconds), "Pellucid": 1e3 * seconds}
        self.last_pass = p
        if self.sketched:
            return Frame(shown, times, stands_in=True)
        stats, after = p.shader.stats(), self.device.stats().programs_built
        times["on the device"] = stats.device_milliseconds
        return Frame(shown, times, stats.to_dict(), p.shader.warnings() + list(self.mesh.warnings), after,
                     after - built, p.stands_in)

    def _shade_views(self, looks: list[Look], width: int, height: int,
                     small: int) -> tuple[list[NDArray[np.uint8]], Pass, float]:
        """Pictures of the looks, the pass of the first, and the seconds that Pellucid took. While only the
        camera moves, each shaded picture is used three times."""
        key = (width, height, small, [look.copy() for look in looks])
        kept, (eye, matrix) = self._shaded, self._view
        # The last row is the direction of view.
        if (kept is not None and kept.key == key and kept.left > 0
                and np.abs(matrix[3, :3] - kept.matrix[3, :3]).max() < 0.07):
            kept.left -= 1
            return [pixels for pixels, _ in kept.made], kept.made[0][1], 0.0
        width, height = (max(v // max(small, 1), 1) for v in (width, height))
        self.shown = g = self.gbuffer(width, height, small > 0)
        self.lights(looks[0], small > 0)
        started = time.perf_counter()
        made = [picture(self, name, look, width, height, small > 0)
                for name, look in zip(("main", "other"), looks)]
        seconds, self._shaded = time.perf_counter() - started, None
        if small > 1:
            if self._away is None or self._away[0] is not g:
                facing = np.einsum("ijk,ijk->ij", g.position - eye, g.normal_geometric)
                inside = (facing > 0.2 * self.orbit.distance).mean() > 0.001
                self._away = (g, depth(g, matrix), bool(inside))
            self._shaded = Shaded(key, made, self._away[1], matrix, self._away[2])
        return [pixels for pixels, _ in made], made[0][1], seconds

    def prepare(self, width: int, height: int) -> None:
        """Builds the kernels that a material slider needs when it leaves or reaches 0, so that no slider
        waits for them. Keeps the details that moving pictures take from the picture at rest."""
        if self.look.mode in COSTLY:
            return
        g, last = self.shown, self.last_pass
        if g is not None and self._rest is not None and self.right() is None:
            (rest, matrix), self._shaded = self._rest, None
            rough = self.frame(rest.shape[1], rest.shape[0], 3).pixels
            # The camera may have moved since.
            if rest.shape[:2] == g.material.shape and np.array_equal(self._shaded.matrix, matrix):
                self.renderer.keep_details(rest, g, matrix, rough, list(self.eyes(self.look)))
                self._detailed = self.look.copy(), matrix
            self.shown, self.last_pass = g, last
        base = self.look
        structure = (base.mode, base.method, base.ggx, [(lamp.on, lamp.shadow) for lamp in base.lamps])
        if structure == self._prepared:
            return
        for change in ({"deep_scatter": (1.0, 1.0, 1.0)},
                       {"deep_scatter": (0.0, 0.0, 0.0), "transmission": 0.0}):
            other = base.copy()
            for name, value in change.items():
                setattr(other, name, value)
            with self.complete():
                picture(self, "main", other, width, height, False)
        self._prepared = structure

    def right(self) -> Optional[Look]:
        """The look shown on the right, if any."""
        if not self.against:
            return self.other
        look = self.look.copy()
        look.method = self.against
        return look

    @property
    def side_by_side(self) -> bool:
        return self.beside and (bool(self.against) or self.other is not None)

    def scattering_at(self, row: int, column: int) -> str:
        """How the last picture scatters the light of a pixel of skin."""
        assert self.shown is not None
        height, width = self.shown.material.shape
        key = (self.drawn_state(width, height), self.look.copy())
        if self._scattered is None or self._scattered[0] != key:
            self._scattered = (key, *scattered_tiles(self, self.look, width, height, False)[:2])
        _, method, changed = self._scattered
        return method if changed[row, column] else f"{method}, which leaves this tile as it is"

    def _joined(self, left: NDArray[np.uint8], right: NDArray[np.uint8]) -> NDArray[np.uint8]:
        width = left.shape[1]
        x = width if self.beside else int(np.clip(round(self.wipe * width), 0, width))
        both = np.concatenate([left, right], 1) if self.beside else left.copy()
        both[:, x:] = right if self.beside else right[:, x:]
        both[:, max(x - 1, 0):x + 1] = 255
        return both

    def _mean(self, pixels: NDArray[np.uint8], sample: int) -> NDArray[np.uint8]:
        """The mean of this picture and those since sample 0, of radiance, not of bytes."""
        if sample == 0 or self._sum is None or self._sum[1].shape != pixels.shape:
            self._sum = (1, LINEAR[pixels])
            return pixels
        count, total = self._sum
        total += LINEAR[pixels]
        self._sum = (count + 1, total)
        return srgb_bytes(total * np.float32(1 / (count + 1)))

    def smooth(self, width: int, height: int) -> NDArray[np.uint8]:
        """The picture with smooth edges, (height, width, 3), sRGB."""
        with self.complete():
            pixels = self.frame(width, height).pixels
            for sample in range(1, self.samples):
                pixels = self.frame(width, height, sample=sample).pixels
        return pixels
