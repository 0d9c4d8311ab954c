"""Writes what is shown as files: a G-buffer and a scene that `pellucid shade` renders to the same bits,
pictures, the look, C++."""
from __future__ import annotations

import json
import re
from collections.abc import Iterable
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Ambient, Camera, ShaderOptions
from ..files import _files, write_image
from .look import SKIN, Look
from .passes import tinted
from .session import Session

CHANNELS = {"material": ("Id", "I"), "position": ("Position", "XYZ"),
            "normal_geometric": ("NormalGeometric", "XYZ"), "normal_shading": ("NormalShading", "XYZ"),
            "curvature": ("Curvature", "V"), "albedo": ("Albedo", "RGB"), "uv": ("Uv", "XY")}
# What the C++ sets.
MATERIAL_KEYS = ("scattering", "specular", "roughness", "f0", "specular_model", "roughness2", "lobe_mix",
                 "shadow_filter_width")
PROFILE_KEYS = ("transmission", "diffusion_radius", "deep_scatter_color")  # of materials with a profile
OPTIONAL = ("shadow_filter_width", "deep_scatter_color")  # left out at 0
ENUMERATORS = {"scattering": "SCATTERING", "specular_model": "SPECULAR"}
EYE_KEYS = ("center", "gaze", "up", "sclera_radius", "cornea_radius", "limbus_radius", "limbus_width",
            "limbus_darkening", "chamber_depth", "pupil_radius", "iris_concavity", "iris_color", "iris_seed",
            "tear_roughness")


def write_scene(path: Path, session: Session, look: Look, width: int, height: int) -> None:
    """The scene file of the picture; floats keep their bits."""
    eye, _ = session.camera(width / height)
    channels = {key: [f"{name}.{c}" for c in components] for key, (name, components) in CHANNELS.items()
                if key != "uv" or look.method == "texture"}
    options = ShaderOptions(target_error=look.target_error, millimetres_per_unit=session.mm)
    profile = "profile.toml" if look.profile == "custom" else look.profile
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
        Camera(position=eye)._data.tobytes(), options._data.tobytes())


def profile_text(look: Look) -> str:
    """The profile file of the look's own profile."""
    return ('name = "custom"\nkind = "burley"\nunit = "mm"\nsource = "made in the viewer"\n'
            f"distance = {[float(np.float32(d)) for d in look.distance]}\n")


def cpp_float(value: float) -> str:
    """A literal with the bits of the value as a float."""
    text = f"{float(np.float32(value)):.9g}"
    return text + ("f" if "." in text or "e" in text else ".0f")


def _cpp(variable: str, struct: Any, keys: Iterable[str]) -> list[str]:
    """Assignments of these fields."""
    lines = []
    for key in keys:
        value, name = getattr(struct, key), variable + "." + re.sub("_(.)", lambda m: m[1].upper(), key)
        if isinstance(value, IntEnum):
            lines.append(f"{name} = PEL_{ENUMERATORS[key]}_{value.name};")
        elif np.ndim(value):
            lines.append(" ".join(f"{name}[{c}] = {cpp_float(v)};" for c, v in enumerate(value)))
        else:
            lines.append(f"{name} = {value if isinstance(value, int) else cpp_float(value)};")
    return lines


def snippet(session: Session, look: Look) -> str:
    """C++ that sets the same material and lights; images are the host's."""
    materials = session.materials(look)
    skin, keys = materials[SKIN], list(MATERIAL_KEYS)
    lines = ["PelMaterial skin = pelMaterialDefaults();"]
    if skin.profile is not None:
        made = f"named({json.dumps(look.profile)})"
        if look.profile == "custom":
            made = "burleyDistance({" + ", ".join(cpp_float(d) for d in look.distance) + "})"
        lines = [f"const pellucid::Profile profile = pellucid::Profile::{made};  // mm", *lines,
                 "skin.profile = profile.get();"]
        keys += PROFILE_KEYS
    lines += [*_cpp("skin", skin, [k for k in keys if k not in OPTIONAL or np.any(getattr(skin, k))]),
              "shader.setMaterial(1, skin);"]
    for id, eye in session.eyes(look).items():
        lines += ["{", "PelMaterial sclera = pelMaterialDefaults();",
                  *_cpp("sclera", materials[id], ("scattering", "specular", "shadow_filter_width")),
                  f"shader.setMaterial({id}, sclera);", "PelEye eye = pelEyeDefaults();",
                  *_cpp("eye", eye, EYE_KEYS)]
        if look.iris_profile:
            lines += [f"const pellucid::Profile iris = "
                      f"pellucid::Profile::named({json.dumps(look.iris_profile)});",
                      "eye.irisProfile = iris.get();"]
        lines += [f"shader.setEye({id}, eye);", "}"]
    lines += ["PelAmbient ambient = pelAmbientDefaults();",
              f"for (float& c : ambient.constant) c = {cpp_float(session.ambient(look))};",
              "shader.set(ambient);",
              "std::vector<PelLight> lights;"]
    for light, _ in session.lights(look):
        lines += ["{", "PelLight light = pelLightDefaults();", *_cpp("light", light, ("to_light", "color")),
                  "lights.push_back(light);", "}"]
    lines += ["shader.set(lights);", "PelShaderOptions options = pelShaderOptionsDefaults();",
              f"options.targetError = {cpp_float(look.target_error)};",
              f"options.millimetresPerUnit = {cpp_float(session.mm)};", "shader.set(options);"]
    depth, body = 1, ""
    for line in lines:
        depth -= line == "}"
        body += "    " * depth + line + "\n"
        depth += line == "{"
    return ("#include <pellucid/pellucid.hpp>\n#include <vector>\n\n"
            f"void setLook(pellucid::Shader& shader) {{\n{body}}}\n")


def export(session: Session, folder: Any, width: int = 1280, height: int = 720) -> list[Path]:
    """Writes scene.toml, gbuffer.exr, shadow_N.exr, picture.png, picture.exr, look.json and look.cpp into
    `folder`.

    ``pellucid shade gbuffer.exr --scene scene.toml -o again.exr`` there gives picture.exr again.
    """
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    look = session.look.copy()
    mode, session.look.mode = session.look.mode, "final"
    try:
        radiance = session.radiance(look, width, height)
        g = session.gbuffer(width, height)
        images = {"material": g.material[..., None], "position": g.position,
                  "normal_geometric": g.normal_geometric, "normal_shading": g.normal_shading,
                  "curvature": g.curvature[..., None], "albedo": tinted(g, look)}
        if look.method == "texture":
            images["uv"] = np.stack([g.u, g.v], 2)
            write_image(out / "scattered.exr", session.texture(look).light)
        names = [f"{CHANNELS[key][0]}.{c}" for key in images for c in CHANNELS[key][1]]
        values = np.concatenate(list(images.values()), 2)
        write_image(out / "gbuffer.exr", values, channels=names)
        for i, (_, map) in enumerate(session.lights(look)):
            if map is not None:
                write_image(out / f"shadow_{i}.exr", map.depth, channels=["Z"])
        iris = session.iris(look)
        if iris is not None:
            write_image(out / "iris.exr", iris)
            look.iris_texture = "iris.exr"
        write_image(out / "picture.exr", radiance)
        write_image(out / "picture.png", radiance, exposure=look.exposure, shoulder=look.shoulder,
                    curve=look.curve)
        texts = {"look.json": json.dumps(look.to_dict(), indent=2) + "\n",
                 "look.cpp": snippet(session, look)}
        if look.profile == "custom":
            texts["profile.toml"] = profile_text(look)
        for name, text in texts.items():
            (out / name).write_text(text, encoding="utf-8")
        write_scene(out / "scene.toml", session, look, width, height)
    finally:
        session.look.mode = mode
    return sorted(out.iterdir())
