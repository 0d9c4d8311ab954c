"""What the panel sets. A material's preset is the custom property pellucid_preset, so that files keep it."""

import json
import os
import shutil
import subprocess

import bpy

from .fields import FIELDS  # which packaging/blender_addon writes

PRESET = "pellucid_preset"
FIXED = [("auto", "From its shader", "Scatters by its Subsurface inputs; with weight 0 it does not scatter"),
         ("plain", "Nothing scatters", "Shaded by Lambert, with the gloss of its shader"),
         ("skin", "Skin, by tables", "Skin as in real-time renderers: curvature and shadow tables"),
         ("eye", "Eye", "A refracting cornea, an iris and a pupil, fitted to the ball of its faces")]
_libraries = {}  # by command


def command():
    """The pellucid command: the preferences', $PELLUCID_COMMAND, or the one that is found."""
    addon = bpy.context.preferences.addons.get(__package__)
    given = addon.preferences.command if addon and addon.preferences else ""
    if given:
        return bpy.path.abspath(given)
    return os.environ.get("PELLUCID_COMMAND") or shutil.which("pellucid") or "pellucid"


def library():
    """Names of the library's materials, for which each command is asked once; none if it does not answer."""
    asked = command()
    if asked not in _libraries:
        try:
            said = subprocess.run([asked, "profile", "list", "--json"], capture_output=True, text=True,
                                  stdin=subprocess.DEVNULL, timeout=10)
            _libraries[asked] = [p["name"] for p in json.loads(said.stdout)["profiles"]]
        except (OSError, ValueError, KeyError, TypeError, subprocess.TimeoutExpired):
            _libraries[asked] = []  # or each drawing of the panel would wait again
    return _libraries[asked]


_items = []  # Blender keeps no texts of items that a function returns


def items(self, context):
    _items[:] = FIXED + [(name, name.replace("-", " ").replace("_", " ").capitalize(),
                          f"The library's {name}") for name in library() if name != "skin"]
    return _items


def read(material):
    names = [item[0] for item in items(None, None)]
    preset = material.get(PRESET) or "auto"
    return names.index(preset) if preset in names else 0


def write(material, index):
    material[PRESET] = items(None, None)[index][0]


class PELLUCID_OT_own_value(bpy.types.Operator):
    """Set this value for the material, or return to the value of the preset"""

    bl_idname, bl_label, bl_options = "pellucid.own_value", "Own value", {"UNDO"}
    material: bpy.props.StringProperty()
    field: bpy.props.EnumProperty(items=[(name, row[0], row[1]) for name, row in FIELDS.items()])

    def execute(self, context):
        material = bpy.data.materials[self.material]
        if self.field in material:
            del material[self.field]
            return {"FINISHED"}
        _, words, default, least, most, step = FIELDS[self.field]
        material[self.field] = default
        known = {} if isinstance(default, int) else {"step": step}
        material.id_properties_ui(self.field).update(default=default, soft_min=type(default)(least),
                                                     soft_max=type(default)(most), description=words, **known)
        return {"FINISHED"}


class Settings(bpy.types.PropertyGroup):
    samples: bpy.props.EnumProperty(name="Anti-aliasing",
                                    description="Render the G-buffer larger, and scale the picture down",
                                    items=[("1", "Off", "One sample per pixel"),
                                           ("2", "2 x 2", "Four samples per pixel")], default="1")
    shadow_size: bpy.props.IntProperty(name="Shadow maps", description="Texels on a side", default=1024,
                                       min=64, max=16384)
    exposure: bpy.props.FloatProperty(name="Exposure", description="Multiplies the picture", default=1.0,
                                      min=0.001, max=1000.0)
    unit: bpy.props.FloatProperty(name="Unit (mm)",
                                  description="Millimetres per Blender unit; 0: the scene's unit scale",
                                  default=0.0, min=0.0)


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    command: bpy.props.StringProperty(name="Pellucid command",
                                      description="Empty: $PELLUCID_COMMAND, else the one on the PATH",
                                      subtype="FILE_PATH")
    device: bpy.props.StringProperty(name="OpenCL device",
                                     description="A number, cpu, gpu or a part of a name; empty: the default "
                                                 "device")

    def draw(self, context):
        self.layout.prop(self, "command")
        self.layout.prop(self, "device")
        if not library():
            self.layout.label(text=f"'{command()}' cannot be run: pip install pellucid installs it",
                              icon="ERROR")


register_classes, unregister_classes = bpy.utils.register_classes_factory(
    (PELLUCID_OT_own_value, Settings, Preferences))


def register():
    register_classes()
    bpy.types.Scene.pellucid = bpy.props.PointerProperty(type=Settings)
    bpy.types.Material.pellucid = bpy.props.EnumProperty(name="Pellucid",
                                                         description="How light scatters in this material",
                                                         items=items, get=read, set=write)


def unregister():
    del bpy.types.Material.pellucid
    del bpy.types.Scene.pellucid
    unregister_classes()
