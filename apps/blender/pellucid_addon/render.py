"""The button: another Blender renders a copy of the file to a G-buffer, which `pellucid shade` shades.

Nothing of the open file changes: no material, no setting, no path.
"""

import os
import shutil
import subprocess
import tempfile

import bpy

from . import properties

IMAGE, LOG = "Pellucid", "Pellucid log"
status = ""  # what is being done; not in the scene, which may be saved meanwhile
SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "script", "render_gbuffer.py")


class Failure(Exception):
    """A message for the user."""


def steps(scene, folder):
    """The steps in order, as (description, command). The copy of the file is in the folder."""
    settings, render = scene.pellucid, scene.render
    factor = int(settings.samples)
    size = [max(4, n * render.resolution_percentage // 100) * factor
            for n in (render.resolution_x, render.resolution_y)]
    addon = bpy.context.preferences.addons.get(__package__)
    device = ["--device",
              addon.preferences.device] if addon and addon.preferences and addon.preferences.device else []
    unit = ["--unit", str(settings.unit)] if settings.unit > 0 else []
    scripts = [] if bpy.app.autoexec_fail else ["--enable-autoexec"]  # of drivers, as they run here
    yield "G-buffer", [bpy.app.binary_path, "--factory-startup", *scripts,
                       "-b", os.path.join(folder, "scene.blend"),
                       "--python", SCRIPT, "--", "-o", folder,
                       "--size", f"{size[0]}x{size[1]}", "--frame", str(scene.frame_current), "--shadow-size",
                       str(settings.shadow_size),
                       "--pellucid", properties.command(), *unit]
    yield "shading", [properties.command(), "shade", os.path.join(folder, "gbuffer.exr"), "--scene",
                      os.path.join(folder, "scene.toml"),
                      "-o", os.path.join(folder, "picture.exr"), "--picture",
                      os.path.join(folder, "picture.png"), "--exposure", str(settings.exposure), *device]


def failure_reason(log):
    """The last lines of a failed step's output, which tell why."""
    lines = [line for line in log.splitlines() if line.strip()]
    reasons = [line for line in lines if line.startswith(("render_gbuffer.py:", "pellucid:"))
            and "warning" not in line]
    return (reasons or lines or ["it printed no message"])[-1]


def save_log(text):
    block = bpy.data.texts.get(LOG) or bpy.data.texts.new(LOG)
    block.clear()
    block.write(text)


def show(folder, factor, path):
    """The picture as an image of the file, packed, and in an image editor if one is open."""
    image = bpy.data.images.load(os.path.join(folder, "picture.png"))
    if factor > 1:
        image.scale(image.size[0] // factor, image.size[1] // factor)
    image.pack()
    old = bpy.data.images.get(IMAGE)
    if old:
        old.user_remap(image)
        bpy.data.images.remove(old)
    image.name = IMAGE
    for window in bpy.context.window_manager.windows if bpy.context.window_manager else ():
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
                area.tag_redraw()
    if path:
        with open(path, "wb") as file:
            file.write(image.packed_file.data)


class PELLUCID_OT_render(bpy.types.Operator):
    """Render the scene with scattering into the image "Pellucid" """

    bl_idname = "pellucid.render"
    bl_label = "Render with Pellucid"

    filepath: bpy.props.StringProperty(name="PNG",
                                       description="File that the picture is also written to; empty: none",
                                       subtype="FILE_PATH", options={"SKIP_SAVE"})
    keep: bpy.props.StringProperty(name="Folder",
                                   description="Folder for G-buffer, shadow maps and scene.toml; empty: "
                                               "none", subtype="DIR_PATH", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        cls.poll_message_set("A picture is being rendered; Escape cancels it")
        return not status

    def begin(self, scene):
        self.factor = int(scene.pellucid.samples)
        self.folder = tempfile.mkdtemp(prefix="pellucid-")
        self.log = ""
        try:
            bpy.ops.wm.save_as_mainfile(filepath=os.path.join(self.folder, "scene.blend"), copy=True,
                                        compress=False)
        except RuntimeError as error:
            raise Failure(str(error)) from None
        painted = [i.name for i in bpy.data.images if i.is_dirty and i.type != "RENDER_RESULT"]
        if painted:
            self.report({"WARNING"}, "painted but not saved, so left out: " + ", ".join(painted))
        self.steps = steps(scene, self.folder)
        self.process = None

    def start(self):
        """The next step; False after the last."""
        global status
        step = next(self.steps, None)
        if step is None:
            return False
        self.what, command = step
        status = self.what + "..."
        self.output = open(os.path.join(self.folder, "log.txt"), "w+", encoding="utf-8", errors="replace")
        try:
            self.process = subprocess.Popen(command, stdout=self.output, stderr=subprocess.STDOUT,
                                            stdin=subprocess.DEVNULL)
        except OSError as error:
            raise Failure(f"cannot run '{command[0]}' ({error.strerror}): set the command in the add-on's "
                          f"preferences; pip install pellucid installs it") from None
        return True

    def done(self):
        """Whether the step that runs has ended. Raises if it failed."""
        if self.process.poll() is None:
            return False
        self.output.seek(0)
        text = self.output.read()
        self.output.close()
        self.log += f"== {self.what}\n{text}\n"
        if self.process.returncode:
            raise Failure(f"{self.what}: {failure_reason(text)}")
        return True

    def end(self, failure=None):
        """Puts the result in its place, and removes the folder."""
        global status
        status, result = "", {"FINISHED"}
        try:
            if failure is None:
                show(self.folder, self.factor, bpy.path.abspath(self.filepath) if self.filepath else "")
                if self.keep:
                    shutil.copytree(self.folder, bpy.path.abspath(self.keep), dirs_exist_ok=True,
                                    ignore=shutil.ignore_patterns("scene.blend", "log.txt"))
        except (OSError, RuntimeError) as error:
            failure = Failure(str(error))
        save_log(self.log)
        for line in self.log.splitlines():
            if line.startswith("render_gbuffer.py: warning:"):
                self.report({"WARNING"}, line[len("render_gbuffer.py: warning: "):])
        if failure is not None:
            self.report({"ERROR"}, f"{failure} (all of it is in the text '{LOG}')")
            result = {"CANCELLED"}
        shutil.rmtree(self.folder, ignore_errors=True)
        return result

    def execute(self, context):
        """To the end, as scripts want it."""
        try:
            self.begin(context.scene)
            while self.start():
                self.process.wait()
                self.done()
        except Failure as failure:
            return self.end(failure)
        return self.end()

    def invoke(self, context, event):
        """With the user interface alive; Escape cancels."""
        try:
            self.begin(context.scene)
            self.start()
        except Failure as failure:
            return self.end(failure)
        self.timer = context.window_manager.event_timer_add(0.2, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        failure = None
        if event.type == "ESC":
            self.stop()
            failure = Failure("cancelled")
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        else:
            try:
                if not self.done() or self.start():
                    for area in context.screen.areas if context.screen else ():
                        area.tag_redraw()
                    return {"RUNNING_MODAL"}
            except Failure as fault:
                failure = fault
        context.window_manager.event_timer_remove(self.timer)
        return self.end(failure)

    def stop(self):
        self.process.terminate()
        self.process.wait()
        self.output.close()

    def cancel(self, context):
        """Blender ends, or another file is opened."""
        global status
        status = ""
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)


register, unregister = bpy.utils.register_classes_factory((PELLUCID_OT_render,))
