"""Shading a G-buffer."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Optional

from . import _flight, _native
from ._arrays import Image, submit
from ._struct import to_enum
from ._types import Ambient, Camera, ImageSlot, Light, LightSlot, Material, ShaderOptions, ShaderStats
from .device import Device, Event, _filled, _handles
from .lut import Lut


class Shader:
    """Set images, materials and lights, commit, execute. A slot that is not set is a feature that is off.

    Images stay the caller's: the shader reads and writes them where they are at each execution, so changing an array
    in place and executing again shades the new values. One thread at a time uses a shader.
    """

    def __init__(self, device: Device) -> None:
        self.device = device
        self._handle = _native.Shader.create(device._handle)
        self._images: dict[Any, Image] = {}

    def set_image(self, slot: ImageSlot | str, image: Any) -> Shader:
        """Sets one image of the G-buffer.

        Parameters
        ----------
        slot : ImageSlot or str
            Such as "normal_shading"; "radiance" is the output.
        image : array, pyopencl.array.Array, Image or None
            (height, width[, components]), see Image; None clears the slot.
        """
        s = to_enum(ImageSlot, slot, "slot")
        self._keep(s, image, s.name.lower(), s == ImageSlot.RADIANCE, s == ImageSlot.MATERIAL,
                   lambda native: self._handle.set_image(int(s), native))
        return self

    def set_light_image(self, light: int, slot: LightSlot | str, image: Any) -> Shader:
        """Sets the "wide_shadow" (the size of the G-buffer) or the "shadow_map" (any size) of a light, or clears it."""
        s = to_enum(LightSlot, slot, "slot")
        self._keep((light, s), image, f"{s.name.lower()} of light {light}", False, False,
                   lambda native: self._handle.set_light_image(light, int(s), native))
        return self

    def _keep(self, key: Any, image: Any, what: str, output: bool, ids: bool, use: Any) -> None:
        if image is not None and not isinstance(image, Image):
            image = Image(self.device, image, _slot=what, _output=output, _ids=ids)
        use(None if image is None else image._view.native)
        if image is None:
            self._images.pop(key, None)
        else:
            if output and hasattr(image._view.span, "output"):
                image._view.span.output = True
            self._images[key] = image

    def set_material(self, id: int, material: Optional[Material], curvature_lut: Optional[Lut] = None,
                     shadow_lut: Optional[Lut] = None) -> Shader:
        """Sets material `id`, 1 to 255; None removes it. Without a table: no direct scattering, a plain shadow."""
        self._handle.set_material(id, None if material is None else material._data,
                                  None if curvature_lut is None else curvature_lut._handle,
                                  None if shadow_lut is None else shadow_lut._handle)
        return self

    def set_lights(self, lights: Sequence[Light]) -> Shader:
        """Replaces all lights, 0 to 64; images of lights beyond the count are cleared."""
        self._handle.set_lights([light._data for light in lights])
        for key in [k for k in self._images if isinstance(k, tuple) and k[0] >= len(lights)]:
            del self._images[key]
        return self

    def set_ambient(self, ambient: Ambient) -> Shader:
        """Sets the light from everywhere."""
        self._handle.set_ambient(ambient._data)
        return self

    def set_camera(self, camera: Camera) -> Shader:
        """Sets the viewpoint, which specular and depth images need."""
        self._handle.set_camera(camera._data)
        return self

    def set_options(self, options: Optional[ShaderOptions] = None, **fields: Any) -> Shader:
        """Sets the options, or the defaults with some `fields` of them changed."""
        settings = ShaderOptions() if options is None else options.copy()
        for name, value in fields.items():
            setattr(settings, name, value)
        self._handle.set_options(settings._data)
        return self

    def commit(self) -> Shader:
        """Checks that everything fits together, derives the features and builds what they need.

        Raises
        ------
        PellucidError
            What is missing or does not fit.
        """
        self._handle.commit()
        return self

    def execute(self) -> None:
        """Shades, and waits for the result.

        Raises
        ------
        PellucidError
            INVALID_STATE when something was set after the last commit.
        """
        self.submit().wait()

    def submit(self, waits: Iterable[Event] = ()) -> Event:
        """Shades after `waits`, without waiting: leave the images alone until the event is done."""
        images = list(self._images.values())
        event = submit([i._view for i in images], _handles(waits), self._handle.execute)
        _flight.hold(event, self, images)
        return Event(event)

    def stats(self) -> ShaderStats:
        """What the last execution did."""
        self.device.finish()
        return _filled(ShaderStats, self._handle.stats())
