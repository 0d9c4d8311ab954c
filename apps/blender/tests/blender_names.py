"""Makes the scene of BlenderScript.OddThings and saves it under PELLUCID_SCENE: names that are not valid in
file names and TOML, lights with similar names or without shadow, a text, an orthographic camera that looks
away, and what is left out."""

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
glow = bpy.data.objects.new("glow", bpy.data.lights.new("glow", "SUN"))
glow.data.use_shadow = False
if hasattr(glow.data.cycles, "cast_shadow"):  # Blender 3
    glow.data.cycles.cast_shadow = False
scene.collection.objects.link(glow)
bpy.ops.object.text_add(location=(0, 0, -1))
bpy.context.object.data.body, bpy.context.object.data.extrude = "\u00dc.1", 0.1
material = bpy.data.materials.new("Haut. \"\u00c4\"\n\\ = [x]")
material.use_nodes = True
shader = material.node_tree.nodes["Principled BSDF"]
shader.inputs["Alpha"].default_value = 0.5
texture = material.node_tree.nodes.new("ShaderNodeTexImage")
texture.image = bpy.data.images.new("Bild \u00e4", 4, 4)
texture.image.source, texture.image.filepath = "FILE", "/nowhere/a.png"
material.node_tree.links.new(texture.outputs[0], shader.inputs["Base Color"])
bpy.context.object.data.materials.append(material)
hair = bpy.data.objects.new("Haar", bpy.data.meshes.new("Haar"))
scene.collection.objects.link(hair)
hair.modifiers.new("Haar", "PARTICLE_SYSTEM")
hair.particle_systems[0].settings.type = "HAIR"
camera = bpy.data.objects.new("Kamera 1.2", bpy.data.cameras.new("Kamera"))
camera.location, camera.data.type = (0, 0, 20), "ORTHO"
camera.rotation_euler = (0, 3.14159, 0)  # up, away from everything
scene.collection.objects.link(camera)
scene.camera = camera
bpy.ops.wm.save_as_mainfile(filepath=os.environ["PELLUCID_SCENE"])
