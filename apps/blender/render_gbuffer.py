"""Renders the G-buffer, the shadow maps and the scene file that `pellucid shade` takes, in Blender:

    blender -b [FILE.blend] --python render_gbuffer.py -- [MESH] -o DIR [--size WxH] ...
    pellucid shade DIR/gbuffer.exr --scene DIR/scene.toml -o picture.exr

`-- --help` lists the options; docs/guide/blender.md has the steps and the conventions. Debian's Blender 3.4
has no NumPy, so this uses none. The .blend file is never written.
"""

import argparse
import os
import shutil
import sys
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from gbuffer import eyes, fault, geometry, lights, passes, principled, scene_file, surface  # noqa: E402
from gbuffer.fault import Fault  # noqa: E402


def size(text):
    try:
        width, height = (int(part) for part in text.split("x"))
    except ValueError:
        width = height = 0
    if width < 4 or height < 4:  # Blender's least
        raise argparse.ArgumentTypeError(f"'{text}': it must be such as 1280x720, at least 4x4")
    return width, height


def positive(text):
    try:
        value = float(text)
    except ValueError:
        value = 0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}': a number above 0 is needed")
    return value


def pellucid_command():
    if "PELLUCID_COMMAND" in os.environ:
        return os.environ["PELLUCID_COMMAND"]
    here = os.path.dirname(os.path.abspath(__file__))
    beside = [os.path.abspath(os.path.join(here, *way, "bin", "pellucid"))
              for way in (("..", "..", "build", "release"), ("..", "..", ".."))]
    return shutil.which("pellucid") or next(filter(os.path.exists, beside), "pellucid")


def arguments():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="blender -b [FILE.blend] --python render_gbuffer.py --",
                                     description="Renders G-buffer and scene for `pellucid shade`.")
    parser.add_argument("mesh", nargs="?",
                        help="OBJ, PLY, STL or OFF to add; without FILE.blend the only object")
    parser.add_argument("-o", "--output", required=True, metavar="DIR",
                        help="folder, created if missing")
    parser.add_argument("--size", type=size, metavar="WxH",
                        help="pixels (default: the .blend file's, else 1024x1024)")
    parser.add_argument("--frame", type=int, help="frame of an animation (default: the current one)")
    parser.add_argument("--unit", type=positive, metavar="MM",
                        help="millimetres per Blender unit (default: the .blend file's unit scale, else 1)")
    parser.add_argument("--height", type=positive, metavar="MM", help="scales MESH to this height")
    parser.add_argument("--up", choices=("y", "z"), default="z",
                        help="MESH's up axis: z looks to -y, y looks to +z (default z)")
    parser.add_argument("--shadow-size", type=int, default=1024, metavar="N",
                        help="texels a side (default 1024)")
    parser.add_argument("--smooth", type=int, default=4, metavar="N",
                        help="smoothing passes of the curvature (default 4)")
    parser.add_argument("--half", action="store_true",
                        help="half floats in gbuffer.exr; positions then carry 11 bits")
    parser.add_argument("--pellucid", default=pellucid_command(), metavar="COMMAND",
                        help="the pellucid command, which measures curvature (default: $PELLUCID_COMMAND, "
                             "else pellucid, else the one that was built or installed with this script)")
    parser.add_argument("--preset", metavar="NAME",
                        help="of materials that name none: auto (what their shader says: no Subsurface, no "
                             "scattering), plain, skin, or one of the library (auto; skin for a mesh alone)")
    parser.add_argument("--verbose", action="store_true", help="let Blender print what it does")
    parser.add_argument("--no-curvature", action="store_true", help="no curvature, so no direct scattering")
    options = parser.parse_args(words)
    if not options.mesh and not bpy.data.filepath:
        parser.error("there is nothing to render: name a .blend file before --python, or a mesh after --")
    if not 1 <= options.shadow_size <= 16384:
        parser.error("--shadow-size must be from 1 to 16384")
    if not 0 <= options.smooth <= 1000:
        parser.error("--smooth must be from 0 to 1000")
    return options


def main():
    options = arguments()
    fault.VERBOSE = options.verbose
    fallback = options.preset or (principled.AUTO if bpy.data.filepath else principled.SKIN)
    try:
        os.makedirs(options.output, exist_ok=True)
    except OSError as error:
        raise Fault(f"-o {options.output}: {error.strerror}") from None
    if bpy.data.filepath:
        source = bpy.context.scene
        unit = options.unit or 1000 * source.unit_settings.scale_length  # Blender's scale is in metres
    else:  # Blender starts with a cube, a lamp and a camera
        for thing in list(bpy.data.objects):
            bpy.data.objects.remove(thing)
        source = bpy.context.scene
        source.world = None
        unit = options.unit or 1.0
    if options.frame is not None:
        source.frame_set(options.frame)
    if options.mesh:
        geometry.load(options, unit)
    scene = bpy.data.scenes.new("pellucid")
    things = geometry.realise(source, scene)
    if not options.no_curvature:
        geometry.measure_curvature(things, options.pellucid, options.smooth)
    found = eyes.find(things, unit)
    materials = surface.prepare(things)
    bounds = geometry.Bounds(things)
    frame = passes.frame_size(source, options)
    camera = passes.add_camera(source, scene, bounds, frame)
    lamps = lights.gather(source, scene, bounds)
    passes.prepare(scene, frame)
    passes.warn_if_out_of_view(scene, camera, things)
    passes.render_gbuffer(scene, camera, os.path.join(options.output, "gbuffer.exr"), options.half)
    for thing in things:  # to the cameras of shadow maps
        thing.visible_camera = thing.visible_shadow
    taken = set()
    for lamp in lamps:
        lights.render_shadow_map(scene, lamp, bounds, options, taken)
    sky = lights.ambient(source, options.output)
    scene_file.write(os.path.join(options.output, "scene.toml"), unit, passes.viewpoint(camera, bounds),
                     lamps, sky, materials, found, not options.no_curvature, fallback)
    print(f"pellucid: {options.output}/gbuffer.exr, {options.output}/scene.toml", flush=True)


if __name__ == "__main__":
    try:
        main()
    except (Fault, OSError) as reason:
        print(f"render_gbuffer.py: {reason}", file=sys.stderr, flush=True)
        os._exit(3)  # Blender turns sys.exit into success
    except SystemExit as stop:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(int(stop.code or 0))
    except Exception:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)
