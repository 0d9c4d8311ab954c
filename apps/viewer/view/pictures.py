"""The picture of each mode of the viewer."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import files
from .._show import linear, srgb
from .._types import Scattering
from .look import METHODS, MODES, SKIN, Look
from .passes import OUTPUTS, Pass
from .reference import reference

if TYPE_CHECKING:
    from .renderer import GBuffer
    from .session import Session

LINEAR = linear(np.arange(256) / 255)  # of sRGB bytes
_ENCODED = srgb(np.arange(4096) / 4095)

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)  # of linear sRGB [ITU-R BT.709]
_LINEAR_MODES = ("final", "lambert", "diffuse", "specular", "deep_scatter", "irradiance", "reference",
                 "albedo")
_ID_COLORS = np.array([[0, 0, 0], [.8, .4, .3], [.2, .5, .9], [.9, .9, .5], [.9, .2, .4], [.2, .2, .2],
                       [.2, .8, .9]], np.float32)
_TILE = 16  # pixels a side
# Even steps of the colour scale of all figures, from 0 to 1 (host/io/image/color_map.cpp).
SCALE = ("#001577", "#3a1197", "#681e9d", "#952a99", "#bf388b", "#e44b75", "#ff6a5b", "#ff9960", "#ffc075")
# By method, in the order of METHODS without auto.
TILE_COLORS = {m: c for m, c in zip([m for m in METHODS if m != "auto"], (
    (.45, .45, .45), (.90, .65, .15), (.20, .60, .95), (.15, .80, .45), (.90, .30, .60), (.60, .40, .95)))}


def srgb_bytes(linear: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Light from 0 to 1 as sRGB bytes, by a table of 4096 steps."""
    return _ENCODED[np.minimum(linear * 4095 + 0.5, 4095).astype(np.uint16)]


def false_colors(values: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Values from 0 to 1 in the colours of SCALE, sRGB."""
    stops = np.array([[int(color[i:i + 2], 16) for i in (1, 3, 5)] for color in SCALE], np.float32)
    at = np.linspace(0, 1, len(SCALE))
    return np.stack([np.interp(values, at, stops[:, c]) for c in range(3)], -1).astype(np.uint8)


def histogram(pixels: NDArray[np.uint8], bins: int = 64) -> list[list[int]]:
    """How often each sRGB value is shown, by channel; black pixels are background and do not count."""
    seen = pixels[pixels.any(-1)]
    return [np.bincount(seen[:, c] // (256 // bins), minlength=bins).tolist() for c in range(3)]


def plain(look: Look) -> Look:
    """The same without any scattering."""
    p = look.copy()
    p.method, p.transmission = "none", 0.0
    return p


def chosen_method(p: Pass, look: Look) -> str:
    """The method that skin was shaded by."""
    if look.method != "auto":
        return look.method
    counts = np.array(p.shader.stats().pixels_by_choice)
    counts[Scattering.NONE] = 0  # which kept their irradiance
    return Scattering(int(np.argmax(counts))).name.lower() if counts.any() else "none"


def _spread(mask: NDArray[Any]) -> NDArray[Any]:
    """Padded to whole tiles."""
    height, width = mask.shape
    whole = np.pad(mask, ((0, -height % _TILE), (0, -width % _TILE)))
    any_in = whole.reshape(len(whole) // _TILE, _TILE, -1, _TILE).any((1, 3))
    return any_in.repeat(_TILE, 0).repeat(_TILE, 1)[:height, :width]


def scattered_tiles(session: Session, look: Look, width: int, height: int,
                    small: bool) -> tuple[str, NDArray[Any], Pass, Pass]:
    """The method, (height, width) whether it changed the light of a pixel's tile, and the passes with and
    without scattering."""
    scattered, bare = look.copy(), plain(look)
    scattered.transmission = 0.0
    counting, session.count = session.count, True
    try:
        p = session.shade("tiles", scattered, width, height, small, ("out_diffuse",))
        method = chosen_method(p, look)
        q = session.shade("tiles/plain", bare, width, height, small, ("out_diffuse",))
    finally:
        session.count = counting
    skin = session.gbuffer(width, height, small).material == SKIN
    return method, _spread(skin & (p.outputs["out_diffuse"] != q.outputs["out_diffuse"]).any(2)), p, q


def tiles(session: Session, look: Look, width: int, height: int,
          small: bool) -> tuple[NDArray[np.float32], Pass]:
    """Tiles of 16 x 16 pixels: bright in the colour of the method where it changed the light, dark where all
    of it was kept."""
    method, tapped, p, q = scattered_tiles(session, look, width, height, small)
    material = session.gbuffer(width, height, small).material
    color = np.asarray(TILE_COLORS[method], np.float32)
    shown = np.zeros((height, width, 3), np.float32)
    shown[_spread(material > 0)] = 0.08
    shown[_spread(material == SKIN)] = 0.25 * color
    shown[tapped] = color
    shade = np.clip(q.outputs["radiance"].mean(2, keepdims=True), 0, 1)  # for orientation
    shown *= 0.6 + 0.4 * shade
    shown[::_TILE] *= 0.6
    shown[:, ::_TILE] *= 0.6
    return shown, p


def _of_gbuffer(mode: str, g: GBuffer, mm: float) -> NDArray[Any]:
    if mode == "curvature":
        return np.repeat(np.abs(g.curvature)[..., None] / (0.2 * mm), 3, 2)
    if mode == "normals":
        return np.where(g.material[..., None] > 0, 0.5 + 0.5 * g.normal_shading, 0)
    if mode == "albedo":
        return g.albedo
    return _ID_COLORS[np.minimum(g.material.astype(int), len(_ID_COLORS) - 1)]


def picture(session: Session, name: str, look: Look, width: int, height: int,
            small: bool) -> tuple[NDArray[np.uint8], Pass]:
    """sRGB, (height, width, 3), of the look's mode, and the pass that made it. `name`: of its pass."""
    mode = look.mode
    if mode not in MODES:
        raise ValueError(f"the mode is {mode!r}; it must be one of {', '.join(MODES)}")
    if mode in ("reference", "error") and small and session.report is not None:
        mode = "final"  # while something moves
    elif mode not in ("reference", "error"):
        session.cancel_reference(name)
    shown: NDArray[Any]
    if mode == "tiles":
        shown, p = tiles(session, look, width, height, small)
        return files.tonemap(shown, curve="none"), p
    if mode in ("lambert", "irradiance"):
        p = session.shade(name, plain(look), width, height, small, albedo=mode != "irradiance")
    else:
        p = session.shade(name, look, width, height, small, (OUTPUTS[mode],) if mode in OUTPUTS else ())
    g = session.gbuffer(width, height, small)
    if mode == "difference":
        q = session.shade(name + "/plain", plain(look), width, height, small)
        shown = 0.2 + 4 * (p.outputs["radiance"] - q.outputs["radiance"])
    elif mode in ("reference", "error"):
        shown = reference(session, name, look, width, height, small)
        if mode == "error":
            bare = look.copy()
            bare.specular = 0.0
            q = session.shade(name + "/bare", bare, width, height, small)
            skin = (g.material == SKIN)[..., None]
            shown = 0.2 + 10 * np.where(skin, q.outputs["radiance"] - shown, 0)
    elif mode == "thickness":
        shown = np.repeat(p.outputs["out_thickness"][..., None] * (session.mm / 20), 3, 2)
    elif mode in OUTPUTS:
        shown = p.outputs[OUTPUTS[mode]]
    elif mode == "false_color":
        shown = false_colors(p.outputs["radiance"] @ LUMINANCE / max(look.white, 1e-6))
        shown[g.material == 0] = 0
        return shown, p
    elif mode in ("curvature", "normals", "albedo", "materials"):
        shown = _of_gbuffer(mode, g, session.mm)
    else:
        shown = p.outputs["radiance"]
    if mode in _LINEAR_MODES:
        return files.tonemap(shown, look.exposure, look.shoulder, look.curve), p
    return files.tonemap(shown, curve="none"), p
