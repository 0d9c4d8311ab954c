"""Makes the scene of BlenderScript.OddThings and saves it under PELLUCID_SCENE: names that are not valid in
file names and TOML, lights with similar names, a text, a camera that looks away."""

import os

import bpy

scene = bpy.context.scene
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
scene.name, scene.world = "Szene \u00e4", None
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 48, 48, 100
for name, tilt in (("a.b\n\"\u00fc\"", 0.2), ("a/b \"\u00fc\"", 0.5)):
    sun = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
    sun.rotation_euler = (tilt, 0, 0)
    scene.collection.objects.link(sun)
bpy.ops.object.text_add(location=(0, 0, -1))
bpy.context.object.data.body, bpy.context.object.data.extrude = "\u00dc.1", 0.1
material = bpy.data.materials.new("Haut. \"\u00c4\"\n\\ = [x]")
bpy.context.object.data.materials.append(material)
camera = bpy.data.objects.new("Kamera 1.2", bpy.data.cameras.new("Kamera"))
camera.location = (0, 0, 20)
camera.rotation_euler = (0, 3.14159, 0)  # up, away from everything
scene.collection.objects.link(camera)
scene.camera = camera
bpy.ops.wm.save_as_mainfile(filepath=os.environ["PELLUCID_SCENE"])
