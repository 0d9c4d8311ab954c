"""Installs the add-on's zip in the Blender that runs this, builds a scene with skin, an eye, teeth and wax,
and presses the button.

    blender --factory-startup -b --python blender_addon.py -- ADDON.zip OUTPUT_FOLDER [WIDTH]

The folder then holds what test_cli_blender_addon.cpp checks: the picture, the scene file and report.json.
docs/figures/blender_addon.png is such a picture, 960 wide.
"""

import json
import math
import os
import sys

import bpy
from mathutils import Vector

zip_file, out, *width = sys.argv[sys.argv.index("--") + 1 :]
if bpy.app.version >= (4, 2):
    bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default")
    addon = "bl_ext.user_default.pellucid"
else:
    bpy.ops.preferences.addon_install(filepath=zip_file)
    addon = "pellucid"
bpy.ops.preferences.addon_enable(module=addon)

for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
scene = bpy.context.scene
scene.unit_settings.scale_length = 0.01  # a Blender unit is a centimetre
scene.render.resolution_x = int(width[0]) if width else 320
scene.render.resolution_y, scene.render.resolution_percentage = scene.render.resolution_x // 2, 100


def material(name, colour, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    for key, value in inputs.items():
        key = key.replace("_", " ")
        if key == "Subsurface" and key not in shader.inputs:  # Blender 4
            key = "Subsurface Weight"
        if key == "Specular" and key not in shader.inputs:
            key = "Specular IOR Level"
        if key in shader.inputs:
            shader.inputs[key].default_value = value
    return made


def ball(x, radius, made, z=0.0):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=(x, 0, z), segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(made)
    return bpy.context.object


# Blender 3 scales the radius by Subsurface, Blender 4 by Subsurface Scale.
skin = material("Face", (0.8, 0.5, 0.4), Subsurface=0.5, Subsurface_Scale=0.5,
                Subsurface_Radius=(0.4, 0.1, 0.05),
                Subsurface_Color=(0.8, 0.5, 0.4, 1), Roughness=0.4, Specular=0.5)
teeth = material("Teeth", (0.85, 0.82, 0.7), Roughness=0.2, Specular=0.4)
eye = material("Eye.L", (0.8, 0.75, 0.7), Roughness=0.1)
jade = material("Stone", (0.3, 0.6, 0.4))
ball(-3, 1.0, skin)
ball(-1, 0.9, teeth)
eyeball = ball(1, 0.9, eye)
for vertex in eyeball.data.vertices:  # a cornea that looks to -y
    if vertex.co.y < -0.8 * 0.9:
        vertex.co.y -= 0.3 * (-vertex.co.y - 0.8 * 0.9)
ball(3, 0.9, jade)
jade.pellucid = "jade"
for made, field in ((jade, "pellucid_roughness2"), (jade, "pellucid_f0"), (eye, "pellucid_eye_iris_seed")):
    bpy.ops.pellucid.own_value(material=made.name, field=field)
jade["pellucid_roughness2"], eye["pellucid_eye_iris_seed"] = 0.25, 7
bpy.ops.pellucid.own_value(material=jade.name, field="pellucid_f0")  # left to the preset again

data = bpy.data.lights.new("sun", "SUN")
data.energy = 3
lamp = bpy.data.objects.new("sun", data)
lamp.rotation_euler = Vector((0.7, 0.6, -0.4)).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(lamp)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location, camera.rotation_euler = (0, -22, 0), (math.pi / 2, 0, 0)
camera.data.lens = 80
scene.collection.objects.link(camera)
scene.camera = camera
scene.world = None

properties = sys.modules[addon + ".properties"]
report = {"library": properties.library()}
report["own"] = [sorted(k for k in m.keys() if k != "pellucid_preset") for m in (jade, eye)]
before = {m.name: [n.name for n in m.node_tree.nodes] for m in bpy.data.materials if m.use_nodes}
engine, scenes = scene.render.engine, len(bpy.data.scenes)
scene.pellucid.samples = "2"
scene.pellucid.shadow_size = 512
report["result"] = list(bpy.ops.pellucid.render(filepath=os.path.join(out, "picture.png"),
                                                keep=os.path.join(out, "kept")))
image = bpy.data.images["Pellucid"]
report["size"], report["packed"] = list(image.size), image.packed_file is not None
report["untouched"] = (before == {m.name: [n.name for n in m.node_tree.nodes] for m in bpy.data.materials
                                  if m.use_nodes}
                       and scene.render.engine == engine and len(bpy.data.scenes) == scenes
                       and not bpy.data.filepath)
report["log"] = bpy.data.texts["Pellucid log"].as_string()
scene.pellucid.samples = "1"
bpy.ops.pellucid.render(filepath=os.path.join(out, "plain.png"))
report["plain_size"] = list(bpy.data.images["Pellucid"].size)


def failure(**options):
    try:
        bpy.ops.pellucid.render(**options)
    except RuntimeError as error:  # an operator's error report
        return str(error)
    return "none"


# A folder or a command that is not there: a message, and nothing lost.
report["unsaved"] = failure(filepath="/nowhere/picture.png")
report["images"] = sorted(i.name for i in bpy.data.images if i.source != "VIEWER")
bpy.context.preferences.addons[addon].preferences.command = "/nowhere/pellucid"
report["failure"], report["without"] = failure(), properties.library()
bpy.ops.preferences.addon_disable(module=addon)
bpy.ops.preferences.addon_enable(module=addon)
with open(os.path.join(out, "report.json"), "w") as file:
    json.dump(report, file)
