"""Scattering alone, for hosts that light their own frames."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import Image, natives, submit, to_image
from ._struct import OfThisProcess, to_enum
from ._types import ImageSlot, ScatterControls, ScatterParams, ScatterStats
from .device import Device, Event, _filled, _handles
from .profile import Profile, as_profile


class Scatter(OfThisProcess):
    """Takes the irradiance of a picture and returns it scattered under the surface; see pelScatterExecute.
    Keeps memory between frames."""

    _instead = "make one there"

    def __init__(self, device: Device) -> None:
        self.device = device
        self._handle = _native.Scatter.create(device._handle)
        self._images: dict[ImageSlot, Image] = {}

    def set_material(self, id: int, profile: Profile | str | None, scale: float = 1.0) -> None:
        """Pixels of `id`, 1 to 255, scatter by `profile` (or the material of the library of that name),
        whose lengths count `scale` units of positions each; None: not at all."""
        known = as_profile(profile)
        self._handle.set_material(id, None if known is None else known._handle, scale)

    def set_controls(self, id: int, controls: Optional[ScatterControls] = None, **fields: Any) -> None:
        """How pixels of `id`, whose material is set, scatter: the controls, or the defaults with some
        `fields` of them changed."""
        settings = ScatterControls() if controls is None else controls.copy()
        for name, value in fields.items():
            setattr(settings, name, value)
        self._handle.set_controls(id, settings._data)

    def set_image(self, slot: ImageSlot | str, image: Any) -> None:
        """An image that executions read beside those they are given: "scatter_weight", "irradiance_back" or
        "albedo"; None clears it. It stays the caller's, and is read at each execution."""
        s = to_enum(ImageSlot, slot, "slot")
        image = to_image(self.device, image, s.name.lower())
        self._handle.set_image(int(s), None if image is None else image._view.native)
        if image is None:
            self._images.pop(s, None)
        else:
            self._images[s] = image

    def execute(self, irradiance: Any, positions: Any = None, *, depth: Any = None, ids: Any = None,
                out: Optional[NDArray[np.float32]] = None,
                params: Optional[ScatterParams] = None) -> NDArray[np.float32]:
        """Scattered irradiance.

        Parameters
        ----------
        irradiance : (height, width, 3)
            All lights together, shadows sharp, in any layout that Image takes.
        positions : (height, width, 3)
            World.
        depth : (height, width), optional
            Instead of positions, with params.inverse_view_projection.
        ids : (height, width) unsigned integers, optional
            Of materials; nothing flows from one to another; 0 is background. None: everything is 1.
        out : (height, width, 3) float32, optional
            A new array without it; may be the irradiance.
        params : ScatterParams, optional
        """
        result = np.empty(np.shape(irradiance), np.float32) if out is None else out
        self.submit_execute(irradiance, positions, result, depth=depth, ids=ids, params=params).wait()
        return result

    def submit_execute(self, irradiance: Any, positions: Any, out: Any, *, depth: Any = None, ids: Any = None,
                       params: Optional[ScatterParams] = None, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        settings = ScatterParams() if params is None else params
        target = to_image(self.device, out, "out", output=True)
        images = [target if out is irradiance else to_image(self.device, irradiance, "irradiance"),
                  to_image(self.device, positions, "positions"), to_image(self.device, depth, "depth"),
                  to_image(self.device, ids, "ids", ids=True), target]
        given, kept = natives(images), list(self._images.values())
        views = [x._view for x in [*images, *kept] if x is not None]
        return Event(submit(self.device, views, _handles(waits),
                            lambda w: self._handle.execute(settings._data, *given, w), self, kept))

    def stats(self) -> ScatterStats:
        """What the last execution did."""
        return _filled(ScatterStats, self._handle.stats())
