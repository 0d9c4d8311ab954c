"""Shading a G-buffer."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _in_flight, _native
from ._arrays import Image, address, submit, to_image
from ._struct import OfThisProcess, to_enum
from ._types import (
    Ambient,
    Camera,
    Eye,
    Format,
    ImageSlot,
    Light,
    LightSlot,
    Material,
    PassMemory,
    PassStats,
    ProgramGroup,
    ShaderOptions,
    ShaderStats,
)
from .device import Buffer, Device, Event, _filled
from .lut import Lut


class Shader(OfThisProcess):
    """Set images, materials and lights, commit, execute. A slot that is not set is a feature that is off.

    Images stay the caller's: the shader reads and writes them where they are at each execution, so changing
    an array in place and executing again shades the new values. One thread at a time uses a shader.
    """

    _instead = "make one there"

    def __init__(self, device: Device) -> None:
        self.device = device
        self._handle = _native.Shader.create(device._handle)
        self._images: dict[Any, Image] = {}

    def set_name(self, name: str) -> Shader:
        """A name for errors and the log."""
        self._handle.set_name(name)
        return self

    def set_image(self, slot: ImageSlot | str, image: Any) -> Shader:
        """Sets one image of the G-buffer.

        Parameters
        ----------
        slot : ImageSlot or str
            Such as "normal_shading"; "radiance" is the output, and those that begin with "out_".
        image : array, pyopencl.array.Array, Image or None
            (height, width[, components]), see Image; None clears the slot.
        """
        s = to_enum(ImageSlot, slot, "slot")
        return self._keep(s, image, s.name.lower(), lambda native: self._handle.set_image(int(s), native),
                          s == ImageSlot.RADIANCE or s.name.startswith("OUT_"), s == ImageSlot.MATERIAL)

    def set_light_image(self, light: int, slot: LightSlot | str, image: Any) -> Shader:
        """Sets or clears the "wide_shadow" (of the G-buffer's size) or "shadow_map" (of any size) of a light.

        "cascade_1" to "cascade_3" are further maps of a light with `shadow_cascades`. A cube map has six
        faces below one another, (6 n, n); maps of moments have two components, (height, width, 2).
        """
        s = to_enum(LightSlot, slot, "slot")
        return self._keep((light, s), image, f"{s.name.lower()} of light {light}",
                          lambda native: self._handle.set_light_image(light, int(s), native))

    def _keep(self, key: Any, image: Any, what: str, use: Any, output: bool = False,
              ids: bool = False) -> Shader:
        for kept in self._images.values():  # an array that is input and output is one image
            span = kept._view.span
            if getattr(span, "array", None) is image and (output or span.output) and image.flags.writeable:
                image = kept
        image = to_image(self.device, image, what, output, ids)
        use(None if image is None else image._view.native)
        if image is None:
            self._images.pop(key, None)
        else:
            if output and hasattr(image._view.span, "output"):
                image._view.span.output = True
            self._images[key] = image
        return self

    def set_material(self, id: int, material: Optional[Material], curvature_lut: Optional[Lut] = None,
                     shadow_lut: Optional[Lut] = None) -> Shader:
        """Sets material `id`, 1 to 255; None removes it. Tables that are not given are made from the
        profile; without one: no direct scattering, a plain shadow."""
        self._handle.set_material(id, None if material is None else Material._bytes_of(material),
                                  None if curvature_lut is None else curvature_lut._handle,
                                  None if shadow_lut is None else shadow_lut._handle)
        return self

    def set_normal_map(self, id: int, levels: Optional[NDArray[Any] | Sequence[NDArray[Any]]]) -> Shader:
        """Sets the tangent-space normal map of material `id`, from which its blurred normals are read.

        Parameters
        ----------
        id : int
            A material that was set. The slots "uv" and "tangent" are needed too, "uv_gradient" if there is
            one.
        levels : array, list of arrays or None
            (height, width, 3) of float32 from -1 to 1, or (height, width, 4) of uint8. One array: the
            smaller levels are made here, by means over 2 x 2 texels. A list: all levels, each half the size
            of the one before. The texels are copied. None removes the map.
        """
        chain = [] if levels is None else _mip_chain(
            levels) if isinstance(levels, np.ndarray) else list(levels)
        if any(a.ndim != 3 or (a.dtype.name, a.shape[2]) != (chain[0].dtype.name, chain[0].shape[2])
               for a in chain):
            raise ValueError("a normal map needs arrays of shape (height, width, 3 or 4), all of one type; "
                             "it has " + ", ".join(f"{a.shape} of {a.dtype}" for a in chain))
        if not chain:
            self._handle.set_normal_map(id, [])
            return self
        key = (chain[0].dtype.name, chain[0].shape[2])
        if key not in (("float32", 3), ("uint8", 4)):
            raise ValueError(f"a normal map has {key[1]} components of {key[0]}, not 3 float32 or 4 uint8")
        buffer = Buffer(self.device, np.concatenate([np.ascontiguousarray(a).reshape(-1) for a in chain]))
        images, offset = [], 0
        for a in chain:
            images.append(Image(self.device, buffer, Format.RGB32F if key[1] == 3 else Format.RGBA8_UNORM,
                                width=a.shape[1], height=a.shape[0], byte_offset=offset))
            offset += a.nbytes
        self._handle.set_normal_map(id, [image._view.native for image in images])
        return self

    def set_scattered_texture(self, id: int, texture: Any) -> Shader:
        """Sets the light that was scattered in the texture of material `id` (TextureScatter.execute).
        Materials with scattering "texture" use it instead of their irradiance.

        Parameters
        ----------
        id : int
            A material that was set. The slot "uv" is needed too.
        texture : array, Image or None
            (height, width, 3 or 4), row 0 at v = 0; repeated beyond [0, 1]. Read at each execution; None
            removes it.
        """
        return self._keep(("scattered_texture", id), texture, f"scattered texture of material {id}",
                          lambda native: self._handle.set_scattered_texture(id, native))

    def set_eye(self, id: int, eye: Optional[Eye], caustics: Optional[Lut] = None) -> Shader:
        """Makes material `id`, which must be set and is the sclera, an eye; None: no eye any longer.

        Parameters
        ----------
        id : int
            A material that was set. Positions or depth, and the camera's position are needed too.
        eye : Eye or None
        caustics : Lut, optional
            Lut.eye; without it the table is made for this eye.
        """
        self._handle.set_eye(id, None if eye is None else Eye._bytes_of(eye),
                             None if caustics is None else caustics._handle)
        return self

    def set_iris_texture(self, id: int, texture: Any) -> Shader:
        """Sets the albedo of the iris of the eye `id`.

        Parameters
        ----------
        id : int
            A material that is an eye.
        texture : array, Image or None
            (n, n, 3 or 4), whose inscribed circle is the iris' rim, row 0 at Eye.up, as seen by a viewer who
            faces the eye. Read by the first execution after a commit; None removes it: fibres are drawn by
            Eye.iris_seed.
        """
        return self._keep(("iris_texture", id), texture, f"iris texture of material {id}",
                          lambda native: self._handle.set_iris_texture(id, native))

    def set_lights(self, lights: Light | Sequence[Light]) -> Shader:
        """Replaces all lights, 0 to 64, or sets a single one; images of lights beyond the count are cleared.
        """
        lights = [lights] if isinstance(lights, Light) else list(lights)
        packed = np.array([Light._bytes_of(light)[0] for light in lights], Light._dtype)
        self._handle.set_lights(packed.ctypes.data, len(packed))
        for key in [k for k in self._images if isinstance(k, tuple) and isinstance(k[0], int)
                    and k[0] >= len(lights)]:
            del self._images[key]
        return self

    def set_ambient(self, ambient: Ambient) -> Shader:
        """Sets the light from everywhere."""
        self._handle.set_ambient(Ambient._bytes_of(ambient))
        return self

    def set_ambient_cube(self, faces: Any) -> Shader:
        """Sets an irradiance cube map, whose light is added to that of `set_ambient`.

        Parameters
        ----------
        faces : array, Image or None
            Irradiance / pi: (6, n, n, 3 or 4), or those faces one below the other, (6 n, n, 3 or 4), or side
            by side, (n, 6 n, 3 or 4); float16, float32, or uint8 with 4 components. +x, -x, +y, -y, +z, -z,
            oriented as in OpenGL and Direct3D: to the right and down, +x runs along -z and -y, -x along z
            and -y, +y along x and z, -y along x and -z, +z along x and -y, -z along -x and -y. Read at each
            execution. None removes it.
        """
        return self._keep("ambient_cube", _below(faces, "ambient"), "ambient_cube",
                          self._handle.set_ambient_cube)

    def set_reflection_cube(self, faces: Any) -> Shader:
        """Sets the surroundings that eyes reflect: radiance / pi, six faces as for `set_ambient_cube`, as
        sharp as the film of tears should show them. Read at each execution. None removes it."""
        return self._keep("reflection_cube", _below(faces, "reflection"), "reflection_cube",
                          self._handle.set_reflection_cube)

    def set_environment(self, image: Any, axes: Any = None) -> Shader:
        """Sets the surroundings as light: ambient light, specular light, and reflections in eyes.

        Parameters
        ----------
        image : array, Image or None
            Radiance: equirectangular, (n, 2 n, 3 or 4), the upper row +y, the middle column +z, +x to the
            left of it; or six faces as for `set_ambient_cube`. Read at the first execution after the next
            commit. None removes it.
        axes : array, (3, 3), optional
            Rows: the image's x, y and z axis in the world; without it the world's.

        Raises
        ------
        PellucidError
            An image of another shape; axes that are not unit vectors at right angles.
        """
        rows = None if axes is None else np.ascontiguousarray(axes, np.float32).reshape(9)
        return self._keep("environment", _below(image, "environment"), "environment",
                          lambda view: self._handle.set_environment(view, address(rows)))

    def set_camera(self, camera: Camera) -> Shader:
        """Sets the viewpoint, which specular and depth images need."""
        self._handle.set_camera(Camera._bytes_of(camera))
        return self

    def set_options(self, options: Optional[ShaderOptions] = None, **fields: Any) -> Shader:
        """Sets the options, or the defaults with some `fields` of them changed."""
        self._handle.set_options(ShaderOptions._with(options, fields)._data)
        return self

    def commit(self) -> Shader:
        """Checks that everything fits together, derives the features and builds their programs.

        Raises
        ------
        PellucidError
            Something is missing or does not fit.
        """
        _in_flight.interruptible(self._handle.commit)  # compilers take seconds, on some devices minutes
        return self

    def execute(self) -> None:
        """Shades, and waits for the result.

        A progress callback of the device (Device.set_progress) is called about every million
        pixels; cancelled by it, some pixels are shaded and others not.

        Raises
        ------
        PellucidError
            INVALID_STATE when something was set after the last commit; CANCELLED by a progress callback.
        """
        if self.device._handle.progress is None:
            self.submit().wait()
            return
        event = submit(self.device, [], [], lambda _: self._handle.execute_blocking(), self,
                       moved=self._images.values())
        if event is not None:  # results are on their way back to the arrays
            event.wait()

    def submit(self, waits: Iterable[Event] = ()) -> Event:
        """Shades after `waits`, without waiting: leave the images alone until the event is done."""
        return submit(self.device, [], waits, self._handle.execute, self, moved=self._images.values())

    def material(self, id: int) -> Material:
        """Material `id` as it is shaded: with the values of all defaults, and after a commit also of AUTO.
        Its profile is left out."""
        material = _filled(Material, self._handle.material(id))
        material._data["profile"] = 0  # the shader's own, which the structure would outlive
        return material

    def warnings(self) -> list[str]:
        """Warnings of the last commit about settings without effect or with unlikely values."""
        return self._handle.warnings().splitlines()

    def stats(self) -> ShaderStats:
        """What the last execution did."""
        self.device.finish()
        return _filled(ShaderStats, self._handle.stats())

    def passes(self) -> list[PassStats]:
        """The passes that launched something in the newest execution that has finished, without a wait."""
        return [_filled(PassStats, data) for data in self._handle.passes()]

    def memory(self) -> list[PassMemory]:
        """The device memory that each pass holds besides the arrays, and the memory that it will hold once
        the current settings are committed. Nothing is committed, and no image is allocated.

        Raises
        ------
        PellucidError
            Those of `commit`.
        """
        return [_filled(PassMemory, data) for data in self._handle.memory()]


def warm_up_programs(device: Device, groups: ProgramGroup | int = 0, shaders: Sequence[Shader] = (),
                     threads: int = 0) -> int:
    """Builds OpenCL programs before they are needed, so that no commit or execution waits for a compiler.

    The driver's own cache on disk, if it has one, keeps the result. A progress callback of the device
    (Device.set_progress) is called on the way; if it cancels, the programs built so far are kept.

    Parameters
    ----------
    device : Device
        Whose programs.
    groups : ProgramGroup
        Programs that do not depend on a G-buffer, such as ``ProgramGroup.LUTS | ProgramGroup.CURVATURE``.
    shaders : sequence of Shader
        With images, materials and lights set as for a commit. Nothing of theirs is written, and only the
        formats and packing of images matter: 16 x 1 pixels stand for a frame.
    threads : int
        That build at a time; 0: one per core. PoCL builds one by one.

    Returns
    -------
    int
        How many programs were not there before.

    Raises
    ------
    PellucidError
        The errors of a shader's commit; CANCELLED.
    """
    handles = [s._handle for s in shaders]
    return int(_in_flight.interruptible(
        lambda: _native.warm_up_programs(device._handle, int(groups), handles, threads)))


def _below(faces: Any, which: str) -> Any:
    """Six faces (6, n, n, c) one below the other; anything else as it is."""
    if getattr(faces, "ndim", 0) != 4:
        return faces
    if faces.shape[0] != 6:
        raise ValueError(f"the {which} cube has the shape {faces.shape}, not six faces, (6, n, n, 3 or 4)")
    faces = faces.view()
    try:
        faces.shape = (6 * faces.shape[1], *faces.shape[2:])
    except AttributeError:
        raise ValueError(f"the {which} cube's faces lie apart; pass numpy.ascontiguousarray(faces)") from None
    return faces


def _mip_chain(image: NDArray[Any]) -> list[NDArray[Any]]:
    """An image and its halves down to one texel, each a mean over 2 x 2 (the last of an odd side over 3)."""
    chain = [image]
    while max(chain[-1].shape[:2]) > 1:
        level = chain[-1].astype(np.float64)
        for axis in (0, 1):
            size = level.shape[axis]
            if size > 1:
                starts = np.arange(0, size - 1, 2)
                counts = np.diff(np.append(starts, size)).reshape([-1 if a == axis else 1 for a in range(3)])
                level = np.add.reduceat(level, starts, axis) / counts
        chain.append(np.rint(level).astype(image.dtype) if image.dtype.kind == "u"
                     else level.astype(image.dtype))
    return chain
