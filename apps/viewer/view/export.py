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

from ..files import write_image
from .look import SKIN, Look
from .passes import tinted
from .session import Session

CHANNELS = {"material": ("Id", "I"), "position": ("Position", "XYZ"),
            "normal_geometric": ("NormalGeometric", "XYZ"),
            "normal_shading": ("NormalShading", "XYZ"), "curvature": ("Curvature", "V"),
            "albedo": ("Albedo", "RGB"),
            "uv": ("Uv", "XY")}
MATERIAL_KEYS = ("scattering", "specular", "roughness", "f0", "specular_model", "roughness2", "lobe_mix",
                 "shadow_filter_width")
PROFILE_KEYS = ("transmission", "diffusion_radius", "deep_scatter_color")  # of materials with a profile
OPTIONAL = ("shadow_filter_width", "deep_scatter_color")  # left out at 0
ENUMERATORS = {"scattering": "SCATTERING", "specular_model": "SPECULAR"}
EYE_KEYS = ("center", "gaze", "up", "sclera_radius", "cornea_radius", "limbus_radius", "limbus_width",
            "limbus_darkening", "chamber_depth", "pupil_radius", "iris_concavity", "iris_color", "iris_seed",
            "tear_roughness")


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v) for v in np.asarray(value).ravel().tolist()) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return repr(float(value)) if isinstance(value, float) else str(value)


def _plain(value: Any) -> Any:
    return value.name.lower() if isinstance(value, IntEnum) else value


def _lines(**values: Any) -> str:
    return "".join(f"{key} = {_toml(value)}\n" for key, value in values.items())


def scene_text(session: Session, look: Look, width: int, height: int) -> str:
    """The scene file of the picture; floats keep their bits."""
    eye, _ = session.camera(width / height)
    text = _lines(version=2, unit_mm=float(session.mm),
                  target_error=float(np.float32(look.target_error))) + "\n[channels]\n"
    for key, (name, components) in CHANNELS.items():
        if key != "uv" or look.method == "texture":
            names = [f"{name}.{c}" for c in components]
            text += f"{key} = {json.dumps(names if len(names) > 1 else names[0])}\n"
    text += "\n[camera]\n" + _lines(position=np.float32(eye))
    text += "\n[ambient]\n" + _lines(constant=np.float32([session.ambient(look)] * 3))
    for i, (light, map) in enumerate(session.lights(look)):
        text += "\n[[light]]\n" + _lines(type="directional", to_light=light.to_light, color=light.color)
        if map is not None:
            text += "[light.shadow_map]\n" + _lines(
                file=f"shadow_{i}.exr", channel="Z", projection="parallel",
                world_to_shadow=light.world_to_shadow,
                depth_range=light.shadow_depth_range, filter_texels=light.shadow_filter_texels)
    for id, m in session.materials(look).items():
        text += "\n[[material]]\n" + _lines(id=id)
        keys = [*MATERIAL_KEYS, "thickness_taps"]
        if m.profile is not None:
            text += _lines(profile="profile.toml" if look.profile == "custom" else look.profile)
            keys += PROFILE_KEYS
        if look.method == "texture" and id == SKIN:
            text += _lines(scattered_texture="scattered.exr")
        text += _lines(**{key: _plain(getattr(m, key)) for key in keys if key not in OPTIONAL
                          or np.any(getattr(m, key))})
    for id, eye in session.eyes(look).items():
        text += "\n[[eye]]\n" + _lines(material=id, **{key: getattr(eye, key) for key in EYE_KEYS})
        if look.iris_texture:
            text += _lines(iris_texture="iris.exr")
        if look.iris_profile:
            text += _lines(iris_profile=look.iris_profile)
    return text


def profile_text(look: Look) -> str:
    """The profile file of the look's own profile."""
    return _lines(name="custom", kind="burley", unit="mm", source="made in the viewer",
                  distance=[float(np.float32(d)) for d in look.distance])


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
        values = np.concatenate([g.material[..., None], g.position, g.normal_geometric, g.normal_shading,
                                 g.curvature[..., None], tinted(g, look)], 2)
        names = ["Id.I",
                 *(f"{n}.{c}" for n in ("Position", "NormalGeometric", "NormalShading") for c in "XYZ"),
                 "Curvature.V",
                 *(f"Albedo.{c}" for c in "RGB")]
        if look.method == "texture":
            values = np.concatenate([values, g.u[..., None], g.v[..., None]], 2)
            names += ["Uv.X", "Uv.Y"]
            write_image(out / "scattered.exr", session.texture(look).light)
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
        texts = {"scene.toml": scene_text(session, look, width, height),
                 "look.json": json.dumps(look.to_dict(), indent=2) + "\n",
                 "look.cpp": snippet(session, look)}
        if look.profile == "custom":
            texts["profile.toml"] = profile_text(look)
        for name, text in texts.items():
            (out / name).write_text(text, encoding="utf-8")
    finally:
        session.look.mode = mode
    return sorted(out.iterdir())
