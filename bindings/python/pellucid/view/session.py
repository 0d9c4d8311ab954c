"""Mesh, look and camera in, picture out: what the page shows, and what a program can use without it."""
from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from .. import files
from .._types import Ambient, Camera, Eye, Light, Material
from ..device import Device
from ..mesh import MeshTopology
from ..profile import Profile
from ..shader import Shader
from .camera import Orbit, direction
from .look import CUT, EYES, RIGHT_EYE, SKIN, TEETH, TONGUE, Lamp, Look
from .renderer import GBuffer, Renderer


@dataclass
class Frame:
    """One picture, and what it took."""

    pixels: NDArray[np.uint8]                                   # (h, w, 3), sRGB
    milliseconds: dict[str, float] = field(default_factory=dict)  # per stage
    counts: dict[str, Any] = field(default_factory=dict)        # of the shader
    warnings: list[str] = field(default_factory=list)


@dataclass
class ShadowMap:
    depth: NDArray[np.float32]  # (size, size)
    light: Light


# (specular, roughness) of what is not skin, as in the demo.
# Eyes: that of their film of tears.
_GLOSS = {EYES: (0.0, 1.0), RIGHT_EYE: (0.0, 1.0), TEETH: (0.5, 0.15), TONGUE: (0.4, 0.2), CUT: (0.0, 1.0)}
_OUTPUTS = {"diffuse": "out_diffuse", "specular": "out_specular", "deep_scatter": "out_deep_scatter", "thickness": "out_thickness"}


def tinted(g: GBuffer, look: Look) -> NDArray[np.float32]:
    """The albedo with the look's tint on skin, (h, w, 3)."""
    return np.where(g.material[..., None] == SKIN, np.minimum(g.albedo * np.asarray(look.albedo, np.float32), 1.0), g.albedo)


class _Pass:
    """A shader and its last settings, so that only changed settings are set again."""

    def __init__(self, device: Device) -> None:
        self.shader = Shader(device)
        self.told: dict[str, Any] = {}
        self.outputs: dict[str, NDArray[np.float32]] = {}

    def tell(self, what: str, value: Any, how: Any) -> None:
        if what not in self.told or self.told[what] != value:
            how()
            self.told[what] = value
            self.told["committed"] = False


class Session:
    """Owns the renderer and the device. One thread makes it and uses it."""

    def __init__(self, device: Optional[Device] = None, millimetres_per_unit: float = 1.0) -> None:
        self.device = Device() if device is None else device
        self.renderer = Renderer()
        self.mm = millimetres_per_unit
        self.orbit = Orbit()
        self.look = Look()
        self.other: Optional[Look] = None  # on the right of the wipe
        self.wipe = 0.5
        self.count = False  # fill every counter of the shader, at some cost
        self._passes: dict[str, _Pass] = {}
        self._maps: dict[Any, ShadowMap] = {}
        self._profiles: dict[str, Profile] = {}
        self._gbuffer: Optional[GBuffer] = None
        self._drawn: Any = None
        self._reference: Optional[tuple[Any, NDArray[np.float32]]] = None

    # ---- What is shown -----------------------------------------------------------------------------------------------

    def load(self, path: Any, subdivide: Optional[int] = None, up: str = "auto") -> files.Mesh:
        """Shows another mesh. Raises what files.load_mesh and MeshTopology raise; the mesh before it then stays."""
        mesh = files.load_mesh(path, subdivide, up)
        weld = {} if mesh.ids is not None else {"weld": "exact", "positions": mesh.positions}
        topology = MeshTopology(self.device, mesh.triangles, len(mesh.positions), **weld)
        curvature = topology.curvature(mesh.positions, mesh.normals, smoothing_passes=2)
        self.renderer.set_mesh(mesh, curvature, self.mm)
        self.mesh = mesh
        self.centre = (np.asarray(mesh.low, float) + mesh.high) / 2
        self._maps.clear()
        self._drawn = self._reference = None
        self.orbit.frame(mesh.low, mesh.high, 16 / 9)
        return mesh

    def to_light(self, lamp: Lamp) -> NDArray[np.float64]:
        return direction(self.mesh.up, self.mesh.front, lamp.azimuth, lamp.elevation)

    def shadow_map(self, lamp: Lamp, size: int) -> ShadowMap:
        key = (lamp.azimuth, lamp.elevation, size)
        if key not in self._maps:
            while len(self._maps) > 8:
                self._maps.pop(next(iter(self._maps)))
            self._maps[key] = ShadowMap(*self.renderer.shadow_map(self.to_light(lamp), size, self.mesh.up))
        return self._maps[key]

    def profile(self, look: Look) -> Profile:
        key = f"custom {look.distance}" if look.profile == "custom" else look.profile
        if key not in self._profiles:
            while len(self._profiles) > 32:
                self._profiles.pop(next(iter(self._profiles)))
            self._profiles[key] = Profile.burley_distance(look.distance, "custom") if look.profile == "custom" else Profile.named(key)
        return self._profiles[key]

    def camera(self, aspect: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Eye, and world to clip space in OpenGL's convention."""
        return self.orbit.matrices(self.mesh.up, self.mesh.front, self.centre, self.renderer.radius + float(np.linalg.norm(
            self.renderer.centre - self.centre)), aspect)

    def gbuffer(self, width: int, height: int) -> GBuffer:
        _, matrix = self.camera(width / height)
        # The reference has the mesh's own normals.
        pores = 0.0 if self.look.mode in ("error", "reference") else self.look.pores
        state = (matrix.tobytes(), width, height, pores)
        if self._drawn != state:
            self._gbuffer = self.renderer.gbuffer(matrix, width, height, pores)
            self._drawn = state
        assert self._gbuffer is not None
        return self._gbuffer

    # ---- Shading -----------------------------------------------------------------------------------------------------

    def materials(self, look: Look) -> dict[int, Material]:
        """What the ids of the mesh are made of."""
        specular = {"specular": look.specular, "roughness": look.roughness, "f0": look.f0, "roughness2": look.roughness2,
                    "lobe_mix": look.lobe_mix, "specular_model": "ggx" if look.ggx else "ksk"}
        skin = Material(scattering=look.method, **specular)
        if look.method != "none" or look.transmission > 0:
            skin.profile = self.profile(look)
            skin.transmission = look.transmission
            skin.deep_scatter_color = look.deep_scatter
            if look.radius_scale != 1:
                skin.diffusion_radius = skin.profile.info.radius * look.radius_scale / self.mm
        made = {SKIN: skin}
        for id, (amount, roughness) in _GLOSS.items():
            made[id] = Material(scattering="none", thickness_taps=0, specular=amount, roughness=roughness)
        present = {1} if self.mesh.ids is None else set(np.unique(self.mesh.ids).tolist())
        return {id: m for id, m in made.items() if id in present}

    def eyes(self, look: Look) -> dict[int, Eye]:
        """The eyes of the mesh, an adult's as large as its balls, by material id."""
        found = {}
        for id, ball in zip((EYES, RIGHT_EYE), self.mesh.eyes):
            eye = Eye(center=ball["centre"], gaze=ball["gaze"], up=self.mesh.up, pupil_radius=look.pupil)
            scale = ball["radius"] * self.mm / eye.sclera_radius
            for length in ("sclera_radius", "cornea_radius", "limbus_radius", "limbus_width", "chamber_depth", "pupil_radius"):
                setattr(eye, length, scale * getattr(eye, length))
            found[id] = eye
        return found

    def lights(self, look: Look, small: bool = False) -> list[tuple[Light, Optional[ShadowMap]]]:
        found: list[tuple[Light, Optional[ShadowMap]]] = []
        for lamp in look.lamps:
            if not lamp.on or lamp.intensity <= 0:
                continue
            map = self.shadow_map(lamp, look.shadow_size // (2 if small else 1)) if lamp.shadow else None
            light = map.light.copy() if map else Light(to_light=self.to_light(lamp))
            light.color = np.multiply(lamp.color, lamp.intensity)
            found.append((light, map))
        return found

    def _shade(self, name: str, look: Look, outputs: tuple[str, ...], width: int, height: int, small: bool,
               albedo: bool = True) -> _Pass:
        g = self.gbuffer(width, height)
        p = self._passes.setdefault(name, _Pass(self.device))
        s, memory = p.shader, (g.position.ctypes.data, width, height, look.albedo, albedo)

        def images() -> None:
            for slot, image in (("position", g.position), ("material", g.material), ("normal_geometric", g.normal_geometric),
                                ("normal_shading", g.normal_shading), ("curvature", g.curvature)):
                s.set_image(slot, image)
            p.outputs = {"radiance": np.zeros((height, width, 3), np.float32)}
            s.set_image("radiance", p.outputs["radiance"])

        p.tell("images", memory[:3], images)
        tints = albedo and tuple(look.albedo) != (1.0, 1.0, 1.0)
        if tints:  # host work: only where a tint is set
            values = tinted(g, look)
            if p.outputs.get("albedo") is None or p.outputs["albedo"].shape != values.shape:
                p.outputs["albedo"] = values
                p.told.pop("albedo", None)
            else:
                p.outputs["albedo"][...] = values
        p.tell("albedo", (memory, tints), lambda: s.set_image("albedo", None if not albedo else p.outputs["albedo"] if tints else g.albedo))

        def parts() -> None:
            for slot in _OUTPUTS.values():
                wanted = slot in outputs
                if wanted:
                    p.outputs[slot] = np.zeros((height, width) + (() if slot == "out_thickness" else (3,)), np.float32)
                s.set_image(slot, p.outputs[slot] if wanted else None)

        p.tell("parts", (memory[:3], outputs), parts)
        materials = self.materials(look)
        if not albedo:
            for m in materials.values():
                m.albedo, m.specular = (1.0, 1.0, 1.0), 0.0

        eyes = {id: eye for id, eye in self.eyes(look).items() if albedo and id in materials}

        def set_materials() -> None:
            for id in _GLOSS | {SKIN: None}:
                s.set_material(id, materials.get(id))
                if id in materials:
                    s.set_eye(id, eyes.get(id))

        told = {k: (m._data.tobytes(), id(m._profile)) for k, m in materials.items()}
        p.tell("materials", (told, {k: e._data.tobytes() for k, e in eyes.items()}), set_materials)
        lights = self.lights(look, small)

        def set_lights() -> None:
            s.set_lights([light for light, _ in lights])
            for i, (_, map) in enumerate(lights):
                s.set_light_image(i, "shadow_map", None if map is None else map.depth)

        p.tell("lights", [(light._data.tobytes(), id(map)) for light, map in lights], set_lights)
        p.tell("ambient", look.ambient, lambda: s.set_ambient(Ambient(constant=[look.ambient] * 3)))
        eye, _ = self.camera(width / height)
        p.tell("camera", eye.tobytes(), lambda: s.set_camera(Camera(position=eye)))
        p.tell("options", (look.target_error, self.count, self.mm), lambda: s.set_options(
            target_error=look.target_error, millimetres_per_unit=self.mm, count_pixels=int(self.count)))
        if not p.told.get("committed"):
            s.commit()
            p.told["committed"] = True
        p.outputs["radiance"][...] = 0
        s.execute()
        return p

    def radiance(self, look: Optional[Look] = None, width: int = 960, height: int = 540) -> NDArray[np.float32]:
        """Linear radiance, (height, width, 3), 0 on background."""
        return self._shade("radiance", look or self.look, (), width, height, False).outputs["radiance"].copy()

    def _picture(self, name: str, look: Look, width: int, height: int, small: bool) -> tuple[NDArray[np.uint8], _Pass]:
        mode = look.mode
        plain = look.copy()
        plain.method, plain.transmission = "none", 0.0
        if mode in ("lambert", "irradiance"):
            p = self._shade(name, plain, (), width, height, small, albedo=mode != "irradiance")
        else:
            p = self._shade(name, look, (_OUTPUTS[mode],) if mode in _OUTPUTS else (), width, height, small)
        g = self.gbuffer(width, height)
        shown: NDArray[Any]
        if mode == "difference":
            q = self._shade(name + "/plain", plain, (), width, height, small)
            shown = 0.2 + 4 * (p.outputs["radiance"] - q.outputs["radiance"])
        elif mode in ("reference", "error"):
            from .reference import reference

            shown = reference(self, look, width, height)
            if mode == "error":
                bare = look.copy()
                bare.specular = 0.0
                q = self._shade(name + "/bare", bare, (), width, height, small)
                skin = (g.material == SKIN)[..., None]
                shown = 0.2 + 10 * np.where(skin, q.outputs["radiance"] - shown, 0)
        elif mode == "thickness":
            shown = np.repeat(p.outputs["out_thickness"][..., None] * (self.mm / 20), 3, 2)
        elif mode in _OUTPUTS:
            shown = p.outputs[_OUTPUTS[mode]]
        elif mode == "curvature":
            shown = np.repeat(np.abs(g.curvature)[..., None] / (0.2 * self.mm), 3, 2)
        elif mode == "normals":
            shown = np.where(g.material[..., None] > 0, 0.5 + 0.5 * g.normal_shading, 0)
        elif mode == "albedo":
            shown = g.albedo
        elif mode == "materials":
            shown = np.array([[0, 0, 0], [.8, .4, .3], [.2, .5, .9], [.9, .9, .5], [.9, .2, .4], [.2, .2, .2], [.2, .8, .9]],
                             np.float32)[np.minimum(g.material.astype(int), 6)]
        else:
            shown = p.outputs["radiance"]
        linear = mode in ("final", "lambert", "diffuse", "specular", "deep_scatter", "irradiance", "reference", "albedo")
        return (files.tonemap(shown, look.exposure, look.shoulder, look.curve) if linear else files.tonemap(shown, curve="none")), p

    def frame(self, width: int, height: int, small: bool = False) -> Frame:
        """The picture of now. `small`: while something moves; shadow maps are of half the size."""
        started = time.perf_counter()
        self.gbuffer(width, height)
        for lamp in self.look.lamps:
            if lamp.on and lamp.shadow and lamp.intensity > 0:
                self.shadow_map(lamp, self.look.shadow_size // (2 if small else 1))
        drawn = time.perf_counter()
        pixels, p = self._picture("main", self.look, width, height, small)
        stats = p.shader.stats()
        if self.other is not None:
            right, _ = self._picture("other", self.other, width, height, small)
            x = int(np.clip(round(self.wipe * width), 0, width))
            pixels = pixels.copy()
            pixels[:, x:] = right[:, x:]
            pixels[:, max(x - 1, 0):x + 1] = 255
        shaded = time.perf_counter()
        return Frame(pixels, {"OpenGL": 1e3 * (drawn - started), "Pellucid": 1e3 * (shaded - drawn), "on the device": stats.device_milliseconds},
                     stats.to_dict(), p.shader.warnings() + list(self.mesh.warnings))
