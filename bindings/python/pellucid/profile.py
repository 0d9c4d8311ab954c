"""Diffusion profiles."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _show
from ._errors import PellucidError
from ._struct import OfThisProcess, did_you_mean, to_enum
from ._types import BurleyFit, ProfileInfo, Skin
from .device import _filled


def _triple(value: ArrayLike, what: str) -> NDArray[np.float32]:
    numbers = np.asarray(value, np.float64)
    if numbers.shape not in ((), (3,)):
        raise ValueError(f"{what} has the shape {numbers.shape}; one number or three (RGB) are needed")
    return np.ascontiguousarray(np.broadcast_to(numbers, 3), np.float32)


class Profile(OfThisProcess):
    """How much of the light that enters at one point leaves at a distance, per RGB channel.

    Made by `named`, `skin`, `gaussians`, `burley`, `burley_distance`, `dipole` or `table`; belongs to no
    device and never changes. Lengths are in any one unit. Each channel is normalised. `name` is what tables
    and their files carry, up to 63 bytes.
    """

    _instead = "make one there"

    _handle: _native.Profile

    def __init__(self) -> None:
        raise TypeError("make a profile by Profile.skin, gaussians, burley, dipole or table")

    @classmethod
    def _made(cls, handle: _native.Profile) -> Profile:
        self = cls.__new__(cls)
        self._handle = handle
        return self

    @classmethod
    def _named(cls, name: str, create: Any, *arguments: Any) -> Profile:
        """Arrays are passed by their addresses."""
        handle = create(*(a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments))
        if name:
            handle.set_name(name)
        return cls._made(handle)

    @classmethod
    def skin(cls, name: str = "") -> Profile:
        """Six Gaussians in mm [d'Eon and Luebke, GPU Gems 3, ch. 14]."""
        return cls._named(name, _native.Profile.skin)

    @classmethod
    def gaussians(cls, terms: Sequence[tuple[float, ArrayLike]], name: str = "") -> Profile:
        """1 to 256 pairs of a variance (length², > 0) and a weight (one number or RGB, >= 0)."""
        rows = np.array([[v, *_triple(w, "a weight")] for v, w in terms], np.float32).reshape(-1, 4)
        return cls._named(name, _native.Profile.gaussians, rows, len(rows))

    @classmethod
    def burley(cls, mean_free_path: ArrayLike, albedo: ArrayLike,
               fit: BurleyFit | str = BurleyFit.DIFFUSE_TRANSMISSION, name: str = "") -> Profile:
        """From mean free paths (length, > 0) and albedos in [0, 1] [Christensen and Burley 2015]."""
        return cls._named(name, _native.Profile.burley, _triple(mean_free_path, "mean_free_path"),
                          _triple(albedo, "albedo"), int(to_enum(BurleyFit, fit, "fit")))

    @classmethod
    def burley_distance(cls, distance: ArrayLike, name: str = "") -> Profile:
        """The same from the profile's own length d (> 0), which other programs use."""
        return cls._named(name, _native.Profile.burley_distance, _triple(distance, "distance"))

    @classmethod
    def skin_layers(cls, skin: Optional[Skin] = None, name: str = "", **fields: Any) -> Profile:
        """Skin computed from its pigments, in mm: Skin(melanin=0.05, blood=0.02, ...)."""
        return cls._named(name, _native.Profile.skin_layers, Skin._with(skin, fields)._data.data)

    @classmethod
    def named(cls, material: str) -> Profile:
        """A material of the library, in mm: "skin", "marble", ...; `library_names` lists them."""
        try:
            return cls._made(_native.Profile.named(material))
        except PellucidError as error:
            near = did_you_mean(material, cls.library_names())
            if "did you mean" in str(error) or not near:
                raise
            raise PellucidError(int(error.code), f"{error}{near}") from None

    @staticmethod
    def library_names() -> list[str]:
        """The names of the library's materials."""
        return list(_native.Profile.library_names())

    @classmethod
    def dipole(cls, absorption: ArrayLike, reduced_scattering: ArrayLike, eta: float = 1.3,
               name: str = "") -> Profile:
        """The classical dipole from coefficients > 0 in 1/length and an index > 1 [Jensen et al. 2001]."""
        return cls._named(name, _native.Profile.dipole, _triple(absorption, "absorption"),
                          _triple(reduced_scattering, "reduced_scattering"), eta)

    @classmethod
    def table(cls, distances: ArrayLike, values: ArrayLike, name: str = "") -> Profile:
        """Measured R: (n,) rising distances and (n, 3) values, up to a factor; 2 to 4096 of them."""
        d = np.ascontiguousarray(distances, np.float32)
        r = np.ascontiguousarray(values, np.float32)
        if d.ndim != 1 or r.shape != (len(d), 3):
            raise ValueError(f"distances have the shape {d.shape} and values {r.shape}; not (n,) and (n, 3)")
        return cls._named(name, _native.Profile.table, d, r, len(d))

    @property
    def info(self) -> ProfileInfo:
        """Radius, widths, normal blend factors."""
        return _filled(ProfileInfo, self._handle.info())

    def transmission(self, distances: ArrayLike) -> NDArray[np.float64]:
        """The light that a slab lit evenly on its far side lets through, (n, 3), at n thicknesses >= 0."""
        d = np.ascontiguousarray(distances, np.float64).ravel()
        through = np.empty((len(d), 3))
        self._handle.transmission(d.ctypes.data, len(d), through.ctypes.data)
        return through

    def evaluate(self, distances: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """R (energy per area) and P (energy per length), (n, 3) each, at n distances > 0."""
        d = np.ascontiguousarray(distances, np.float64).ravel()
        radial, spread = np.empty((len(d), 3)), np.empty((len(d), 3))
        self._handle.evaluate(d.ctypes.data, len(d), radial.ctypes.data, spread.ctypes.data)
        return radial, spread

    def __repr__(self) -> str:
        info = self.info
        kind = info.kind.name.lower()
        return f"<pellucid.Profile {info.name or 'unnamed'}: {kind}, radius {info.radius:.4g}>"

    def plot(self, ax: Optional[Any] = None) -> Any:
        """Shows the light per distance, 2 pi r R(r), by channel; returns matplotlib's axes (`ax`, or new)."""
        ax = _show.axes(ax)
        distances = np.linspace(1e-3, 0.6, 300) * self.info.reach
        radial, _ = self.evaluate(distances)
        for c, name in enumerate(("red", "green", "blue")):
            ax.plot(distances, 2 * np.pi * distances * radial[:, c], color=name, label=name)
        ax.set_xlabel("distance (mm for profiles of the library)")
        ax.set_ylabel("light per distance")
        ax.set_title(self.info.name)
        ax.legend()
        return ax

    def _repr_png_(self) -> Optional[bytes]:
        try:
            figure = self.plot().figure
        except ImportError:
            return None
        import io

        data = io.BytesIO()
        figure.savefig(data, format="png", dpi=90)
        return data.getvalue()


def as_profile(value: Any, what: str = "profile") -> Optional[Profile]:
    """A profile, one of the library by its name, or None."""
    profile = Profile.named(value) if isinstance(value, str) else value
    if profile is not None and not isinstance(profile, Profile):
        raise ValueError(f"{what} is {value!r}; it must be a Profile or the name of one of the library")
    return profile
