"""Scene files: what `pellucid shade` reads, to be changed and shaded from Python."""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _show
from ._struct import OfThisProcess
from ._types import Ambient, Camera, Light, Material, ShaderOptions, ShaderStats
from .device import Device, _filled

_OUTPUTS = ("diffuse", "deep_scatter", "specular", "thickness")


@dataclass
class Shaded:
    """What `shade` made."""

    radiance: NDArray[np.float32]                       # (h, w, 3), linear, 0 where there is no material
    # (h, w, 3); "thickness": (h, w), length
    outputs: dict[str, NDArray[np.float32]] = field(default_factory=dict)
    stats: Optional[ShaderStats] = None
    warnings: list[str] = field(default_factory=list)

    def __repr__(self) -> str:
        height, width, _ = self.radiance.shape
        parts = f", with {', '.join(self.outputs)}" if self.outputs else ""
        return f"<pellucid.Shaded {width} x {height}{parts}>"

    def save(self, path: Any, **tone: Any) -> None:
        """Writes the radiance to an .exr, or a picture of it to a .png, .jpg, .tga or .bmp; see
        `files.write_image`."""
        from .files import write_image

        write_image(path, self.radiance, **tone)

    def _repr_png_(self) -> bytes:
        return _show.png(_show.srgb(self.radiance))


class Scene(OfThisProcess):
    """A scene file and its G-buffer; made by `load_scene`.

    Changes apply from the next `shade` on; the files do not change.

    Attributes
    ----------
    materials : dict of int to Material
        By the number in the G-buffer. A profile that is set here replaces the file's.
    profiles : dict of int to str
        Names or files of profiles as the scene has them, "" for none.
    lights : list of Light
        Their shadow maps stay with their places in the list; lights that are appended have none.
    ambient : Ambient
    camera : Camera
    options : ShaderOptions
        `target_error` and `millimetres_per_unit` among them.
    channels : dict of str to list of str
        Which channels of the G-buffer feed which image; an image that is left out is not used.
    """

    _instead = "load it there"

    def __init__(self, path: Any) -> None:
        from .files import _files

        self._native = _files.Scene(str(path))
        self._device: Optional[Device] = None
        self.source = str(path)
        state = self._native.state()
        self.channels: dict[str, list[str]] = state["channels"]
        self.materials = {id: _filled(Material, data) for id, data, _ in state["materials"]}
        self.profiles = {id: profile for id, _, profile in state["materials"]}
        self.lights = [_filled(Light, data) for data in state["lights"]]
        self.ambient = _filled(Ambient, state["ambient"])
        self.camera = _filled(Camera, state["camera"])
        self.options = _filled(ShaderOptions, state["options"])

    def __repr__(self) -> str:
        return f"<pellucid.Scene {self.source}: {len(self.materials)} materials, {len(self.lights)} lights>"

    def set_gbuffer(self, gbuffer: Union[str, Path, Mapping[str, ArrayLike]]) -> Scene:
        """The G-buffer: a multi-layer EXR file, or channels by name, (height, width) each. They are copied.
        """
        if isinstance(gbuffer, Mapping):
            self._native.set_gbuffer({name: np.asarray(v, np.float32) for name, v in gbuffer.items()})
        else:
            self._native.read_gbuffer(str(gbuffer))
        return self

    def save(self, path: Any) -> None:
        """Writes the current scene, complete or not at all; files are named relative to the new scene file.
        Options of how a picture is computed, such as `scratch_budget`, `tile_lists` and `count_pixels`, are
        not part of a scene.

        Raises
        ------
        ValueError
            What a file cannot hold: a profile object of a material (name a profile in `profiles` instead), a
            region, an `invalid_color`.
        files.FileError
            The file cannot be written.
        """
        self._native.save(str(path), self._state())

    def _state(self) -> tuple[Any, ...]:
        for id, material in self.materials.items():
            if not isinstance(id, (int, np.integer)) or not 0 <= id < 1 << 32:
                raise TypeError(f"materials: {id!r} is not an id; ids are 1 to 255")
            if not isinstance(material, Material):
                raise TypeError(f"materials[{id}] is {material!r}, not a Material")
            if not isinstance(profile := self.profiles.get(id, ""), str):
                raise TypeError(f"profiles[{id}] is {profile!r}, not the name or the file of a profile")
        return ({image: [names] if isinstance(names, str) else list(names)
                 for image, names in self.channels.items()},
                [(id, m._data.tobytes(), self.profiles.get(id, "")) for id, m in self.materials.items()],
                [light._data.tobytes() for light in self.lights], self.ambient._data.tobytes(),
                self.camera._data.tobytes(), self.options._data.tobytes())

    def gbuffer_file(self) -> Optional[Path]:
        """The G-buffer that the scene names, or the one beside it as the viewer and the demo write it:
        SCENE_gbuffer.exr or gbuffer.exr, if there is one."""
        if named := self._native.gbuffer_file():
            return Path(named)
        here = Path(self.source)
        for candidate in (here.with_name(here.stem + "_gbuffer.exr"), here.with_name("gbuffer.exr")):
            if candidate.exists():
                return candidate
        return None


def load_scene(path: Any, gbuffer: Union[str, Path, Mapping[str, ArrayLike], None] = None) -> Scene:
    """Reads a scene file (TOML), as docs/guide/scene-file.md describes it.

    Parameters
    ----------
    path : str or path
    gbuffer : str, path or dict, optional
        As for `Scene.set_gbuffer`. Without it: what the scene's key `gbuffer` names, else SCENE_gbuffer.exr
        or gbuffer.exr beside the scene, if there is one.

    Raises
    ------
    files.FileError
        A file that is missing or wrong; the message names the line.
    """
    scene = Scene(path)
    found = scene.gbuffer_file() if gbuffer is None else gbuffer
    if found is not None:
        scene.set_gbuffer(found)
    return scene


def shade(scene: Scene, device: Optional[Device] = None, outputs: Iterable[str] = (),
          count: bool = False, wait: bool = True) -> Shaded:
    """Shades a scene to the same bits as ``pellucid shade``.

    Called again after changes of materials, lights or options, it sets only these: images stay on the
    device, and nothing is compiled again unless other features are in use.

    Parameters
    ----------
    scene : Scene
    device : Device, optional
        The one of the last call, or the best of this machine.
    outputs : strings
        Further outputs besides radiance: "diffuse", "deep_scatter", "specular", "thickness".
    count : bool
        Whether every counter of `Shaded.stats` is filled, at some cost.
    wait : bool
        False: while kernels are being built, the picture is one without scattering (`stats.stands_in`).

    Raises
    ------
    ValueError
        No G-buffer, or an unknown output.
    files.FileError
        A channel or file of the scene does not exist.
    PellucidError
        The inputs do not fit together.
    """
    wanted = list(outputs)
    for name in wanted:
        if name not in _OUTPUTS:
            raise ValueError(f"there is no output {name!r}; there are {', '.join(_OUTPUTS)}")
    if not scene._native.has_gbuffer():
        raise ValueError(f"{scene.source} has no G-buffer beside it: load_scene(path, gbuffer=...) names one")
    if device is not None:
        scene._device = device
    elif scene._device is None:
        scene._device = Device()
    options = scene.options
    counted, background = options.count_pixels, options.build_in_background
    try:
        options.count_pixels, options.build_in_background = int(count or counted), int(not wait)
        state = scene._state()
    finally:
        options.count_pixels, options.build_in_background = counted, background
    made = scene._native.shade(scene._device._handle.address(), state, wanted)
    return Shaded(made["radiance"], made["outputs"], _filled(ShaderStats, made["stats"]), made["warnings"])
