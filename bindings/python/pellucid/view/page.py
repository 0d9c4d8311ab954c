"""The page: the picture, and panels of what can be tuned."""
from __future__ import annotations

import io
import json
import tempfile
import zipfile
from pathlib import Path
from typing import Any

from fastapi import WebSocket
from nicegui import app, events, ui

from .. import files
from .client import PICTURE, SCRIPT
from .export import export
from .look import Look
from .panels import ComparePanel, EyesPanel, LightsPanel, MaterialPanel, PicturePanel, ProfilePanel
from .scene_page import SceneExportPanel, SceneLightsPanel, SceneMaterialsPanel, ScenePanel
from .scene_session import SceneSession
from .server import Viewer
from .widgets import Panel


class WorkPanel(Panel):
    name, open = "Time and work", True

    def build(self) -> None:
        self.bars: dict[str, Any] = {}
        for name in ("OpenGL", "Pellucid", "on the device", "JPEG"):
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                ui.label(name).classes("text-xs").style("width:6rem")
                self.bars[name] = ui.linear_progress(value=0, show_value=False).style("flex:1")
                self.bars[name + " ms"] = ui.label().classes("text-xs text-right").style("width:4rem")
        self.counts = ui.label().classes("text-xs").style("white-space:pre-line").props("data-pel=counts")

        def count(e: events.ValueChangeEventArguments) -> None:
            self.viewer.session.count = bool(e.value)
            self.viewer.changed()

        ui.switch("Count pixels (costs a little)", value=self.viewer.session.count, on_change=count).props("dense").classes("text-xs")

    def tell(self) -> None:
        frame = self.viewer.last
        if frame is None:
            return
        longest = max(50.0, *frame.milliseconds.values())
        for name, ms in frame.milliseconds.items():
            if name in self.bars:
                self.bars[name].set_value(min(1.0, ms / longest))
                self.bars[name + " ms"].set_text(f"{ms:.1f} ms")
        c = frame.counts
        lines = [f"tiles shaded {c['tiles_shaded']} of {c['tiles_total']}", f"pixels shaded {c['pixels_shaded']} of {c['pixels_total']}",
                 f"launches {c['launches']}, scratch {c['scratch_bytes'] / 2**20:.1f} MiB"]
        if self.viewer.session.count:
            lines += [f"{name.replace('_', ' ')} {value}" for name, value in c.items()
                      if name.startswith(("pixels_", "tiles_by", "taps")) and name not in ("pixels_total", "pixels_shaded")]
        lines.append(f"kernels compiled {frame.kernels}, for the last picture {frame.compiled}")
        lines += ["warning: " + w for w in frame.warnings]
        self.counts.set_text("\n".join(lines))


class MeshPanel(Panel):
    name = "Mesh"

    async def load(self, path: Any) -> None:
        try:
            mesh = await self.viewer.on_thread(lambda: self.viewer.session.load(path))
        except Exception as error:  # the mesh before it stays
            ui.notify(f"{error}", type="negative", multi_line=True, close_button=True, timeout=0)
            return
        ui.notify(f"{len(mesh.positions)} vertices, {len(mesh.triangles)} triangles")
        self.viewer.changed()

    def build(self) -> None:
        async def dropped(e: events.UploadEventArguments) -> None:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / ("mesh" + Path(e.file.name).suffix.lower())
                path.write_bytes(await e.file.read())
                await self.load(path)

        for which in ("female", "male"):
            async def head(which: str = which) -> None:
                await self.load(files.standard_head(which))

            ui.button(f"Head, {which}", on_click=head).props(f"dense data-pel=head-{which}").classes("w-full")
        ui.upload(label="Drop an OFF, OBJ, PLY or STL file here", auto_upload=True, on_upload=dropped, max_file_size=1 << 30).props(
            "dense flat data-pel=upload").classes("w-full")

        async def restart() -> None:
            try:
                await self.viewer.restart()
            except Exception as error:
                ui.notify(f"{error}", type="negative", multi_line=True, close_button=True, timeout=0)

        ui.button("Open the device again", on_click=restart).props("dense flat data-pel=restart").classes("w-full")


class ExportPanel(Panel):
    name = "Export"

    def build(self) -> None:
        async def everything() -> None:
            def pack() -> bytes:
                with tempfile.TemporaryDirectory() as folder:
                    data = io.BytesIO()
                    with zipfile.ZipFile(data, "w", zipfile.ZIP_STORED) as archive:
                        for path in export(self.viewer.session, Path(folder) / "pellucid-look"):
                            archive.write(path, f"pellucid-look/{path.name}")
                    return data.getvalue()

            ui.download(await self.viewer.on_thread(pack), "pellucid-look.zip")
            self.viewer.changed()

        async def picture() -> None:
            def make() -> bytes:
                with tempfile.TemporaryDirectory() as folder:
                    path = Path(folder) / "picture.png"
                    files.write_image(path, self.viewer.session.smooth(1920, 1080))
                    return path.read_bytes()

            ui.download(await self.viewer.on_thread(make), "pellucid.png")
            self.viewer.changed()

        ui.button("Scene, G-buffer, pictures, C++ (.zip)", on_click=everything).props("dense data-pel=export").classes("w-full")
        ui.button("Picture (.png, 1920 x 1080)", on_click=picture).props("dense data-pel=picture").classes("w-full")
        ui.button("Look (.json)", on_click=lambda: ui.download(json.dumps(self.look.to_dict(), indent=2).encode(), "look.json")).props(
            "dense data-pel=look").classes("w-full")

        async def read(e: events.UploadEventArguments) -> None:
            try:
                self.viewer.session.look = Look.from_dict(json.loads(await e.file.read()))
            except (ValueError, TypeError) as error:
                ui.notify(f"{e.file.name}: {error}", type="negative", close_button=True, timeout=0)
                return
            self.page.build()
            self.viewer.changed()

        ui.upload(label="Read a look (.json)", auto_upload=True, on_upload=read).props("dense flat data-pel=look-upload").classes("w-full")


class Page:
    """The widgets of one open page, over the viewer that all pages share."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer = viewer
        ui.add_body_html(SCRIPT)
        ui.query("body").style("margin:0;overflow:hidden")
        ui.query(".nicegui-content").classes("p-0 gap-0")
        ui.dark_mode(True)
        with ui.row().classes("w-full no-wrap gap-0").style("height:100vh"):
            ui.html(PICTURE, sanitize=False).style("flex:1;min-width:0;height:100%")
            self.column = ui.column().classes("p-3 gap-1").style("width:23rem;height:100%;overflow-y:auto")
        self.work = WorkPanel(self)
        self.panels: list[Panel]
        if isinstance(viewer.session, SceneSession):
            self.panels = [ScenePanel(self), SceneMaterialsPanel(self), SceneLightsPanel(self), self.work, SceneExportPanel(self)]
        else:
            self.panels = [PicturePanel(self), MaterialPanel(self), EyesPanel(self), LightsPanel(self), ProfilePanel(self), ComparePanel(self), self.work,
                           MeshPanel(self), ExportPanel(self)]
        self.build()
        ui.timer(0.5, self.work.tell)

    def build(self) -> None:
        self.column.clear()
        with self.column:
            ui.label("Pellucid").classes("text-lg")
            for panel in self.panels:
                if panel.name:
                    with ui.expansion(panel.name, value=panel.open).classes("w-full"):
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
