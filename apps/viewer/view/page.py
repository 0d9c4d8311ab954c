"""The page: the picture, and the panels of settings."""
from __future__ import annotations

import functools
import io
import json
import tempfile
import zipfile
from pathlib import Path
from typing import Any, Callable

from fastapi import WebSocket
from nicegui import app, events, ui

from .. import files
from .export import export
from .look import Look
from .panels import ComparePanel, EyesPanel, LightsPanel, MaterialPanel, PicturePanel, ProfilePanel, SkinPanel
from .scene_page import SceneExportPanel, SceneLightsPanel, SceneMaterialsPanel, ScenePanel
from .scene_session import SceneSession
from .server import Viewer
from .session import UNITS
from .widgets import Panel, fail

HERE = Path(__file__).parent
MESHES = ".obj", ".ply", ".stl", ".off", ".glb"
VIEWS = {"1": (0.0, 0.0), "3": (90.0, 0.0), "7": (0.0, 89.0)}  # azimuth and elevation
KEYS = (("drag", "turn"), ("shift and drag", "move"), ("wheel", "nearer, further"),
        ("ctrl and drag", "move the key light"), ("ctrl, shift and drag", "turn the surroundings"),
        ("alt and drag", "move the line between two settings"),
        ("double click", "turn about this point"), ("F", "frame the object"),
        ("1, 3, 7", "from the front, its left, above; with ctrl from the other side"),
        ("ctrl-Z, ctrl-Y", "undo, redo"), ("arrow keys", "step the slider that was clicked last"),
        ("?", "this list"))


class StatisticsPanel(Panel):
    name, open = "Statistics", True

    def build(self) -> None:
        self.bars: dict[str, Any] = {}
        for name in ("OpenGL", "Pellucid", "on the device", "JPEG"):
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                ui.label(name).classes("text-xs").style("width:6rem")
                self.bars[name] = ui.linear_progress(value=0, show_value=False).style("flex:1")
                self.bars[name + " ms"] = ui.label().classes("text-xs text-right").style("width:4rem")
        self.counts = ui.label().classes("text-xs").style("white-space:pre-line").props("data-pel=counts")
        self.switch("Count pixels (slightly slower)", self.viewer.session, "count")

    def update(self) -> None:
        frame = self.viewer.last
        if frame is None:
            return
        longest = max(50.0, *frame.milliseconds.values())
        for name, ms in frame.milliseconds.items():
            if name in self.bars:
                self.bars[name].set_value(min(1.0, ms / longest))
                self.bars[name + " ms"].set_text(f"{ms:.1f} ms")
        if not (c := frame.counts):  # of a picture without Pellucid
            return
        lines = [f"tiles shaded {c['tiles_shaded']} of {c['tiles_total']}",
                 f"pixels shaded {c['pixels_shaded']} of {c['pixels_total']}",
                 f"launches {c['launches']}, scratch {c['scratch_bytes'] / 2**20:.1f} MiB"]
        if self.viewer.session.count:
            lines += [f"{name.replace('_', ' ')} {value}" for name, value in c.items()
                      if name.startswith(("pixels_", "tiles_by", "taps"))
                      and name not in ("pixels_total", "pixels_shaded")]
        lines.append(f"kernels compiled {frame.kernels}, {frame.compiled} of them for the last picture")
        lines += ["warning: " + w for w in frame.warnings]
        self.counts.set_text("\n".join(lines))


class MeshPanel(Panel):
    name = "Mesh"

    async def change(self, act: Callable[[], Any], of: str = "") -> bool:
        """Changes the mesh on the session's thread; where that fails, the previous one stays."""
        try:
            await self.viewer.on_thread(act)
        except Exception as error:
            fail(f"{of}{error}")
            return False
        self.viewer.rebuild()
        return True

    async def load(self, path: Any) -> bool:
        session, client = self.viewer.session, ui.context.client

        def act() -> None:
            session.load(path)
            self.viewer.new_object()

        if not await self.change(act):
            return False
        counts = f"{len(session.mesh.positions)} vertices, {len(session.mesh.triangles)} triangles"
        with client:  # the widget that called is gone
            ui.notify(f"{counts}; {session.told}" if session.told else counts, multi_line=True)
            self.question()
        return True

    def question(self) -> None:
        """If the object is too small or too large for its unit to be right, asks for the unit."""
        session = self.viewer.session
        better = session.better_unit()
        if better is None:
            return
        with ui.dialog(value=True).props("persistent data-pel=unit-dialog") as dialog, ui.card():
            ui.label(f"{session.size_text()} Are its lengths in {UNITS[better]}?")
            with ui.row():
                async def accept() -> None:
                    dialog.close()
                    await self.change(lambda: session.set_unit(better))

                ui.button(f"Yes: {UNITS[better]}", on_click=accept).props("dense data-pel=unit-yes")
                ui.button("No: keep the unit", on_click=dialog.close).props("dense flat data-pel=unit-no")

    def build(self) -> None:
        session = self.viewer.session

        async def dropped(e: events.UploadEventArguments) -> bool:
            ending = Path(e.file.name).suffix.lower()
            if ending not in MESHES:
                fail(f"{e.file.name}: a mesh is needed, {', '.join(MESHES)}")
                return False
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / ("mesh" + ending)
                path.write_bytes(await e.file.read())
                return await self.load(path)

        async def painted(kind: str, e: events.UploadEventArguments) -> bool:
            path = self.viewer.keep(e.file.name, await e.file.read())
            return await self.change(lambda: session.paint_skin(kind, path), f"{e.file.name}: ")

        for which in ("female", "male"):
            self.button(f"Head, {which}", functools.partial(self.load, files.standard_head(which)),
                        f"head-{which}")
        self.upload("Drop an OFF, OBJ, PLY, STL or GLB file here", dropped, "upload")
        for kind, name in (("albedo", "Drop an albedo map of skin here"),
                           ("normal", "Drop a normal map of skin here")):
            self.upload(name, functools.partial(painted, kind), f"{kind}-upload", 1 << 28)
        if session.paint:
            self.button("Remove all pictures", lambda: self.change(lambda: session.show_bare()),
                        "bare", flat=True)

        names = UNITS if session.mm in UNITS else {session.mm: f"{session.mm:g} mm", **UNITS}
        ui.select(names, label="Unit of the mesh", value=session.mm,
                  on_change=lambda e: self.change(lambda: session.set_unit(e.value))).props(
                      "dense options-dense data-pel=unit").classes("w-full")
        ui.label(session.size_text()).classes("text-xs")

        async def restart() -> None:
            try:
                await self.viewer.restart()
            except Exception as error:
                fail(error)

        self.button("Reopen device", restart, "restart", flat=True)


class ExportPanel(Panel):
    name = "Export"

    def build(self) -> None:
        def pack() -> bytes:
            with tempfile.TemporaryDirectory() as folder:
                data = io.BytesIO()
                with zipfile.ZipFile(data, "w", zipfile.ZIP_STORED) as archive:
                    for path in export(self.viewer.session, Path(folder) / "pellucid-look"):
                        archive.write(path, f"pellucid-look/{path.name}")
                return data.getvalue()

        def draw() -> bytes:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "picture.png"
                files.write_image(path, self.viewer.session.still().smooth(1920, 1080))
                return path.read_bytes()

        def look() -> bytes:
            return json.dumps(self.look.to_dict(), indent=2).encode()

        for label, make, name, marker in (
                ("Scene, G-buffer, pictures (.zip)", pack, "pellucid-look.zip", "export"),
                ("Picture (.png, 1920 x 1080)", draw, "pellucid.png", "picture"),
                ("Look (.json)", look, "look.json", "look")):
            self.button(label, functools.partial(self.deliver, make, name), marker)

        async def read(e: events.UploadEventArguments) -> bool:
            try:
                self.viewer.session.look = Look.from_dict(json.loads(await e.file.read()))
            except (ValueError, TypeError, RecursionError) as error:
                fail(f"{e.file.name}: {error}")
                return False
            self.viewer.rebuild()
            return True

        self.upload("Load a look (.json)", read, "look-upload")


class Page:
    """The widgets of one open page, over the viewer that all pages share."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer = viewer
        ui.add_body_html(f"<script>\n{HERE.joinpath('client.js').read_text()}</script>")
        style, picture = HERE.joinpath("client.html").read_text().split("</style>")
        ui.add_head_html(style + "</style>")
        ui.query("body").style("margin:0")
        ui.query(".nicegui-content").classes("p-0 gap-0")
        ui.dark_mode(True)
        with ui.element("div").classes("pel-page"):
            ui.html(picture, sanitize=False).classes("pel-picture")
            self.column = ui.column().classes("pel-panels p-3 gap-1")
        self.statistics = StatisticsPanel(self)
        self.panels: list[Panel]
        if isinstance(viewer.session, SceneSession):
            self.panels = [ScenePanel(self), SceneMaterialsPanel(self), SceneLightsPanel(self),
                           self.statistics,
                           SceneExportPanel(self)]
        else:
            mesh = MeshPanel(self)
            profile = ProfilePanel(self)
            self.panels = [PicturePanel(self), MaterialPanel(self), SkinPanel(self, profile), EyesPanel(self),
                           LightsPanel(self), profile, ComparePanel(self), self.statistics, mesh,
                           ExportPanel(self)]
            mesh.question()
        self.build()
        viewer.pages.add(self)
        ui.timer(0.5, self.statistics.update)
        ui.keyboard(self.key)
        with ui.dialog().props("data-pel=keys") as self.keys, ui.card():
            for key, meaning in KEYS:
                with ui.row().classes("no-wrap gap-2"):
                    ui.label(key).classes("text-xs").style("width:9rem;color:#9cf")
                    ui.label(meaning).classes("text-xs")

    def key(self, e: events.KeyEventArguments) -> None:
        """A key that is pressed outside of entry fields."""
        if not e.action.keydown:
            return
        viewer, name = self.viewer, str(e.key).lower()
        away = e.modifiers.ctrl or e.modifiers.meta
        if away and name in ("z", "y"):
            if viewer.redo() if name == "y" or e.modifiers.shift else viewer.undo():
                viewer.rebuild()
        elif name == "?":
            self.keys.open()
        elif name == "f" and hasattr(viewer.session, "orbit"):
            viewer.frame_object()
            viewer.changed()
        elif name in VIEWS and hasattr(viewer.session, "orbit"):
            azimuth, elevation = VIEWS[name]
            orbit = viewer.session.orbit
            orbit.azimuth = azimuth + 180 * away * (name != "7")
            orbit.elevation = elevation * (-1 if away else 1)
            viewer.changed()

    def follow(self) -> None:
        """Updates the widgets to values that another widget has set."""
        for value, element in self.shown:
            element.set_value(value())

    def build(self) -> None:
        self.shown: list[tuple[Callable[[], Any], Any]] = []  # what a widget is to show, and the widget
        self.column.clear()
        opened = self.viewer.memory.opened
        with self.column:
            ui.label("Pellucid").classes("text-lg")
            for panel in self.panels:
                if panel.name:
                    with ui.expansion(panel.name, value=opened.get(panel.name, panel.open),
                                      on_value_change=lambda e, name=panel.name: opened.update(
                                          {name: e.value})).classes("w-full"):
                        panel.build()
                else:
                    panel.build()


def serve(viewer: Viewer) -> None:
    """Adds the page and its socket to NiceGUI's application."""

    @ui.page("/", title="Pellucid")
    def page() -> None:
        Page(viewer)

    @app.websocket("/frames")
    async def frames(socket: WebSocket) -> None:
        await socket.accept()
        await viewer.stream(socket)
