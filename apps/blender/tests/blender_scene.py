"""Makes the scene of test_cli_blender_script.cpp and saves it: blender -b --python THIS --python
render_gbuffer.py -- ...

What a .blend file may hold and a converter may get wrong: modifiers that differ on screen and in a render,
materials on the object and on the mesh, a mirrored and unevenly scaled object, an instanced collection, a
bumped and textured surface, things that are rendered but not shown or the reverse, a light with nodes, a
portal. PELLUCID_SCENE: "FILE.blend LIGHT", a light's type.
"""

import math
import os

import bpy
from mathutils import Vector

path, light = os.environ["PELLUCID_SCENE"].rsplit(" ", 1)
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
scene = bpy.context.scene
scene.unit_settings.scale_length = 0.01  # a Blender unit is a centimetre
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 240, 50


def material(name, colour, index):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
    made.pass_index = index
    made["pellucid_preset"] = "skin"
    made["pellucid_profile"] = ""  # no tables: plain Lambert, to be compared with Blender's
    made["pellucid_deep_scatter_radius"] = 0.5
    made["pellucid_specular"] = 0.0
    made["pellucid_deep_scatter_color"] = [0.0, 0.0, 0.0]
    return made


skin = material("skin", (0.8, 0.5, 0.4), 7)
jade = material("jade", (0.2, 0.6, 0.3), 9)
other = material("not shaded", (1, 1, 1), 0)
tree = jade.node_tree  # a pattern, and a bump
noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
noise.inputs["Scale"].default_value = 3
bump.inputs["Strength"].default_value = 0.3
tree.links.new(noise.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
tree.links.new(noise.outputs["Fac"], bump.inputs["Height"])
tree.links.new(bump.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])

bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=48, ring_count=24)
ball = bpy.context.object
bpy.ops.object.shade_smooth()
subdivision = ball.modifiers.new("finer", "SUBSURF")
subdivision.levels, subdivision.render_levels = 0, 1
ball.data.materials.append(other)
ball.material_slots[0].link = "OBJECT"
ball.material_slots[0].material = skin

bpy.ops.mesh.primitive_torus_add(location=(-1.7, 0.2, 0.5), major_radius=0.5, minor_radius=0.22)
ring = bpy.context.object
bpy.ops.object.shade_smooth()
ring.scale, ring.rotation_euler = (-1.0, 1.0, 1.4), (0.7, 0.3, 0)
ring.data.materials.append(jade)
ring.hide_viewport = True

bpy.ops.mesh.primitive_cube_add(size=0.8)
cube = bpy.context.object
cube.data.materials.append(skin)
group = bpy.data.collections.new("group")
group.objects.link(cube)
inside = scene.collection if cube.name in scene.collection.objects else bpy.context.collection
inside.objects.unlink(cube)
empty = bpy.data.objects.new("instance", None)
empty.instance_type, empty.instance_collection = "COLLECTION", group
empty.location, empty.rotation_euler = (1.7, 0.3, -0.5), (0.3, 0.2, 0.5)
scene.collection.objects.link(empty)

bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 2, 0), rotation=(math.pi / 2, 0, 0))
bpy.context.object.data.materials.append(other)
bpy.ops.mesh.primitive_cube_add(size=1, location=(0, -2, 0))
unseen = bpy.context.object
unseen.users_collection[0].objects.unlink(unseen)
hidden = bpy.data.collections.new("hidden")
hidden.objects.link(unseen)
scene.collection.children.link(hidden)
hidden.hide_render = True
bpy.ops.mesh.primitive_cube_add(size=0.5, location=(1.25, -1.5, 1))  # between ball and lamp
bpy.context.object.visible_camera = bpy.context.object.visible_shadow = False

data = bpy.data.lights.new("lamp", light)
data.color = (1, 0.8, 0.6)
data.energy = 4.0 if light == "SUN" else 600.0
data.use_nodes = True
data.node_tree.nodes["Emission"].inputs["Strength"].default_value = 0.5
lamp = bpy.data.objects.new("lamp", data)
lamp.location = (2.5, -3, 2)
lamp.rotation_euler = (-lamp.location).to_track_quat("-Z", "Y").to_euler()
if light == "SPOT":
    data.spot_size, data.spot_blend = math.radians(50), 0.4
if light == "AREA":
    data.shape, data.size, data.size_y, lamp.scale = "RECTANGLE", 1.5, 0.5, (1, 2, 1)
    data.spread = 2
    if hasattr(data, "normalize"):
        data.energy, data.normalize = 200, False  # per area
scene.collection.objects.link(lamp)
portal = bpy.data.objects.new("portal", bpy.data.lights.new("portal", "AREA"))
portal.data.cycles.is_portal = True
scene.collection.objects.link(portal)

camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location = (0.5, -7, 1.5)
camera.rotation_euler = (Vector((0, 0, 0)) - camera.location).to_track_quat("-Z", "Y").to_euler()
camera.data.dof.use_dof = True
scene.collection.objects.link(camera)
scene.camera = camera

# Radiance 0.5 + 0.5 (0.6 x + 0.8 z) from direction (x, y, z), in red; half of it in the others.
world = bpy.data.worlds.new("world")
world.use_nodes = True
tree = world.node_tree
direction, dot, sum_ = (tree.nodes.new(n)
                        for n in ("ShaderNodeNewGeometry", "ShaderNodeVectorMath", "ShaderNodeMath"))
flip = tree.nodes.new("ShaderNodeVectorMath")
dot.operation, sum_.operation = "DOT_PRODUCT", "MULTIPLY_ADD"
dot.inputs[1].default_value = (-0.6, 0, -0.8)  # Incoming points back to the camera
sum_.inputs[1].default_value = sum_.inputs[2].default_value = 0.5
colour = tree.nodes.new("ShaderNodeCombineColor")
tree.links.new(direction.outputs["Incoming"], dot.inputs[0])
tree.links.new(dot.outputs["Value"], sum_.inputs[0])
tree.links.new(sum_.outputs[0], colour.inputs[0])
tree.links.new(colour.outputs[0], tree.nodes["Background"].inputs["Color"])
scene.world = world
bpy.ops.wm.save_as_mainfile(filepath=path)
