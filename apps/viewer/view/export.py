"""Writes what is shown as files: a G-buffer and a scene that `pellucid shade` renders to the same bits, pictures, the look, C++."""
from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from ..files import write_image
from .look import SKIN, Look
from .passes import tinted
from .session import Session

EYE_KEYS = ("center", "gaze", "up", "sclera_radius", "cornea_radius", "limbus_radius", "limbus_width", "limbus_darkening", "chamber_depth",
            "pupil_radius", "iris_concavity", "iris_color", "iris_seed", "tear_roughness")


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v) for v in np.asarray(value).ravel().tolist()) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return repr(float(value)) if isinstance(value, float) else str(value)


def _lines(**values: Any) -> str:
    return "".join(f"{key} = {_toml(value)}\n" for key, value in values.items())


def scene_text(session: Session, look: Look, width: int, height: int) -> str:
    """The scene file of the picture; floats keep their bits."""
    eye, _ = session.camera(width / height)
    profile = "profile.toml" if look.profile == "custom" else look.profile
    text = _lines(version=2, unit_mm=float(session.mm), target_error=float(np.float32(look.target_error))) + "\n[channels]\n"
    for key, name, components in (("material", "Id", "I"), ("position", "Position", "XYZ"), ("normal_geometric", "NormalGeometric", "XYZ"),
                                  ("normal_shading", "NormalShading", "XYZ"), ("curvature", "Curvature", "V"), ("albedo", "Albedo", "RGB"),
                                  *([("uv", "Uv", "XY")] if look.method == "texture" else [])):
        names = [f"{name}.{c}" for c in components]
        text += _lines(**{key: names if len(names) > 1 else names[0]}).replace("'", '"')
    text += "\n[camera]\n" + _lines(position=np.float32(eye)) + "\n[ambient]\n" + _lines(constant=np.float32([session.ambient(look)] * 3))
    for i, (light, map) in enumerate(session.lights(look)):
        text += "\n[[light]]\n" + _lines(type="directional", to_light=light.to_light, color=light.color)
        if map is not None:
            text += "[light.shadow_map]\n" + _lines(file=f"shadow_{i}.exr", channel="Z", projection="parallel",
                                                    world_to_shadow=light.world_to_shadow, depth_range=light.shadow_depth_range, filter_texels=light.shadow_filter_texels)
    for id, m in session.materials(look).items():
        text += "\n[[material]]\n" + _lines(id=id, scattering=m.scattering.name.lower())
        if m.profile is not None:
            text += _lines(profile=profile, transmission=m.transmission, diffusion_radius=m.diffusion_radius)
            if any(m.deep_scatter_color):
                text += _lines(deep_scatter_color=m.deep_scatter_color)
        if look.method == "texture" and id == SKIN:
            text += _lines(scattered_texture="scattered.exr")
        if m.shadow_filter_width:
            text += _lines(shadow_filter_width=m.shadow_filter_width)
        text += _lines(thickness_taps=m.thickness_taps, specular=m.specular, roughness=m.roughness, f0=m.f0,
                       specular_model=m.specular_model.name.lower(), roughness2=m.roughness2, lobe_mix=m.lobe_mix)
    for id, eye in session.eyes(look).items():
        text += "\n[[eye]]\n" + _lines(material=id, **{key: getattr(eye, key) for key in EYE_KEYS})
        if look.iris_texture:
            text += _lines(iris_texture="iris.exr")
        if look.iris_profile:
            text += _lines(iris_profile=look.iris_profile)
    return text


def profile_text(look: Look) -> str:
    """The profile file of the look's own profile."""
    return _lines(name="custom", kind="burley", unit="mm", source="made in the viewer", distance=[float(np.float32(d)) for d in look.distance])


def cpp_float(value: float) -> str:
    """A literal with the bits of the value as a float."""
    text = f"{float(np.float32(value)):.9g}"
    return text + ("f" if "." in text or "e" in text else ".0f")


def snippet(session: Session, look: Look) -> str:
    """C++ that sets the same material and lights; images are the host's."""
    skin = session.materials(look)[SKIN]
    lines = ['#include <pellucid/pellucid.hpp>', "", "void setLook(pellucid::Shader& shader) {"]
    if skin.profile is not None:
        made = ("pellucid::Profile::named(" + json.dumps(look.profile) + ")" if look.profile != "custom" else
                "pellucid::Profile::burleyDistance({" + ", ".join(f"{cpp_float(d)}" for d in look.distance) + "})")
        lines.append(f"    const pellucid::Profile profile = {made};  // mm")
    lines += ["    PelMaterial skin = pelMaterialDefaults();", f"    skin.scattering = PEL_SCATTERING_{skin.scattering.name};"]
    if skin.profile is not None:
        lines += ["    skin.profile = profile.get();", f"    skin.diffusionRadius = {cpp_float(skin.diffusion_radius)};  // 0: the profile's own",
                  f"    skin.transmission = {cpp_float(skin.transmission)};"]
    lines += [f"    skin.specular = {cpp_float(skin.specular)};", f"    skin.roughness = {cpp_float(skin.roughness)};", f"    skin.f0 = {cpp_float(skin.f0)};",
              f"    skin.specularModel = PEL_SPECULAR_{skin.specular_model.name};", f"    skin.roughness2 = {cpp_float(skin.roughness2)};",
              f"    skin.lobeMix = {cpp_float(skin.lobe_mix)};"]
    if any(skin.deep_scatter_color):
        lines += ["    // FaceWorks' term, in place of transmission",
                  *(f"    skin.deepScatterColor[{c}] = {cpp_float(v)};" for c, v in enumerate(skin.deep_scatter_color))]
    lines += ["    shader.setMaterial(1, skin);", ""]
    for id, eye in session.eyes(look).items():
        sclera = session.materials(look)[id]
        lines += ["    {", "        PelMaterial sclera = pelMaterialDefaults();", "        sclera.scattering = PEL_SCATTERING_NONE;",
                  f"        sclera.specular = {cpp_float(sclera.specular)};", f"        sclera.shadowFilterWidth = {cpp_float(sclera.shadow_filter_width)};",
                  f"        shader.setMaterial({id}, sclera);", "        PelEye eye = pelEyeDefaults();"]
        for key in EYE_KEYS:
            value, name = getattr(eye, key), re.sub("_(.)", lambda m: m[1].upper(), key)
            if np.ndim(value):
                lines.append("        " + " ".join(f"eye.{name}[{c}] = {cpp_float(v)};" for c, v in enumerate(value)))
            else:
                lines.append(f"        eye.{name} = {value if key == 'iris_seed' else cpp_float(value)};")
        if look.iris_profile:
            lines += [f"        const pellucid::Profile iris = pellucid::Profile::named({json.dumps(look.iris_profile)});", "        eye.irisProfile = iris.get();"]
        lines += [f"        shader.setEye({id}, eye);", "    }"]
    lines += ["", "    PelAmbient ambient = pelAmbientDefaults();",
              f"    for (float& c : ambient.constant) c = {cpp_float(session.ambient(look))};", "    shader.set(ambient);", "",
              "    std::vector<PelLight> lights;"]
    for light, _ in session.lights(look):
        to, color = (", ".join(f"{cpp_float(v)}" for v in values) for values in (light.to_light, light.color))
        lines += ["    {", "        PelLight light = pelLightDefaults();",
                  f"        for (int c = 0; c < 3; ++c) light.toLight[c] = std::array{{{to}}}[c], light.color[c] = std::array{{{color}}}[c];",
                  "        lights.push_back(light);", "    }"]
    lines += ["    shader.set(lights);", "    PelShaderOptions options = pelShaderOptionsDefaults();",
              f"    options.targetError = {cpp_float(look.target_error)};", f"    options.millimetresPerUnit = {cpp_float(session.mm)};",
              "    shader.set(options);", "}", ""]
    return "\n".join(["#include <array>", "#include <vector>", *lines])


def export(session: Session, folder: Any, width: int = 1280, height: int = 720) -> list[Path]:
    """Writes scene.toml, gbuffer.exr, shadow_N.exr, picture.png, picture.exr, look.json and look.cpp into `folder`.

    ``pellucid shade gbuffer.exr --scene scene.toml -o again.exr`` there gives picture.exr again.
    """
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    look = session.look.copy()
    mode, session.look.mode = session.look.mode, "final"
    try:
        radiance = session.radiance(look, width, height)
        g = session.gbuffer(width, height)
        values = np.concatenate([g.material[..., None], g.position, g.normal_geometric, g.normal_shading, g.curvature[..., None], tinted(g, look)], 2)
        names = ["Id.I", *(f"{n}.{c}" for n in ("Position", "NormalGeometric", "NormalShading") for c in "XYZ"), "Curvature.V",
                 *(f"Albedo.{c}" for c in "RGB")]
        if look.method == "texture":
            values, names = np.concatenate([values, g.u[..., None], g.v[..., None]], 2), [*names, "Uv.X", "Uv.Y"]
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
        write_image(out / "picture.png", radiance, exposure=look.exposure, shoulder=look.shoulder, curve=look.curve)
        texts = {"scene.toml": scene_text(session, look, width, height), "look.json": json.dumps(look.to_dict(), indent=2) + "\n",
                 "look.cpp": snippet(session, look)}
        if look.profile == "custom":
            texts["profile.toml"] = profile_text(look)
        for name, text in texts.items():
            (out / name).write_text(text, encoding="utf-8")
    finally:
        session.look.mode = mode
    return sorted(out.iterdir())
