"""The settings of the viewer: one set of values, to be shown, stored as a preset and exported."""
from __future__ import annotations

import copy
from dataclasses import asdict, dataclass, field
from typing import Any, TypeVar

from .._types import MaterialValues
from ..profile import Profile

MODES = {
    "final": "Final picture",
    "lambert": "Without scattering",
    "false_color": "False colour: luminance",
    "difference": "Scattering difference (x 4, grey: none)",
    "error": "Error against the reference (x 10, grey: none)",
    "reference": "Reference: the surface integral",
    "diffuse": "Diffuse part",
    "specular": "Specular part",
    "deep_scatter": "Transmitted light",
    "irradiance": "Irradiance",
    "thickness": "Thickness along the key light (white: 20 mm)",
    "curvature": "Curvature (white: 0.2 per mm)",
    "normals": "Shading normals",
    "albedo": "Albedo",
    "materials": "Material ids",
    "tiles": "Tiles by method (dark: not scattered)",
}

METHODS = {
    "auto": "Auto: chosen by the inputs",
    "none": "None: Lambert",
    "preintegrated": "Pre-integrated",
    "separable": "Screen space, separable",
    "screen": "Screen space, disk",
    "light": "Light space (shadow map)",
    "texture": "Texture space",
}

CURVES = {"soft": "Soft", "none": "None", "filmic": "Filmic", "agx-like": "AgX-like"}
SHADOW_SIZES = [512, 1024, 2048, 4096]


def profiles() -> list[str]:
    return [*Profile.library_names(), "pigments", "custom"]


# Material ids of the heads that come with the package.
SKIN, EYES, TEETH, TONGUE, CUT, RIGHT_EYE = MATERIALS = 1, 2, 3, 4, 5, 6  # EYES: the left one
NAMES = {SKIN: "skin", EYES: "left eye", TEETH: "teeth", TONGUE: "tongue", CUT: "other",
         RIGHT_EYE: "right eye"}

T = TypeVar("T")


def filled(made: T, given: Any, what: str) -> T:
    """A new dataclass, after it took the values that JSON gives for some of its fields, of the types of its
    own. Raises ValueError, naming it, for another key or type."""
    def like(own: Any, value: Any, name: str) -> Any:
        if isinstance(own, tuple) and isinstance(value, (list, tuple)) and len(value) == len(own):
            return tuple(like(o, v, name) for o, v in zip(own, value))
        number = type(value) in (int, float) and abs(value) < 1e30
        if not (number if isinstance(own, float) else type(value) is type(own)):
            raise ValueError(f"{name} of {what} is {value!r}; {own!r} would do")
        return float(value) if isinstance(own, float) else value

    if not isinstance(given, dict):
        raise ValueError(f"{what} is a JSON object with keys and values")
    known = vars(made)
    for key, value in given.items():
        if key not in known:
            raise ValueError(f"{what} has no {key!r}; it has {', '.join(sorted(known))}")
        setattr(made, key, like(known[key], value, key))
    return made


def skin_triangles(mesh: Any) -> Any:
    return mesh.triangles if mesh.ids is None else mesh.triangles[mesh.ids[mesh.triangles[:, 0]] == SKIN]


@dataclass
class Lamp:
    """A distant light round the object: azimuth 0 is its front, 90 its left. Degrees."""

    name: str
    azimuth: float
    elevation: float
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)  # linear
    intensity: float = 1.0                               # irradiance / pi
    shadow: bool = True
    on: bool = True


def _lamps() -> list[Lamp]:
    return [Lamp("Key", 55.0, 30.0, (1.0, 0.95, 0.88), 1.0),
            Lamp("Fill", -50.0, 10.0, (0.8, 0.9, 1.0), 0.15, shadow=False),
            Lamp("Rim", 160.0, 15.0, (1.0, 0.97, 0.92), 0.2)]


@dataclass
class Look(MaterialValues):
    """Materials, lights and how the picture is shown: material fields with a slider, and these. In mm."""

    profile: str = "skin"            # of the library, "pigments" or "custom"
    distance: tuple[float, float, float] = (0.29, 0.11, 0.054)  # mm, of "custom": Burley's d per channel
    # of "pigments": shares of volume, of melanin, and of haemoglobin; mm
    melanin: float = 0.05
    eumelanin: float = 1.0
    blood: float = 0.02
    oxygenation: float = 0.75
    epidermis: float = 0.06
    radius_scale: float = 1.0        # times the profile's lengths
    method: str = "auto"
    target_error: float = 0.002      # of white, what `auto` may be off
    # colour of FaceWorks' own term, in place of transmission
    deep_scatter: tuple[float, float, float] = (0.0, 0.0, 0.0)
    albedo: tuple[float, float, float] = (1.0, 1.0, 1.0)  # times the mesh's
    specular: float = 0.35
    ggx: bool = False
    pores: float = 0.06              # slope of the relief that the renderer adds
    # Of eyes; mm of an eye of an adult's size.
    pupil: float = 2.0               # radius
    # linear: colours fibres, or multiplies the texture, by which it is 1
    iris_color: tuple[float, float, float] = (0.22, 0.12, 0.06)
    iris_seed: int = 0               # pattern of the fibres
    iris_texture: str = ""           # file of a square image; "": fibres are drawn
    iris_concavity: float = 0.0
    iris_profile: str = ""           # of the library, by which light scatters in the iris; "": not at all
    limbus_width: float = 1.0
    limbus_darkening: float = 0.6
    cornea_radius: float = 7.8
    chamber_depth: float = 3.05      # no less than the cornea needs
    tear_roughness: float = 0.03
    gaze: tuple[float, float] = (0.0, 0.0)  # degrees to its left and up
    ambient: float = 0.12            # irradiance / pi from everywhere
    surroundings: str = ""           # "studio" or an image file; "": none
    surroundings_light: float = 0.5  # factor of its radiance
    surroundings_turn: float = 0.0   # degrees about the vertical axis
    lamps: list[Lamp] = field(default_factory=_lamps)
    shadow_size: int = 1024          # texels a side
    exposure: float = 1.0
    curve: str = "soft"              # tone mapping
    shoulder: float = 0.8            # of "soft"
    mode: str = "final"
    white: float = 1.0               # luminance at the end of the false colours

    def copy(self) -> Look:
        return copy.deepcopy(self)

    def to_dict(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Look:
        """From `to_dict`. Raises ValueError, naming it, for an unknown key or a value of another type."""
        look = filled(cls(), values, "a look")
        if not look.lamps:
            raise ValueError("lamps of a look is empty")
        if "lamps" in values:
            look.lamps = [filled(Lamp("", 0.0, 0.0), lamp, "a lamp") for lamp in values["lamps"]]
        for key, known in {"mode": MODES, "method": METHODS, "curve": CURVES, "shadow_size": SHADOW_SIZES,
                           "profile": profiles(), "iris_profile": ["", *Profile.library_names()]}.items():
            if getattr(look, key) not in known:
                raise ValueError(f"{key} of a look is {getattr(look, key)!r}; it is one of "
                                 f"{', '.join(str(k) for k in known)}")
        return look


# Azimuth, elevation and intensity of key, fill and rim, as photographers place them.
ARRANGEMENTS = {"Three points": ((55, 30, 1.0), (-50, 10, 0.15), (160, 15, 0.2)),
                "Rembrandt": ((45, 45, 1.1), (-60, 0, 0.08), (-150, 25, 0.15)),
                "Split": ((90, 10, 1.1), (-90, 0, 0.04), (180, 30, 0.1)),
                "Butterfly": ((0, 50, 1.0), (0, -30, 0.15), (170, 30, 0.2)),
                "From behind": ((150, 20, 1.5), (-40, 10, 0.12), (-150, 20, 1.0))}

PIGMENTS = "melanin", "eumelanin", "blood", "oxygenation", "epidermis"

# Name, melanin and blood: the skins nearest to measured colours. L* 68.4: a fair inner arm (Cooksey, Allen,
# Tsai, Reference data set of human skin reflectance, 2017); 63.0: the mean of inner arms (Xiao et al.,
# Characterising the variations in ethnic skin colours, 2017); 53.7, 49.2, 43.7, 38.1: means of upper and
# lower arms (Alaluf et al., Ethnic variation in melanin content and composition, 2002).
SKINS = (("Skin, pale", 0.009, 0.008), ("Skin, light", 0.026, 0.006), ("Skin, medium", 0.055, 0.013),
         ("Skin, brown", 0.082, 0.013), ("Skin, dark", 0.098, 0.026), ("Skin, very dark", 0.134, 0.037))

# Settings that a preset does not change: lights and view.
KEPT_BY_PRESETS = ("lamps", "ambient", "surroundings", "surroundings_light", "surroundings_turn",
                   "shadow_size", "exposure", "curve", "shoulder", "mode", "white",
                   "target_error")

# Tints are chosen by eye, for a mesh of skin's albedo; profiles are those of the library.
PRESETS: dict[str, dict[str, Any]] = {
    "Skin": {},
    "Skin, softer": {"radius_scale": 2.0},
    "Skin, oily": {"specular": 0.6, "roughness": 0.2, "ggx": True},
    **{name: {"profile": "pigments", "melanin": melanin, "blood": blood} for name, melanin, blood in SKINS},
    "Marble": {"profile": "marble", "albedo": (1.05, 1.4, 1.6), "specular": 0.3, "roughness": 0.15,
               "pores": 0.0},
    "Jade": {"profile": "jade", "albedo": (0.35, 1.2, 0.75), "specular": 0.6, "roughness": 0.12,
             "pores": 0.0},
    "Wax": {"profile": "paraffin", "albedo": (1.15, 1.35, 1.1), "specular": 0.25, "roughness": 0.35,
            "pores": 0.0},
    "Leaf": {"profile": "custom", "distance": (0.25, 0.5, 0.12), "albedo": (0.3, 1.1, 0.25), "specular": 0.3,
             "roughness": 0.35, "pores": 0.1, "transmission": 1.0},
    "Plain (Lambert)": {"method": "none", "transmission": 0.0},
}
