"""The scene file of `pellucid shade` (docs/guide/scene-file.md)."""

import json
import os

from . import file_names, principled
from .fault import warn
from .passes import MATERIAL_CHANNEL

# The library's skin by its tables. Lengths in millimetres; those of the tables follow from the profile.
SKIN = {"profile": "skin", "scattering": "preintegrated", "deep_scatter_color": (0.7, 0.16, 0.05),
        "specular": 0.35}
SKIN_LENGTHS = {"deep_scatter_radius": 6.0, "deep_scatter_normal_offset": 0.2}
PLAIN = {"scattering": "none", "thickness_taps": 0}


def value(v):
    """As TOML has it, which writes texts, numbers and arrays as JSON does."""
    return json.dumps(v, ensure_ascii=False)


def table(keys):
    """The lines of a table, without keys whose value is empty."""
    return [f"{key} = {value(v)}" for key, v in keys.items() if v != ""]


def comment(name):
    """A name as the end of a line, which ends nowhere else."""
    return "# " + "".join(c if c.isprintable() else " " for c in name)


def keys_of(surface, preset, unit, folder, taken, extents):
    """Of [[material]], by what was chosen for it. `taken`: other materials' profile files in `folder`."""
    if preset == principled.EYE:  # its gloss is that of the film of tears
        keys = dict(PLAIN)
    elif preset == principled.PLAIN:
        keys = {**PLAIN, **surface.keys}
    elif preset == principled.SKIN:
        keys = {**SKIN, **{key: length / unit for key, length in SKIN_LENGTHS.items()}}
    else:
        name = preset
        if preset == "own":
            name = file_names.unique("profile", surface.name, ".toml", taken)
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(principled.profile_text(surface, unit))
        keys = {"profile": name, "scattering": "auto",
                "deep_scatter_normal_offset": SKIN_LENGTHS["deep_scatter_normal_offset"] / unit,
                **surface.keys}
    if extents and preset not in (principled.EYE, principled.PLAIN):
        keys["thickness_filter_radius"] = 3 / unit / max(extents)  # 3 mm
    return keys


def write(path, unit, viewpoint, lamps, sky, materials, eyes, curvature, fallback):
    """unit: millimetres per Blender unit. materials: (id, Blender material, Surface). eyes: (Blender
    material, keys). fallback: the preset of materials that have none."""
    of_eyes = {material.name: keys for material, keys in eyes}
    chosen = {id_: surface.chosen(of_eyes, fallback) for id_, _, surface in materials}
    if not any(preset not in (principled.PLAIN, principled.EYE) for preset in chosen.values()):
        warn("nothing scatters: no material has Subsurface above 0; give it one, or the custom property "
             "pellucid_preset = \"skin\", or pass --preset skin")
    surfaces = [surface for _, _, surface in materials]
    channels = {"material": MATERIAL_CHANNEL, "position": ["Position.X", "Position.Y", "Position.Z"],
                "normal_shading": ["NShading.R", "NShading.G", "NShading.B"],
                "normal_geometric": ["NGeom.R", "NGeom.G", "NGeom.B"],
                "albedo": ["Albedo.R", "Albedo.G", "Albedo.B"]}
    if curvature:
        channels["curvature"] = "Curvature.X"
    if any(s.roughness for s in surfaces):
        channels["roughness"] = "Roughness.X"
    if any(s.weight or (s.scattering and s.scattering.weight < 1) for s in surfaces):
        channels["scatter_weight"] = "ScatterWeight.X"
    lines = [
        "# Written by apps/blender/render_gbuffer.py. Axes: Blender's world, Z up. Lengths: Blender units,",
        f"# of {unit:g} mm each.",
        *table({"version": 2, "unit_mm": unit, "blur_normals": 1}),
        "", "[channels]", *table(channels),
        "", "[camera]", *table({"position": viewpoint})]
    if sky:
        lines += ["", "[ambient]", "sh = [", *("    " + value(row) + "," for row in sky), "]"]
    for lamp in lamps:
        lines += ["", "[[light]]  " + comment(lamp.name), *table(lamp.keys)]
        if lamp.shadow:
            lines += ["", "[light.shadow_map]", *table({**lamp.shadow, "channel": "R", "filter_texels": 48,
                                                        "bias": 0.5 / unit})]
    extents = [lamp.extent for lamp in lamps if lamp.shadow and lamp.kind == "SUN"]
    taken = set()
    for id_, material, surface in materials:
        if material.name in of_eyes:
            lines += ["", "[[eye]]", *table({"material": id_, **of_eyes[material.name]})]
        keys = keys_of(surface, chosen[id_], unit, os.path.dirname(path), taken, extents)
        keys.update({key: own for key, own in principled.custom_keys(material, "pellucid_").items()
                     if key != "preset" and not key.startswith("eye")})
        lines += ["", "[[material]]  " + comment(material.name), *table({"id": id_, **keys})]
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
