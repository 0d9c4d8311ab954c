"""Meshes and images from files, and pictures to look at.

A module of its own: it needs the package built where OpenMesh, OpenEXR and OpenImageIO are installed
(Debian: libopenmesh-dev, libopenexr-dev, libopenimageio-dev).
"""
from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._command import program
from .profile import Profile

try:
    from . import _files
except ImportError as error:
    raise ImportError("this build of pellucid reads no files: install libopenmesh-dev, libopenexr-dev, "
                      "libopenimageio-dev and libtomlplusplus-dev "
                      f"(or their equivalents) and build the package again ({error})") from error

FileError = _files.FileError


@dataclass
class Mesh:
    """Triangles, and the attributes of their vertices. Lengths are those of the file."""

    positions: NDArray[np.float32]                     # (n, 3)
    normals: NDArray[np.float32]                       # (n, 3), unit
    triangles: NDArray[np.uint32]                      # (m, 3)
    uvs: Optional[NDArray[np.float32]] = None          # (n, 2)
    ids: Optional[NDArray[np.uint32]] = None           # (n,), of materials; None: all 1
    albedo: Optional[NDArray[np.float32]] = None       # (n, 3), linear
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)   # unit, towards the crown of a head
    front: tuple[float, float, float] = (0.0, -1.0, 0.0)
    low: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of the box to be shown
    high: tuple[float, float, float] = (0.0, 0.0, 0.0)
    eyes: list[dict[str, Any]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    source: str = ""


def standard_head(which: str = "female") -> Path:
    """The OBJ file of one of the two heads that come with the package, "female" or "male"."""
    for folder in (Path(__file__).parent / "heads", *(p / "data/heads" for p in Path(__file__).parents)):
        if (folder / f"head_{which}.obj").exists():
            return folder / f"head_{which}.obj"
    raise FileNotFoundError(f"the head {which!r} did not come with the package; name a mesh file")


_MOST_LEVELS = 6  # of subdivision: each makes four times as many triangles


def load_mesh(path: Any, subdivide: Optional[int] = None, up: str = "auto") -> Mesh:
    """Reads an OFF, OBJ, PLY or STL file.

    At a seam of the texture coordinates of an OBJ file, vertices are duplicated, once for each side. A mesh
    that Loop's scheme subdivides has no texture coordinates then; the heads of the package keep theirs.

    Parameters
    ----------
    path : str or path
    subdivide : int, optional
        Levels of subdivision, 0 to 6: Catmull-Clark for the heads of the package (2), Loop for other meshes
        (0).
    up : str
        "y", "z", or "auto": y for OBJ files, z for the others.

    Raises
    ------
    FileError
        A file that is missing or damaged; the message names the line where there is one.
    """
    if up not in ("auto", "y", "z"):
        raise ValueError(f"up is {up!r}; it must be 'auto', 'y' or 'z'")
    if subdivide is not None and not 0 <= subdivide <= _MOST_LEVELS:
        raise ValueError(f"subdivide is {subdivide}; it must be from 0 to {_MOST_LEVELS}")
    name = str(path)
    head = _files.load_head(name,
                            2 if subdivide is None else subdivide) if name.lower().endswith(".obj") else None
    if head is not None:
        return Mesh(**{k: tuple(v) if k in ("up", "front", "low", "high") else v for k, v in head.items()},
                    source=name)
    arrays = _files.load_mesh(name, subdivide or 0)
    return _framed(arrays, up == "y" or (up == "auto" and name.lower().endswith(".obj")), name)


def _framed(arrays: dict[str, Any], y_up: bool, source: str) -> Mesh:
    """A mesh that is shown with all of its triangles."""
    used = arrays["positions"][np.unique(arrays["triangles"])]
    up, front = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)) if y_up else ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
    return Mesh(**arrays, up=up, front=front, low=tuple(map(float, used.min(0))),
                high=tuple(map(float, used.max(0))), source=source)


def _profile(of_files: Any) -> Profile:
    return Profile._made(_native.Profile.of_address(of_files.address()))


def load_profile(path: Any) -> Profile:
    """Reads a profile file (TOML; docs/guide/profiles.md), or one of the library by name; lengths become mm.

    Raises
    ------
    FileError
        A file that is missing or wrong; the message names the line.
    """
    return _profile(_files.load_profile(str(path)))


def read_image(path: Any) -> dict[str, NDArray[np.float32]]:
    """The channels of an EXR, PNG, JPEG, TGA or BMP file by their full names, (height, width) each; integers
    come as 0 to 1."""
    return dict(_files.read_image(str(path)))


def reference(mesh: Any, scene: Any, gbuffer: Any, *, walk: bool = False, samples: int = 64,
              noise: Optional[float] = None, seed: int = 1,
              reflectance: Optional[Sequence[float]] = None, boundary: str = "index-matched",
              profile: Any = None,
              subdivide: int = 0, parts: Sequence[str] = ()) -> dict[str, NDArray[np.float32]]:
    """The ground truth of a picture, by `pellucid reference` (docs/guide/reference.md). Ctrl-C cancels it.

    Parameters
    ----------
    mesh, scene, gbuffer : str or path
        Files, as for the command.
    walk : bool
        A random walk through the volume, instead of the surface integral.
    samples, noise, seed, reflectance, boundary
        Of the walk. `noise`, if given, determines the number of samples. Reflectance and boundary of skin
        follow from its pigments.
    profile : str or path, optional
        Instead of the material's.
    parts : sequence of str
        Groups of an OBJ file that scatter.

    Returns
    -------
    dict
        Layers by name, (height, width) each: "R", "Surface.R", "Irradiance.R", and of a walk "First.R",
        "Second.R", "MeanFreePath.R", "MeanCurvature", "Thickness".

    Raises
    ------
    FileError
        With the message of the command.
    FileNotFoundError
        The package was built without the command.
    """
    if not program().exists():
        raise FileNotFoundError(f"{program()}: the package was built without the command")
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "reference.exr")
        command = [str(program()), "reference", str(mesh), "--scene", str(scene), "--gbuffer", str(gbuffer),
                   "-o", out,
                   "--subdivide", str(subdivide)]
        if profile is not None:
            command += ["--profile", str(profile)]
        for part in parts:
            command += ["--part", part]
        if walk:
            command += ["--walk", "--seed", str(seed), "--boundary", boundary]
            command += ["--samples", str(samples)] if noise is None else ["--noise", str(noise)]
            if reflectance is not None:
                command += ["--reflectance", *(str(float(value)) for value in reflectance)]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise FileError(result.stderr.strip())
        return read_image(out)


def write_image(path: Any, image: ArrayLike, *, exposure: float = 1.0, shoulder: float = 0.8,
                curve: str = "soft", half: bool = False, channels: Optional[list[str]] = None) -> None:
    """Writes linear radiance, complete or not at all.

    Parameters
    ----------
    path : str or path
        .exr: the numbers as they are. .png, .tga, .bmp: a picture to look at, as `tonemap` makes it.
    image : (height, width, 3) floats, or (height, width, n) for EXR
        uint8 of 1, 3 or 4 channels is written to .png, .tga and .bmp as it is.
    channels : list of str, optional
        Names for EXR; "R", "G", "B" for three, "Y" for one.
    """
    name, pixels = str(path), np.asarray(image)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.ndim != 3:
        raise ValueError(f"the image has the shape {pixels.shape}; (height, width, channels) is needed")
    if name.lower().endswith(".exr"):
        names = channels or {1: ["Y"], 3: ["R", "G", "B"], 4: ["R", "G", "B", "A"]}.get(pixels.shape[2])
        if names is None or len(names) != pixels.shape[2]:
            raise ValueError(f"{pixels.shape[2]} channels need as many names")
        _files.write_exr(name, names, pixels, half)
    else:
        shown = pixels if pixels.dtype == np.uint8 else tonemap(pixels, exposure, shoulder, curve)
        _files.write_bytes(name, np.ascontiguousarray(shown))


def tonemap(radiance: ArrayLike, exposure: float = 1.0, shoulder: float = 0.8,
            curve: str = "soft") -> NDArray[np.uint8]:
    """Linear RGB, (..., 3), to sRGB bytes.

    curve : str
        "soft": proportional to radiance up to `shoulder`, then towards white; "none": cut at 1; "filmic"
        [Hable 2010]; "agx-like" [after Sobotka 2022]. NaN is black.
    """
    return np.asarray(_files.tone_mapped(np.asarray(radiance, np.float32), exposure, shoulder, curve))
