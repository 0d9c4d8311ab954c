"""Writes what is shown: a G-buffer and a scene that `pellucid shade` renders alike, pictures, the look."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Ambient, Camera, ShaderOptions
from ..files import _files, write_image
from .look import PIGMENTS, SKIN, Look
from .passes import tinted
from .session import Session
from .surroundings import STUDIO

CHANNELS = {"material": ("Id", "I"), "position": ("Position", "XYZ"),
            "normal_geometric": ("NormalGeometric", "XYZ"), "normal_shading": ("NormalShading", "XYZ"),
            "curvature": ("Curvature", "V"), "albedo": ("Albedo", "RGB"), "uv": ("Uv", "XY")}


def write_scene(path: Path, session: Session, look: Look, width: int, height: int) -> None:
    """The scene file of the picture; floats keep their bits."""
    eye, _ = session.camera(width / height)
    channels = {key: [f"{name}.{c}" for c in components] for key, (name, components) in CHANNELS.items()
                if key != "uv" or look.method == "texture"}
    around = session.surroundings(look)
    options = ShaderOptions(target_error=look.target_error, millimetres_per_unit=session.mm)
    profile = "profile.toml" if look.profile in ("custom", "pigments") else look.profile
    _files.write_scene(
        str(path), channels,
        [(id, m._data.tobytes(), profile if m.profile else "",
          "scattered.exr" if look.method == "texture" and id == SKIN else "")
         for id, m in session.materials(look).items()],
        [(light._data.tobytes(), "" if map is None else f"shadow_{i}.exr")
         for i, (light, map) in enumerate(session.lights(look))],
        [(id, eye._data.tobytes(), "iris.exr" if look.iris_texture else "", look.iris_profile)
         for id, eye in session.eyes(look).items()],
        Ambient(constant=[session.ambient(look)] * 3)._data.tobytes(),
        Camera(position=eye)._data.tobytes(), options._data.tobytes(),
        "surroundings.exr" if around else "", [] if around is None else around[1].reshape(9).tolist())


def profile_text(look: Look) -> str:
    """The profile file of the look's own profile."""
    if look.profile == "pigments":
        values = "".join(f"{name} = {float(np.float32(getattr(look, name)))}\n" for name in PIGMENTS)
        return f'name = "pigments"\nkind = "skin"\nsource = "made in the viewer"\n{values}'
    return ('name = "custom"\nkind = "burley"\nunit = "mm"\nsource = "made in the viewer"\n'
            f"distance = {[float(np.float32(d)) for d in look.distance]}\n")


def export(session: Session, folder: Any, width: int = 1280, height: int = 720,
           pictures_only: bool = False) -> list[Path]:
    """Writes scene.toml, gbuffer.exr, shadow_N.exr, picture.png, picture.exr and look.json into `folder`.

    ``pellucid shade gbuffer.exr --scene scene.toml -o again.exr`` there gives picture.exr again.
    `pictures_only` leaves the EXR files out.
    """
    with session.complete():
        return _export(session.still(), Path(folder), width, height, pictures_only)


def _export(session: Session, out: Path, width: int, height: int, pictures_only: bool) -> list[Path]:
    out.mkdir(parents=True, exist_ok=True)
    look, shown = session.look.copy(), session.look.copy()  # `shown`: with the names of files in the folder
    session.look.mode = "final"
    images: dict[str, Any] = {}
    radiance = images["picture.exr"] = session.radiance(look, width, height)
    g = session.gbuffer(width, height)
    slots = {"material": g.material[..., None], "position": g.position,
             "normal_geometric": g.normal_geometric, "normal_shading": g.normal_shading,
             "curvature": g.curvature[..., None], "albedo": tinted(g, look)}
    if look.method == "texture":
        slots["uv"] = np.stack([g.u, g.v], 2)
        images["scattered.exr"] = session.texture(look).light
    for i, (_, map) in enumerate(session.lights(look)):
        if map is not None:
            images[f"shadow_{i}.exr"] = map.depth
    iris = session.iris(look)
    if iris is not None:
        images["iris.exr"], shown.iris_texture = iris, "iris.exr"
    around = session.surroundings(look)
    if around is not None:
        images["surroundings.exr"] = around[0]
        if look.surroundings != STUDIO:
            shown.surroundings, shown.surroundings_light = "surroundings.exr", 1.0
    if not pictures_only:
        names = [f"{CHANNELS[key][0]}.{c}" for key in slots for c in CHANNELS[key][1]]
        write_image(out / "gbuffer.exr", np.concatenate(list(slots.values()), 2), channels=names)
        for name, image in images.items():
            write_image(out / name, image, channels=["Z"] if name.startswith("shadow") else None)
    write_image(out / "picture.png", radiance, exposure=look.exposure, shoulder=look.shoulder,
                curve=look.curve)
    texts = {"look.json": json.dumps(shown.to_dict(), indent=2) + "\n"}
    if look.profile in ("custom", "pigments"):
        texts["profile.toml"] = profile_text(look)
    for name, text in texts.items():
        (out / name).write_text(text, encoding="utf-8")
    write_scene(out / "scene.toml", session, look, width, height)
    return sorted(out.iterdir())
