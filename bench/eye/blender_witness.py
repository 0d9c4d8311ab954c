"""An eye by Blender's Cycles, a witness from outside: a glass cornea over an iris disc, its caustic by manifold next event estimation.

    blender --factory-startup -b --python bench/eye/blender_witness.py -- OUT.exr [samples, 512]
    build/release/bin/sweep_eye_pictures FOLDER OUT.exr     # compares; docs/guide/eyes.md has the result

Millimetres. The shapes, the camera and the light are those of sweep_eye_pictures.cpp, "witness".
"""
import math
import sys

import bpy
from mathutils import Matrix, Vector

R, RHO, K, LIMBUS, DEPTH, PUPIL, INDEX, SIDE = 12.0, 7.8, -0.26, 6.0, 3.05, 2.0, 1.336, 256
CAMERA, LIGHT = Vector((26.0, 10.0, 58.0)), Vector((0.8, 0.3, 0.5)).normalized()
words = sys.argv[sys.argv.index("--") + 1:]


def sag(r):
    return r * r / (RHO * (1 + math.sqrt(1 - (1 + K) * r * r / RHO**2)))


LIMBUS_Z = math.sqrt(R * R - LIMBUS**2)
APEX = LIMBUS_Z + sag(LIMBUS)
IRIS = APEX - DEPTH


def lathe(name, outline, material, turns=512):
    """Turns an outline of (r, z) round the axis; r = 0 makes a pole."""
    vertices, rings, faces = [], [], []
    for r, z in outline:
        ring = [len(vertices) + (i if r > 0 else 0) for i in range(turns)]
        for i in range(turns if r > 0 else 1):
            a = 2 * math.pi * i / turns
            vertices.append((r * math.cos(a), r * math.sin(a), z))
        rings.append(ring)
    for upper, lower in zip(rings, rings[1:]):
        for i in range(turns):
            face = [upper[i], lower[i], lower[(i + 1) % turns], upper[(i + 1) % turns]]
            faces.append(list(dict.fromkeys(face)))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(material)
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def material(name, kind, colour=(0, 0, 0), index=None):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Color"].default_value = (*colour, 1)
    if index:
        shader.inputs["IOR"].default_value = index
        shader.inputs["Roughness"].default_value = 0
    tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    return made


for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
scene = bpy.context.scene
scene.world = bpy.data.worlds.new("black")
scene.world.color = (0, 0, 0)
black = material("black", "ShaderNodeBsdfDiffuse")
# The outlines run from the axis outwards and down, so that normals face out.
dome = [(LIMBUS * i / 400, APEX - sag(LIMBUS * i / 400)) for i in range(401)]
side, floor = math.sqrt(R * R - IRIS**2) - 0.02, IRIS - 0.3
wall = [(LIMBUS + (side - LIMBUS) * i / 8, LIMBUS_Z + (floor - LIMBUS_Z) * i / 8) for i in range(1, 9)]
cornea = lathe("cornea", dome, material("glass", "ShaderNodeBsdfGlass", (1, 1, 1), INDEX))
iris = lathe("iris", [(PUPIL, IRIS), (side - 0.05, IRIS)], material("iris", "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5)))
lathe("pupil", [(0, IRIS - 0.01), (PUPIL + 0.1, IRIS - 0.01)], black)
lathe("inside", [(LIMBUS - 0.001, LIMBUS_Z - 0.002), *((r - 0.01, z) for r, z in wall)], black)
tilt = math.asin(LIMBUS / R)
ball = [(R * math.sin(tilt + (math.pi - tilt) * i / 300), R * math.cos(tilt + (math.pi - tilt) * i / 300)) for i in range(300)]
lathe("sclera", [*ball, (0, -R)], material("sclera", "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8)))

sun = bpy.data.lights.new("sun", "SUN")
sun.energy, sun.angle = math.pi, math.radians(0.5)
lamp = bpy.data.objects.new("sun", sun)
lamp.rotation_mode = "QUATERNION"
lamp.rotation_quaternion = LIGHT.to_track_quat("Z", "Y")
scene.collection.objects.link(lamp)
sun.cycles.is_caustics_light = True
cornea.cycles.is_caustics_caster = True
iris.cycles.is_caustics_receiver = True

camera = bpy.data.cameras.new("camera")
camera.sensor_fit = "HORIZONTAL"
camera.angle = 2 * math.atan(1.15 * R / CAMERA.length)
eye = bpy.data.objects.new("camera", camera)
back = CAMERA.normalized()
right = Vector((0, 1, 0)).cross(back).normalized()
up = back.cross(right)
eye.matrix_world = Matrix.Translation(CAMERA) @ Matrix((right, up, back)).transposed().to_4x4()
scene.collection.objects.link(eye)
scene.camera = eye

scene.render.engine = "CYCLES"
scene.cycles.samples = int(words[1]) if len(words) > 1 else 512
scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
scene.cycles.max_bounces = 8
scene.cycles.diffuse_bounces = 1  # 0 would switch the manifold estimation off
scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = True
scene.cycles.sample_clamp_indirect = 0
scene.cycles.filter_width = 0.01
scene.render.resolution_x = scene.render.resolution_y = SIDE
scene.render.resolution_percentage = 100
scene.render.film_transparent = False
scene.view_settings.view_transform = "Raw"
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = words[0]
bpy.ops.render.render(write_still=True)
