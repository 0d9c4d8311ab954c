"""Meshes: loads files, converts all that Blender renders to plain meshes, measures curvature."""

import array
import math
import os
import struct
import subprocess
import tempfile

import bpy
from mathutils import Matrix, Vector

from .fault import Fault, warn

CURVATURE = "pellucid_curvature"  # vertex attribute, 1/Blender unit
RENDERED = ("MESH", "CURVE", "SURFACE", "FONT", "META")


class Bounds:
    """The box round everything, in Blender units."""

    def __init__(self, things):
        corners = [thing.matrix_world @ Vector(corner) for thing in things for corner in thing.bound_box]
        self.low = Vector(min(c[i] for c in corners) for i in range(3))
        self.high = Vector(max(c[i] for c in corners) for i in range(3))
        self.centre = (self.low + self.high) / 2
        self.radius = max((self.high - self.low).length / 2, 1e-6)

    def corners(self):
        box = (self.low, self.high)
        return [Vector((box[i & 1][0], box[i >> 1 & 1][1], box[i >> 2 & 1][2])) for i in range(8)]


def load(options, unit):
    """Adds options.mesh to the current scene: Z up, in Blender units, which the file's own is taken to be."""
    path = options.mesh
    if not os.path.isfile(path):
        raise Fault(f"{path}: there is no such file")
    before = set(bpy.data.objects)
    extension = os.path.splitext(path)[1].lower()
    if extension == ".obj":  # by Blender, for its texture coordinates and materials
        forward, up = ("Y", "Z") if options.up == "z" else ("NEGATIVE_Z", "Y")
        # Blender 3.3
        if "Y_FORWARD" in bpy.ops.wm.obj_import.get_rna_type().properties["forward_axis"].enum_items:
            forward, up = forward + "_FORWARD", up + "_UP"
        bpy.ops.wm.obj_import(filepath=path, forward_axis=forward, up_axis=up)
    elif extension in (".ply", ".stl", ".off"):
        load_ply(path, options.pellucid, options.up)
    else:
        raise Fault(f"{path}: OBJ, PLY, STL or OFF is needed; save other formats as .blend files")
    things = [thing for thing in bpy.data.objects if thing not in before and thing.type == "MESH"]
    if not things or not any(len(thing.data.polygons) for thing in things):
        raise Fault(f"{path}: there are no faces in it")
    for thing in things:
        smooth = [True] * len(thing.data.polygons)
        thing.data.polygons.foreach_set("use_smooth", smooth)
    if options.height:
        bpy.context.view_layer.update()
        box = Bounds(things)
        tall = box.high.z - box.low.z
        if not tall > 0:
            raise Fault(f"{path}: it is flat along its up axis, so --height cannot scale it; is --up right?")
        for thing in things:
            thing.matrix_world = Matrix.Scale(options.height / unit / tall, 4) @ thing.matrix_world
    bpy.context.view_layer.update()


def run(command, pellucid):
    try:
        done = subprocess.run([pellucid, *command], capture_output=True, text=True)
    except OSError as error:
        raise Fault(f"cannot run '{pellucid}' ({error.strerror}): give its path with --pellucid or "
                    f"PELLUCID_COMMAND, or leave curvature out with --no-curvature") from None
    if done.returncode:
        raise Fault(f"{pellucid} {command[0]}: {done.stderr.strip() or f'exit code {done.returncode}'}")


def load_ply(path, pellucid, up):
    """Loads a mesh by `pellucid curvature`, which reads all of these formats and writes a PLY file with
    4-byte fields, a colour, and triangles."""
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "mesh.ply")
        run(["curvature", path, "-o", copy], pellucid)
        with open(copy, "rb") as file:
            data = file.read()
    header, body = data.split(b"end_header\n", 1)
    counts = {line.split()[1]: int(line.split()[2]) for line in header.decode().splitlines()
              if line.startswith("element")}
    step = 0
    for line in header.decode().splitlines():
        if line.startswith("property list"):
            break
        if line.startswith("property"):
            step += 1 if line.split()[1] == "uchar" else 4
    vertices = [struct.unpack_from("<3f", body, i * step) for i in range(counts["vertex"])]
    if up == "y":
        vertices = [(x, -z, y) for x, y, z in vertices]
    start = counts["vertex"] * step
    faces = [struct.unpack_from("<3I", body, start + 13 * i + 1) for i in range(counts["face"])]
    name = os.path.basename(path)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def show_as_rendered(source):
    """Makes the view layer, of which Blender tells the evaluated objects, show what a render shows."""
    source.render.simplify_subdivision = source.render.simplify_subdivision_render
    for collection in bpy.data.collections:
        collection.hide_viewport = collection.hide_render
    layers = [bpy.context.view_layer.layer_collection]
    for layer in layers:  # which grows
        layer.hide_viewport = False
        layers += layer.children
    for thing in bpy.context.view_layer.objects:
        thing.hide_set(False)
    for particles in bpy.data.particles:
        particles.display_percentage = 100
        children = "child_percent" if hasattr(particles, "child_percent") else "child_nbr"  # Blender 3
        setattr(particles, children, particles.rendered_child_count)
    for thing in bpy.data.objects:  # those of instanced collections too
        thing.hide_viewport = thing.hide_render
        thing.show_instancer_for_viewport = thing.show_instancer_for_render
        for modifier in thing.modifiers:
            modifier.show_viewport = modifier.show_render
            if modifier.type in ("SUBSURF", "MULTIRES"):
                modifier.levels = modifier.render_levels
    bpy.context.view_layer.update()


def realise(source, scene):
    """Everything that the source scene renders, as plain meshes in world space, linked to `scene`."""
    show_as_rendered(source)
    override = bpy.context.view_layer.material_override
    graph = bpy.context.evaluated_depsgraph_get()
    things, left_out = [], set()
    for instance in graph.object_instances:
        thing = instance.object
        if not instance.show_self:
            continue
        if thing.type != thing.original.type:
            continue  # the mesh of a text or curve, which comes besides; Blender 3.4 crashes on taking it
        if any(p.settings.type == "HAIR" and p.settings.render_type == "PATH"
               for p in thing.particle_systems):
            left_out.add(f"hair of {thing.name}")
        if thing.type in ("VOLUME", "CURVES", "HAIR", "POINTCLOUD"):
            left_out.add(thing.name)
        if thing.type not in RENDERED:
            continue
        mesh = bpy.data.meshes.new_from_object(thing, preserve_all_data_layers=True, depsgraph=graph)
        if not mesh.polygons:
            continue
        mesh.transform(instance.matrix_world)
        if instance.matrix_world.determinant() < 0:
            mesh.flip_normals()
        for i, slot in enumerate(thing.material_slots):  # materials may belong to the object
            if i < len(mesh.materials):
                mesh.materials[i] = slot.material
        if override:
            mesh.materials.clear()
            mesh.materials.append(override)
        made = bpy.data.objects.new(f"pellucid {thing.name}", mesh)
        made.pass_index = thing.original.pass_index or len(things) + 1
        made.visible_camera, made.visible_shadow = thing.visible_camera, thing.visible_shadow
        scene.collection.objects.link(made)
        things.append(made)
    if left_out:
        warn("left out, neither meshes nor curves: " + ", ".join(sorted(left_out)))
    if not things:
        raise Fault("no mesh in the scene is rendered")
    return things


def measure_curvature(things, pellucid, smooth):
    """Sets the attribute CURVATURE: 1/Blender unit, as `pellucid curvature` measures it."""
    with tempfile.TemporaryDirectory() as folder:
        ply, npy = os.path.join(folder, "mesh.ply"), os.path.join(folder, "curvature.npy")
        for thing in things:
            write_ply(ply, thing.name.removeprefix("pellucid "), thing.data)
            run(["curvature", ply, "-o", npy, "--smooth", str(smooth), "--weld", "exact"], pellucid)
            with open(npy, "rb") as file:
                data = file.read()
            values = array.array("f", data[10 + struct.unpack_from("<H", data, 8)[0] :])
            attribute = thing.data.attributes.new(CURVATURE, "FLOAT", "POINT")
            attribute.data.foreach_set("value", values)


def write_ply(path, name, mesh):
    mesh.calc_loop_triangles()
    positions = array.array("f", bytes(12 * len(mesh.vertices)))
    mesh.vertices.foreach_get("co", positions)
    if not all(map(math.isfinite, positions)):
        raise Fault(f"{name}: it has vertices at NaN or Inf")
    corners = array.array("i", bytes(12 * len(mesh.loop_triangles)))
    mesh.loop_triangles.foreach_get("vertices", corners)
    faces = corners.tobytes()
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\n")
        file.write(f"element vertex {len(mesh.vertices)}\n".encode())
        file.write(b"property float x\nproperty float y\nproperty float z\n")
        file.write(f"element face {len(mesh.loop_triangles)}\nproperty list uchar int "
                   f"vertex_indices\nend_header\n".encode())
        file.write(positions.tobytes())
        file.write(b"".join(b"\3" + faces[i : i + 12] for i in range(0, len(faces), 12)))
