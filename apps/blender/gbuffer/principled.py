"""Reads scattering and gloss from a material's shader, as keys of [[material]] and a profile."""

import math
from collections import namedtuple

from .fault import Fault, warn

# custom property of a Blender material: one of FIXED, or a material of the library
PRESET = "pellucid_preset"
AUTO, PLAIN, SKIN, EYE = FIXED = ("auto", "plain", "skin", "eye")


def custom_keys(material, prefix):
    """The custom properties of a Blender material with this prefix, without the prefix."""
    owns = {name[len(prefix):]: material[name] for name in material.keys() if name.startswith(prefix)}
    return {key: own if isinstance(own, (int, float, str)) else tuple(own) for key, own in owns.items()}


# How far light goes under a surface. radius: Blender units, red, green, blue; weight: 0 to 1; tint: (colour,
# share) mixed into the albedo.
Scattering = namedtuple("Scattering", "radius weight tint", defaults=[None])


class Surface:
    """Read before the shader of the G-buffer replaces the material's."""

    def __init__(self, material, shader):
        self.preset = material.get(PRESET, "") or AUTO
        if not isinstance(self.preset, str):
            raise Fault(f"material '{material.name}': {PRESET} is {self.preset!r}; a text is needed: "
                        f"{', '.join(FIXED)}, or a material of the library")
        self.name = material.name
        self.keys = {}  # how it shines
        self.scattering = None
        self.roughness = self.weight = None  # sockets that feed them, if they are not numbers
        if shader is not None:
            self.read(shader)

    def read(self, shader):
        value = lambda *names: next((shader.inputs[n].default_value for n in names if n in shader.inputs),
                                    None)  # noqa: E731
        linked = lambda *names: next((shader.inputs[n].links[0].from_socket for n in names
                                      if n in shader.inputs and shader.inputs[n].is_linked),
                                     None)  # noqa: E731
        if shader.type == "SUBSURFACE_SCATTERING":
            self.scattering = Scattering([value("Scale") * r for r in value("Radius")], 1.0)
        if shader.type != "BSDF_PRINCIPLED":
            return
        if linked("Alpha") or value("Alpha") < 1:
            warn(f"material '{self.name}': its Alpha is left out; it is drawn solid")
        metallic, roughness = value("Metallic"), value("Roughness")
        self.roughness = linked("Roughness")
        # Principled's roughness is the root of GGX's width.
        self.keys = {"specular_model": "ggx", "lobe_mix": 0.0, "specular": 1.0,
                     "roughness": 1.0 if self.roughness else max(roughness * roughness, 0.01)}
        level = value("Specular", "Specular IOR Level")
        if "Specular IOR Level" in shader.inputs:  # Blender 4: on top of the index of refraction
            ior = max(value("IOR"), 1.0)
            f0 = ((ior - 1) / (ior + 1)) ** 2 * 2 * level
        else:
            f0 = 0.08 * level
        colour = value("Base Color")
        self.keys["f0"] = min(1.0, f0 * (1 - metallic) + sum(colour[:3]) / 3 * metallic)
        if metallic > 0.5:
            return
        weight = value("Subsurface Weight", "Subsurface")
        self.weight = linked("Subsurface Weight", "Subsurface")
        if weight > 0 or self.weight:
            radius = list(value("Subsurface Radius"))
            if "Subsurface Scale" in shader.inputs:  # Blender 4: the weight mixes
                scale = value("Subsurface Scale")
                self.scattering = Scattering([scale * r for r in radius], 1.0 if self.weight else weight)
            else:  # Blender 3: it multiplies the radius, and mixes the colours
                scale = 1.0 if self.weight else weight
                self.scattering = Scattering([scale * r for r in radius], 1.0,
                                             (tuple(value("Subsurface Color")), scale))
                self.weight = None
            for name in ("Subsurface Radius", "Subsurface Scale", "Subsurface Color"):
                if linked(name):
                    warn(f"material '{self.name}': what feeds {name} is left out; its value counts")

    def chosen(self, eyes, fallback):
        """The preset: one of FIXED but auto, "own" for the shader's scattering, or a library material."""
        preset = fallback if self.preset == AUTO else self.preset
        if self.name in eyes:
            return EYE
        if preset == EYE:  # that is no ball
            return PLAIN
        if preset != AUTO:
            return preset
        return "own" if self.scattering else PLAIN


def profile_text(surface, unit):
    """A profile file; Blender's radius is 4 pi times d of Burley's profile, in Blender units of `unit` mm."""
    distance = [max(r * unit / (4 * math.pi), 1e-4) for r in surface.scattering.radius]
    name = "".join(c for c in surface.name if c.isprintable() and c not in '"\\')[:40] or "material"
    return (f'version = 1\nname = "{name}"\nkind = "burley"\nunit = "mm"\nsource = "Blender: subsurface '
            f'radius, by render_gbuffer.py"\n' f"distance = [{', '.join(f'{d:.9g}' for d in distance)}]\n")
