"""The lights of the scene file, their shadow maps, and the light of the world."""

import math
import os

import bpy
from mathutils import Matrix, Vector

from . import file_names
from .fault import warn
from .passes import look, render_exr


class Lamp:
    """A light as keys of [[light]], and of [light.shadow_map] once that is rendered. Blender's watts spread
    over 4 pi: a point light of P watts gives irradiance P / (4 pi d^2), so that irradiance / pi at distance 1
    is P / (4 pi^2). An area light's radiance is P / (pi A), which gives P / pi^2; before Blender 4.0 it is
    P / (4 A). A sun's strength is irradiance itself."""

    def __init__(self, name, data, matrix):
        self.name, self.kind = name, data.type
        self.position = matrix.translation.copy()
        self.forward = (matrix.to_3x3() @ Vector((0, 0, -1))).normalized()
        area = math.pi if bpy.app.version >= (4, 0) else 4
        share = {"SUN": 1, "AREA": 1 / area}.get(data.type, 1 / (4 * math.pi)) / math.pi
        share *= data.energy * 2 ** getattr(data, "exposure", 0)  # Blender 4.5 and newer
        warmth = data.temperature_color if getattr(data, "use_temperature", False) else (1, 1, 1)
        self.casts_shadow = getattr(data.cycles, "cast_shadow", data.use_shadow)  # one for all from 4.2 on
        self.keys = {"type": {"SUN": "directional", "AREA": "rectangle"}.get(data.type, data.type.lower()),
                     "color": [c * w * share for c, w in zip(data.color, warmth)]}
        if data.type == "SUN":
            self.keys["to_light"] = tuple(-self.forward)
        else:
            self.keys["position"] = tuple(self.position)
        if data.type == "SPOT":
            self.angle, dark = data.spot_size, math.cos(data.spot_size / 2)
            self.keys.update(spot_direction=tuple(self.forward), spot_cos_outer=dark,
                             spot_cos_inner=dark + (1 - dark) * data.spot_blend)
        if data.type == "AREA":
            half_width, half_height = half_sides(data, matrix)
            self.keys.update(half_width=tuple(half_width), half_height=tuple(half_height))
        self.shadow = None


def gather(source, scene, bounds):
    """The source scene's lights; without any, a sun from the side. Copies go to `scene`, suns, points and
    spots without their size."""
    lamps = []
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        thing = instance.object
        if thing.type != "LIGHT" or not thing.data.energy > 0:
            continue
        if thing.data.type == "AREA" and thing.data.cycles.is_portal:
            continue
        add(scene, lamps, thing.name, thing.data.copy(), instance.matrix_world.copy())
    if not lamps:
        if source.world is None:
            data = bpy.data.lights.new("sun", "SUN")
            data.energy = math.pi
            add(scene, lamps, "sun", data, look(bounds.centre, Vector((-0.8, 0.5, -0.35)).normalized()))
        else:
            warn("there is no light but the world's")
    return lamps


def half_sides(data, matrix):
    """Of an area light that looks along -z; of disks and ellipses those of the rectangle of the same area."""
    share = math.sqrt(math.pi) / 4 if data.shape in ("DISK", "ELLIPSE") else 1 / 2
    height = data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size
    turned = matrix.to_3x3()
    return turned @ Vector((share * data.size, 0, 0)), turned @ Vector((0, -share * height, 0))


def surface(data, matrix):
    """What the light's strength is multiplied by if it is per area or solid angle."""
    if data.type == "SUN":
        return math.pi * math.sin(data.angle / 2) ** 2 or 1
    if data.type != "AREA":
        return 4 * math.pi * data.shadow_soft_size**2 or 4
    width, height = half_sides(data, matrix)
    return 4 * width.length * height.length


def emission(name, data):
    """What a light's nodes multiply it by."""
    output = data.node_tree.get_output_node("CYCLES") if data.use_nodes else None
    if output is None:
        return 1, 1, 1
    node = output.inputs["Surface"].links[0].from_node if output.inputs["Surface"].is_linked else None
    emits = node is not None and node.type == "EMISSION"
    if not emits or any(i.is_linked for i in node.inputs):
        warn(f"light '{name}': of its nodes only the numbers of an Emission node count")
    if not emits:
        return 1, 1, 1
    return [c * node.inputs["Strength"].default_value for c in node.inputs["Color"].default_value[:3]]


def add(scene, lamps, name, data, matrix):
    if data.type == "AREA" and data.spread < 3.14:
        warn(f"area light '{name}' shines to all sides: a rectangle of a scene has no spread")
        data.spread = math.pi
    if not getattr(data, "normalize", True):  # Blender 4.5 and newer
        data.energy *= surface(data, matrix)
        data.normalize = True
    if data.type == "SUN":
        data.angle = 0
    elif data.type != "AREA":
        data.shadow_soft_size = 0
    data.color = [c * e for c, e in zip(data.color, emission(name, data))]
    data.use_nodes = False
    thing = bpy.data.objects.new(f"pellucid {name}", data)
    thing.matrix_world = matrix
    scene.collection.objects.link(thing)
    lamps.append(Lamp(name, data, matrix))


def render_shadow_map(scene, lamp, bounds, options, taken):
    """Depths seen from a sun, a spot or the centre of an area, 0 near to 1 far; 1 where nothing is. `taken`:
    other lights' files."""
    if not lamp.casts_shadow:
        return
    if lamp.kind == "POINT":
        warn(f"light '{lamp.name}' is a point light: no shadow map is rendered for it")
        return
    file = file_names.unique("shadow", lamp.name, ".exr", taken)
    camera = bpy.data.objects.new("pellucid shadow", bpy.data.cameras.new("pellucid shadow"))
    scene.collection.objects.link(camera)
    rotation = lamp.forward.to_track_quat("-Z", "Y").to_matrix()  # the light's own may be mirrored or skewed
    right, up = rotation.col[0].copy(), rotation.col[1].copy()
    corners = bounds.corners()
    along = [lamp.forward.dot(c) for c in corners]
    margin = 0.02 * bounds.radius
    if lamp.kind == "SUN":
        across, upward = [right.dot(c) for c in corners], [up.dot(c) for c in corners]
        lamp.extent = max(max(across) - min(across), max(upward) - min(upward)) + 2 * margin
        near, deep = min(along) - margin, max(along) - min(along) + 2 * margin
        middle = (max(across) + min(across)) / 2, (max(upward) + min(upward)) / 2
        # Depth is measured from the camera, which therefore stands on the near plane.
        camera.matrix_world = Matrix.Translation(right * middle[0] + up * middle[1] +
                                                 lamp.forward * near) @ rotation.to_4x4()
        camera.data.type, camera.data.ortho_scale = "ORTHO", lamp.extent
        camera.data.clip_start, camera.data.clip_end = 0, deep
        to_shadow = [*(right / lamp.extent), 0.5 - middle[0] / lamp.extent,
                     *(up / -lamp.extent), 0.5 + middle[1] / lamp.extent,
                     *(lamp.forward / deep), -near / deep, 0, 0, 0, 1]
        depths, encode = {"projection": "parallel", "depth_range": deep}, ("LINEAR", 1 / deep, 0.0)
    else:
        eye = lamp.forward.dot(lamp.position)
        far = max(1.01 * (max(along) - eye), 1e-3 * bounds.radius)
        near = min(max(0.99 * (min(along) - eye), 1e-3 * far), 0.9 * far)
        camera.matrix_world = Matrix.Translation(lamp.position) @ rotation.to_4x4()
        if lamp.kind == "AREA":  # all that is before it
            aside = [max(abs((c - lamp.position).dot(right)), abs((c - lamp.position).dot(up))) /
                     max((c - lamp.position).dot(lamp.forward), near) for c in corners]
            lamp.angle = 2 * math.atan(1.02 * max(aside))
        camera.data.angle = min(lamp.angle, math.radians(170))
        camera.data.clip_start, camera.data.clip_end = near, far
        extent = 2 * math.tan(camera.data.angle / 2)  # of the map at distance 1
        a, b = 1 / far - 1 / near, 1 / near  # 1 / distance is linear in z: 1 / (a z + b)

        def row(axis, w):
            return [*(axis + w * lamp.forward), -lamp.position.dot(axis + w * lamp.forward)]

        z = row(Vector((0, 0, 0)), -b / a)
        z[3] += 1 / a
        to_shadow = [*row(right / extent, 0.5), *row(up / -extent, 0.5), *z, *row(Vector((0, 0, 0)), 1)]
        depths = {"projection": "perspective", "depth_a": a, "depth_b": b}
        encode = ("INVERSE", 1 / a, -b / a)
    lamp.shadow = {"file": file, "world_to_shadow": to_shadow, **depths}
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = options.shadow_size
    write_depth(scene, os.path.join(options.output, file), *encode)


def depth_material(kind, factor, offset):
    """Emits depth * factor + offset, or factor / depth + offset, from 0 to 1; depth along the view axis."""
    material = bpy.data.materials.new("pellucid depth")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    value = nodes.new("ShaderNodeCameraData").outputs["View Z Depth"]
    for operation, operand in (("MULTIPLY" if kind == "LINEAR" else "DIVIDE", factor), ("ADD", offset)):
        step = nodes.new("ShaderNodeMath")
        step.operation, step.use_clamp = operation, operation == "ADD"
        first, second = (1, 0) if operation == "DIVIDE" else (0, 1)
        links.new(value, step.inputs[first])
        step.inputs[second].default_value = operand
        value = step.outputs[0]
    emission = nodes.new("ShaderNodeEmission")
    links.new(value, emission.inputs["Strength"])
    links.new(emission.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def white_world():
    """Depth 1 where nothing is."""
    world = bpy.data.worlds.new("pellucid depth")
    world.use_nodes = True
    nodes = world.node_tree.nodes
    nodes.clear()
    background = nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    world.node_tree.links.new(background.outputs[0], nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
    world.cycles.sampling_method = "NONE"  # it lights nothing
    return world


def write_depth(scene, path, kind, factor, offset):
    """Renders depth as light that surfaces emit, for Blender 5 has another compositor than its predecessors.
    """
    layer, world = scene.view_layers[0], scene.world
    layer.material_override, scene.world = depth_material(kind, factor, offset), white_world()
    render_exr(scene, path)
    layer.material_override, scene.world = None, world


def ambient(source, folder):
    """Nine spherical harmonics of irradiance / pi from the world, as the scene file has them, or None."""
    if source.world is None:
        return None
    width, height = 64, 32
    scene = bpy.data.scenes.new("pellucid sky")
    scene.world = source.world
    scene.world.cycles.sampling_method = "NONE"  # nothing is lit by it here, and its map takes a second
    camera = bpy.data.objects.new("pellucid sky", bpy.data.cameras.new("pellucid sky"))
    camera.data.type = "PANO"
    lens = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles  # Blender 3
    lens.panorama_type = "EQUIRECTANGULAR"
    camera.matrix_world = look(Vector((0, 0, 0)), Vector((0, 1, 0)))
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 16, False
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    render_exr(scene, os.path.join(folder, ".sky.exr"))
    image = bpy.data.images.load(scene.render.filepath)
    pixels = list(image.pixels)
    os.remove(scene.render.filepath)
    sums = [[0.0] * 3 for _ in range(9)]
    for y in range(height):  # Blender's first row is the lowest
        up = (y + 0.5) / height * math.pi - math.pi / 2
        area = math.cos(up) * (math.pi / height) * (2 * math.pi / width)
        for x in range(width):
            round_ = (x + 0.5) / width * 2 * math.pi - math.pi  # from the middle, +y, to the right
            basis = harmonics(math.cos(up) * math.sin(round_), math.cos(up) * math.cos(round_), math.sin(up))
            for i in range(9):
                for c in range(3):
                    sums[i][c] += basis[i] * pixels[4 * (y * width + x) + c] * area
    # The clamped cosine over pi, per order: 1, 2/3, 1/4 [Ramamoorthi and Hanrahan 2001].
    share = [1] + [2 / 3] * 3 + [1 / 4] * 5
    return [[share[i] * v for v in sums[i]] for i in range(9)]


def harmonics(x, y, z):
    """Orthonormal, real, orders 0 to 2, in the order of PelAmbient."""
    a, b, c = math.sqrt(1 / (4 * math.pi)), math.sqrt(3 / (4 * math.pi)), math.sqrt(15 / (4 * math.pi))
    return [a, b * y, b * z, b * x, c * x * y, c * y * z, math.sqrt(5 / (16 * math.pi)) * (3 * z * z - 1),
            c * x * z,
            0.5 * c * (x * x - y * y)]
