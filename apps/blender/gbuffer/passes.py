"""The G-buffer: camera, passes and the settings that make every pixel one exact sample."""

import math

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

from .fault import Fault, quiet, warn
from .surface import AOVS

# Channel of the materials' pass indices. Blender 5 writes its passes' full names.
MATERIAL_CHANNEL = "Material Index.X" if bpy.app.version >= (5, 0) else "IndexMA.X"


def look(eye, forward):
    """Matrix of a camera at `eye`, upright; cameras look along their -z."""
    return Matrix.Translation(eye) @ forward.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def frame_size(source, options):
    """Pixels."""
    if options.size or not bpy.data.filepath:
        return options.size or (1024, 1024)
    render = source.render
    if render.pixel_aspect_x != render.pixel_aspect_y:  # Blender 5.0 fails to write them
        warn("the scene's pixels are not square; those of the G-buffer are")
    return tuple(max(4, n * render.resolution_percentage // 100)
                 for n in (render.resolution_x, render.resolution_y))


def add_camera(source, scene, bounds, size):
    """A copy of the source scene's camera, or one that frames everything from half left in front."""
    if source.camera:
        if source.camera.type != "CAMERA":
            raise Fault(f"the scene's camera is '{source.camera.name}', a {source.camera.type.lower()}")
        camera = bpy.data.objects.new("pellucid camera", source.camera.data.copy())
        evaluated = source.camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
        camera.matrix_world = evaluated.matrix_world.copy()
    else:
        camera = bpy.data.objects.new("pellucid camera", bpy.data.cameras.new("pellucid camera"))
        camera.data.angle = math.radians(25)
        away = Vector((math.sin(math.radians(25)), -math.cos(math.radians(25)), 0))
        right = Vector((-away.y, away.x, 0))
        slope = 0.92 * math.tan(camera.data.angle / 2)
        if size[0] > size[1]:  # the angle is that of the longer side
            across, upward = slope, slope * size[1] / size[0]
        else:
            across, upward = slope * size[0] / size[1], slope
        distance = 1.1 * bounds.radius
        for corner in bounds.corners():
            p = corner - bounds.centre
            distance = max(distance, away.dot(p) + max(abs(right.dot(p)) / across, abs(p.z) / upward))
        camera.matrix_world = look(bounds.centre + away * distance, -away)
        camera.data.clip_start, camera.data.clip_end = 0.01 * distance, distance + 2 * bounds.radius
    camera.data.dof.use_dof = False
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def viewpoint(camera, bounds):
    """Where the scene file says that it is seen from: of parallel rays a point far behind."""
    eye = camera.matrix_world.translation
    if camera.data.type == "ORTHO":
        eye = bounds.centre + 1e4 * bounds.radius * camera.matrix_world.col[2].xyz.normalized()
    return tuple(eye)


def warn_if_out_of_view(scene, camera, things):
    """Warns of an empty picture, which is seldom wanted and does not show its reason."""
    if camera.data.type == "PANO":  # which may see all round
        return
    for thing in things:
        corners = [world_to_camera_view(scene, camera, thing.matrix_world @ Vector(c))
                   for c in thing.bound_box]
        ahead = [p.z > 0 for p in corners]
        beside = all(ahead) and (max(p.x for p in corners) < 0 or min(p.x for p in corners) > 1 or
                                 max(p.y for p in corners) < 0 or min(p.y for p in corners) > 1)
        if any(ahead) and not beside:
            return
    warn(f"the camera sees none of the {len(things)} objects, so the picture will be empty: turn it to them, "
         "or remove it to get a camera that frames everything")


def prepare(scene, size):
    """One sample through each pixel's centre, no bounces, no tone mapping, the passes of the G-buffer."""
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.use_motion_blur = False
    render.dither_intensity = 0
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = 1
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 0.01
    cycles.max_bounces = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_position = layer.use_pass_normal = layer.use_pass_uv = True
    layer.use_pass_diffuse_color = layer.use_pass_object_index = layer.use_pass_material_index = True
    for name, kind in AOVS:
        aov = layer.aovs.add()
        aov.name, aov.type = name, kind


def render_exr(scene, path, layers=False, depth="32"):
    """Renders into an EXR file: the picture, or with `layers` every pass. `depth`: bits per channel."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5, where it decides which file formats there are
        settings.media_type = "MULTI_LAYER_IMAGE" if layers else "IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER" if layers else "OPEN_EXR"
    settings.color_depth, settings.exr_codec = depth, "ZIP"
    scene.render.filepath = path
    with quiet():
        try:
            bpy.ops.render.render(write_still=True, scene=scene.name)
        except RuntimeError as error:
            raise Fault(f"{path}: {error}") from None


def render_gbuffer(scene, camera, path, half):
    scene.camera = camera
    render_exr(scene, path, layers=True, depth="16" if half else "32")
