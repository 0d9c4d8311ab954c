"""A shader and its last settings: unchanged settings are not set again, and cause no compilation."""
from __future__ import annotations

import contextlib
import os
import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any, Callable

import numpy as np
from numpy.typing import NDArray

from .._types import Ambient, Camera
from ..device import Device
from ..shader import Shader, warm_up_programs
from .lambert import irradiance_at
from .look import MATERIALS, SKIN, Look
from .texture import Texture

if TYPE_CHECKING:
    from .renderer import GBuffer
    from .session import Session

OUTPUTS = {"diffuse": "out_diffuse", "specular": "out_specular", "deep_scatter": "out_deep_scatter",
           "thickness": "out_thickness"}

PATIENCE = 0.3  # seconds that a first picture waits for kernels


def _yield_to_pictures() -> None:
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 19)  # of this thread alone


# Builds kernels while such pictures are shown.
BESIDE = ThreadPoolExecutor(2, "pellucid-kernels", _yield_to_pictures)


def tinted(g: GBuffer, look: Look) -> NDArray[np.float32]:
    """The albedo with the look's tint on skin, (h, w, 3)."""
    return np.where(g.material[..., None] == SKIN,
                    np.minimum(g.albedo * np.asarray(look.albedo, np.float32), 1.0), g.albedo)


class Pass:
    def __init__(self, device: Device) -> None:
        self.device = device
        self.shader = Shader(device)
        self.outputs: dict[str, NDArray[np.float32]] = {}
        self._set: dict[str, Any] = {}
        self._structure: Any = None
        self._texture: Texture | None = None
        self._uv = np.zeros((0, 0, 2), np.float32)
        self.stands_in = False  # whether kernels are still being built, and the picture has no scattering
        self._committing: Future[Any] | None = None  # beside pictures, while it builds kernels

    def _update(self, what: str, value: Any, how: Callable[[], Any]) -> None:
        if what not in self._set or self._set[what] != value:
            how()
            self._set[what] = value
            self._set["committed"] = False

    def shade(self, session: Session, g: GBuffer, look: Look, outputs: tuple[str, ...], small: bool,
              albedo: bool) -> Pass:
        """`albedo` False: irradiance alone."""
        if self._committing is not None:
            if session.background and session.sketched and not wait([self._committing], PATIENCE).done:
                return self._sketch(session, g, look, outputs, small, albedo)
            committing, self._committing = self._committing, None
            committing.result()
            self._set["committed"] = True
        self._images(g, look, albedo)
        height, width = g.material.shape
        memory = (g.position.ctypes.data, width, height)

        def parts() -> None:
            for slot in OUTPUTS.values():
                wanted = slot in outputs
                if wanted:
                    self.outputs[slot] = np.zeros((height, width) + (() if slot == "out_thickness" else (3,)),
                                                  np.float32)
                self.shader.set_image(slot, self.outputs[slot] if wanted else None)

        self._update("parts", (memory, outputs), parts)
        materials = session.materials(look)
        if not albedo:
            for m in materials.values():
                m.albedo, m.specular = (1.0, 1.0, 1.0), 0.0

        eyes = {id: eye for id, eye in session.eyes(look).items() if albedo and id in materials}
        iris = session.iris(look) if eyes else None

        def set_materials() -> None:
            for id in MATERIALS:
                self.shader.set_material(id, materials.get(id))
                if id in materials:
                    self.shader.set_eye(id, eyes.get(id))
                if id in eyes:
                    self.shader.set_iris_texture(id, iris)
            self._set.pop("texture", None)  # removed with its material

        state = {k: (m._data.tobytes(), id(m.profile)) for k, m in materials.items()}
        self._update("materials",
                   (state, {k: (e._data.tobytes(), look.iris_profile) for k, e in eyes.items()}, id(iris)),
                   set_materials)
        lights = session.lights(look, small)

        def set_lights() -> None:
            self.shader.set_lights([light for light, _ in lights])
            for i, (_, map) in enumerate(lights):
                self.shader.set_light_image(i, "shadow_map", None if map is None else map.depth)

        self._update("lights", [(light._data.tobytes(), id(map)) for light, map in lights], set_lights)
        ambient = session.ambient(look)
        self._update("ambient", ambient, lambda: self.shader.set_ambient(Ambient(constant=[ambient] * 3)))
        around = (look.surroundings, look.surroundings_light, look.surroundings_turn, session.mesh.up)
        self._update("surroundings", around,
                     lambda: self.shader.set_environment(*(session.surroundings(look) or (None,))))
        eye, _ = session.camera(width / height)
        self._update("camera", eye.tobytes(), lambda: self.shader.set_camera(Camera(position=eye)))
        options = {"target_error": look.target_error, "millimetres_per_unit": session.mm,
                   "count_pixels": int(session.count), "build_in_background": int(session.background)}
        self._update("options", options, lambda: self.shader.set_options(**options))
        self._scattered_texture(session, g, look, small)
        if not self._set.get("committed"):
            structure = (outputs, albedo, len(eyes), bool(look.surroundings), look.method, look.ggx,
                         len(lights), [m.specular > 0 for m in materials.values()],
                         any(look.deep_scatter), look.transmission > 0)
            if structure != self._structure and not session.background:
                # Kernels can only be missing in this case: warm up with progress.
                warm_up_programs(self.device, shaders=[self.shader])
                self._structure = structure
            if session.background and session.sketched:
                self._committing = BESIDE.submit(self.shader.commit)
                return self.shade(session, g, look, outputs, small, albedo)
            self.shader.commit()
            self._set["committed"] = True
        if session.measuring:
            return self._sketch(session, g, look, outputs, small, albedo)
        self.outputs["radiance"][...] = 0
        self.shader.execute()
        session.sketched = False
        self.stands_in = session.background and bool(self.shader.stats().stands_in)
        if self.stands_in:
            self._set["committed"] = False  # the next picture asks again
        return self

    def _sketch(self, session: Session, g: GBuffer, look: Look, outputs: tuple[str, ...], small: bool,
                albedo: bool) -> Pass:
        """Lambert shading without Pellucid, into separate memory because the shader may be in use."""
        seen = g.material > 0
        shown = np.zeros((*seen.shape, 3), np.float32)
        shown[seen] = irradiance_at(session, look, g.position[seen], g.normal_shading[seen], small)
        if albedo:
            shown *= tinted(g, look)
        self.outputs = {name: np.zeros_like(g.curvature) if name == "out_thickness" else shown
                        for name in ("radiance", *outputs)}
        for what in ("images", "parts", "albedo"):  # to be set again
            self._set.pop(what, None)
        self.stands_in = True
        return self

    def _images(self, g: GBuffer, look: Look, albedo: bool) -> None:
        height, width = g.material.shape
        memory = (g.position.ctypes.data, width, height)

        def images() -> None:
            for slot in ("position", "material", "normal_geometric", "normal_shading", "curvature"):
                self.shader.set_image(slot, getattr(g, slot))
            self.outputs = {"radiance": np.zeros((height, width, 3), np.float32)}
            self.shader.set_image("radiance", self.outputs["radiance"])

        self._update("images", memory, images)
        tints = albedo and tuple(look.albedo) != (1.0, 1.0, 1.0)
        if tints:  # host work: only where a tint is set
            if self.outputs.get("albedo") is None or self.outputs["albedo"].shape != g.albedo.shape:
                # With the same strides as the renderer's image, because kernels depend on the layout.
                self.outputs["albedo"] = np.zeros(
                    (height, width, g.albedo.strides[1] // 4), np.float32)[..., :3]
                self._set.pop("albedo", None)
            self.outputs["albedo"][...] = tinted(g, look)
        self._update("albedo", (memory, albedo, tints), lambda: self.shader.set_image(
            "albedo", None if not albedo else self.outputs["albedo"] if tints else g.albedo))

    def _scattered_texture(self, session: Session, g: GBuffer, look: Look, small: bool) -> None:
        if look.method != "texture":
            self._update("uv", None, lambda: self.shader.set_image("uv", None))
            return
        if self._uv.shape[:2] != g.u.shape:
            self._uv = np.empty((*g.u.shape, 2), np.float32)
        self._uv[..., 0], self._uv[..., 1] = g.u, g.v
        self._update("uv", self._uv.ctypes.data, lambda: self.shader.set_image("uv", self._uv))
        texture = session.texture(look, small)
        self._update("texture", id(texture), lambda: self.shader.set_scattered_texture(SKIN, texture.light))
        self._texture = texture
