"""A scene file in the viewer: its G-buffer is drawn, so the camera stays; materials and lights are tuned."""
from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from .. import files
from .._types import Material, Scattering
from ..device import Device
from ..scene import Scene, Shaded, load_scene, shade
from .look import MODES as MESH_MODES
from .session import Frame

MODES = {**{mode: MESH_MODES[mode] for mode in
            ("final", "lambert", "difference", "diffuse", "specular", "deep_scatter")},
         "thickness": "Thickness (white: 20 mm)"}
_PARTS = ("diffuse", "specular", "deep_scatter", "thickness")


@dataclass
class SceneLook:
    """How a scene is shown; materials and lights are the scene's own."""

    mode: str = "final"
    exposure: float = 1.0
    curve: str = "soft"
    shoulder: float = 0.8
    lights: list[float] = field(default_factory=list)  # factors of their colours
    ambient: float = 1.0                               # factor of ambient light


class SceneSession:
    """Like Session, of a scene file. One thread makes it and uses it."""

    def __init__(self, path: Any, gbuffer: Any = None, device: Optional[Device] = None) -> None:
        self.device = Device() if device is None else device
        self.path, self.gbuffer_path = path, gbuffer
        self.scene = load_scene(path, gbuffer)
        found = self.scene.gbuffer_file() if gbuffer is None else gbuffer
        if found is None:
            raise ValueError(f"{path} has no G-buffer beside it; name one with --gbuffer")
        # While something moves, every second pixel serves.
        channels = {name: pixels[::2, ::2] for name, pixels in files.read_image(found).items()}
        self._small = load_scene(path, channels)
        # What the page sets: the scene has others while it is shaded without scattering.
        self.materials, self.profiles = self.scene.materials, self.scene.profiles
        self._colors = [light.color.copy() for light in self.scene.lights]
        self._ambient = (self.scene.ambient.constant.copy(), self.scene.ambient.sh.copy())
        self.look = SceneLook(lights=[1.0] * len(self._colors))
        self.count = False
        self.samples = 1
        self.report: Any = None  # as of Session: whether pictures without scattering stand in

    def _shade(self, small: bool, outputs: tuple[str, ...] = (), plain: bool = False) -> Shaded:
        scene = self._small if small else self.scene
        source = self.scene
        scene.options, scene.camera = source.options, source.camera
        kept, names = self.materials, self.profiles
        scene.materials = {id: self._plain(m) for id, m in kept.items()} if plain else kept
        scene.profiles = dict.fromkeys(names, "") if plain else names
        self._light(scene)
        try:
            return shade(scene, self.device, outputs, self.count, wait=self.report is None)
        finally:
            scene.materials, scene.profiles = kept, names

    def _light(self, scene: Scene) -> None:
        """Gives it the lights of the page."""
        for light, color, factor in zip(scene.lights, self._colors, self.look.lights):
            light.color = color * factor
        scene.ambient.constant, scene.ambient.sh = (v * np.float32(self.look.ambient) for v in self._ambient)

    @staticmethod
    def _plain(material: Material) -> Material:
        copy = material.copy()
        copy.scattering, copy.profile = Scattering.NONE, None
        copy.transmission, copy.deep_scatter_color = 0.0, (0, 0, 0)
        return copy

    def _picture(self, small: bool) -> tuple[NDArray[np.uint8], Shaded]:
        look, mode = self.look, self.look.mode
        made = self._shade(small, (mode,) if mode in _PARTS else (), plain=mode == "lambert")
        shown = made.outputs[mode] if mode in _PARTS else made.radiance
        if mode == "difference":
            shown = 0.2 + 4 * (shown - self._shade(small, plain=True).radiance)
        if mode == "thickness":
            shown = np.repeat(shown[..., None] * (self.scene.options.millimetres_per_unit / 20), 3, 2)
        if mode in ("difference", "thickness"):
            return files.tonemap(shown, curve="none"), made
        return files.tonemap(shown, look.exposure, look.shoulder, look.curve), made

    def frame(self, width: int = 0, height: int = 0, small: bool = False, sample: int = 0) -> Frame:
        """The picture of now, in the size of the G-buffer, or half of it on each side while something moves.
        """
        built, started = self.device.stats().programs_built, time.perf_counter()
        pixels, made = self._picture(small)
        assert made.stats is not None
        times = {"Pellucid": 1e3 * (time.perf_counter() - started),
                 "on the device": made.stats.device_milliseconds}
        after = self.device.stats().programs_built
        return Frame(pixels, times, made.stats.to_dict(), made.warnings, after, after - built,
                     bool(made.stats.stands_in))

    @property
    def settings(self) -> dict[str, Any]:
        """Materials and profiles, for undo and redo."""
        return {"materials": {id: m._data.tobytes() for id, m in self.materials.items()},
                "profiles": dict(self.profiles)}

    @settings.setter
    def settings(self, values: dict[str, Any]) -> None:
        for id, data in values["materials"].items():
            stored = self.materials[id]._data
            stored[...] = np.frombuffer(data, stored.dtype)
        self.profiles.update(values["profiles"])

    def prepare(self, width: int, height: int) -> None:
        """Does nothing: a scene's sliders need no other kernels."""

    def save(self, path: Any) -> None:
        """Writes the scene as it is shown."""
        self._light(self.scene)  # the last picture may have been a small one
        self.scene.save(path)

    def restarted(self, device: Device) -> SceneSession:
        """The same with another device."""
        fresh = SceneSession(self.path, self.gbuffer_path, device)
        for name in ("materials", "profiles"):
            setattr(fresh, name, getattr(self, name))
            setattr(fresh.scene, name, getattr(self, name))
        fresh.scene.options = self.scene.options
        fresh.look, fresh.count, fresh.report = self.look, self.count, self.report
        return fresh
