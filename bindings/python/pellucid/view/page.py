"""The page: the picture, and a panel of what can be tuned."""
from __future__ import annotations

import io
import json
import tempfile
import zipfile
from pathlib import Path
from typing import Any, Callable

import numpy as np
from fastapi import WebSocket
from nicegui import app, events, ui

from .. import files
from ..profile import Profile
from .export import export
from .look import METHODS, MODES, PRESETS, Look
from .server import Viewer

_PICTURE = """
<div id="pel-view" style="position:relative;width:100%;height:100%;background:#111;overflow:hidden">
<canvas id="pel-canvas" style="width:100%;height:100%;display:block;cursor:grab;touch-action:none"></canvas>
<div id="pel-error" style="display:none;position:absolute;left:1rem;right:1rem;top:1rem;padding:.6rem 1rem;background:#7f1d1d;color:#fff;border-radius:.4rem;white-space:pre-wrap"></div>
<div id="pel-help" style="position:absolute;left:1rem;bottom:.6rem;color:#bbb;font-size:.8rem">drag: turn &middot; shift or right button: move &middot; wheel: nearer &middot; ctrl: key light</div>
<div id="pel-rate" style="position:absolute;right:1rem;bottom:.6rem;color:#bbb;font-size:.8rem"></div>
</div>"""

_SCRIPT = """
<script>
(function () {
  let socket, canvas, pending = null, last = null, sent = false, times = [];
  window.pelFrames = 0;
  function say(message) { if (socket && socket.readyState === 1) socket.send(JSON.stringify(message)); }
  function size() {
    if (!canvas) return;
    const r = canvas.getBoundingClientRect(), s = Math.min(1, 1600 / Math.max(r.width, 1));
    say({kind: 'size', width: Math.round(r.width * s), height: Math.round(r.height * s)});
  }
  function connect() {
    socket = new WebSocket((location.protocol === 'https:' ? 'wss://' : 'ws://') + location.host + '/frames');
    socket.binaryType = 'arraybuffer';
    socket.onopen = size;
    socket.onclose = () => setTimeout(connect, 1000);
    socket.onmessage = async (event) => {
      if (typeof event.data === 'string') {
        pending = JSON.parse(event.data);
        const box = document.getElementById('pel-error');
        box.style.display = pending.error ? 'block' : 'none';
        box.textContent = pending.error;
        if (pending.error) say({kind: 'taken'});
        return;
      }
      const picture = await createImageBitmap(new Blob([event.data], {type: 'image/jpeg'}));
      if (!pending.moving || canvas.width < 32) { canvas.width = picture.width; canvas.height = picture.height; }
      canvas.getContext('2d').drawImage(picture, 0, 0, canvas.width, canvas.height);
      picture.close();
      const now = performance.now();
      times = times.filter((t) => now - t < 1000).concat(now);
      window.pelFrames += 1;
      window.pelMoving = pending.moving;
      window.pelRate = times.length;
      document.getElementById('pel-rate').textContent =
        Object.entries(pending.milliseconds).map(([k, v]) => k + ' ' + v.toFixed(0) + ' ms').join(', ') + (pending.moving ? ', ' + times.length + ' frames/s' : '');
      say({kind: 'taken'});
    };
  }
  function start() {
    canvas = document.getElementById('pel-canvas');
    if (!canvas) { setTimeout(start, 50); return; }
    new ResizeObserver(size).observe(canvas);
    let queued = null;
    function move(kind, dx, dy) {  // motions between two pictures are added up
      if (queued && queued.kind === kind) { queued.dx += dx; queued.dy += dy; return; }
      if (queued) say(queued);
      queued = {kind: kind, dx: dx, dy: dy};
      requestAnimationFrame(() => { if (queued) say(queued); queued = null; });
    }
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('pointerdown', (e) => { last = e; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointerup', () => { last = null; });
    canvas.addEventListener('pointermove', (e) => {
      if (!last) return;
      const h = canvas.clientHeight, dx = (e.clientX - last.clientX) / h, dy = (e.clientY - last.clientY) / h;
      const kind = e.ctrlKey || e.metaKey ? 'light' : e.shiftKey || (e.buttons & 2) ? 'pan' : e.altKey ? 'wipe' : 'orbit';
      last = e;
      if (kind === 'wipe') say({kind: 'wipe', x: e.offsetX / canvas.clientWidth}); else move(kind, dx, dy);
    });
    canvas.addEventListener('wheel', (e) => { e.preventDefault(); move('zoom', 0, Math.sign(e.deltaY) * 0.1); }, {passive: false});
    connect();
  }
  start();
})();
</script>"""


def _hex(color: Any) -> str:
    srgb = files.tonemap(np.asarray(color, np.float32).reshape(1, 1, 3), 1.0, 1.0)[0, 0]
    return "#{:02x}{:02x}{:02x}".format(*srgb.tolist())


def _linear(text: str) -> tuple[float, float, float]:
    c = np.array([int(text[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    return tuple(np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4).tolist())  # type: ignore[return-value]


class Page:
    """The widgets of one open page, over the viewer that all pages share."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer = viewer
        self.bars: dict[str, Any] = {}
        ui.add_body_html(_SCRIPT)
        ui.query("body").style("margin:0;overflow:hidden")
        ui.query(".nicegui-content").classes("p-0 gap-0")
        ui.dark_mode(True)
        with ui.row().classes("w-full no-wrap gap-0").style("height:100vh"):
            ui.html(_PICTURE, sanitize=False).style("flex:1;min-width:0;height:100%")
            self.panel = ui.column().classes("p-3 gap-1").style("width:23rem;height:100%;overflow-y:auto")
        self.build()
        ui.timer(0.5, self.tell)

    @property
    def look(self) -> Look:
        return self.viewer.session.look

    # ---- Widgets -----------------------------------------------------------------------------------------------------

    def slider(self, name: str, owner: Any, attribute: str, low: float, high: float, step: float, marker: str = "") -> None:
        with ui.row().classes("w-full items-center no-wrap gap-2"):
            ui.label(name).classes("text-xs").style("width:8.5rem")
            value = ui.label().classes("text-xs text-right").style("width:3.2rem")
            value.bind_text_from(owner, attribute, backward=lambda v: f"{v:.4g}")

            def change(e: events.ValueChangeEventArguments) -> None:
                if e.value is not None and getattr(owner, attribute) != e.value:
                    setattr(owner, attribute, float(e.value))
                    self.viewer.changed(moving=True)

            ui.slider(min=low, max=high, step=step, value=getattr(owner, attribute), on_change=change).props(f"dense data-pel=slider-{marker or attribute}")

    def select(self, name: str, options: Any, attribute: str, then: Callable[[], None] = lambda: None) -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            setattr(self.look, attribute, e.value)
            then()
            self.viewer.changed()

        ui.select(options, value=getattr(self.look, attribute), label=name, on_change=change).props(f"dense options-dense data-pel={attribute}").classes("w-full")

    def switch(self, name: str, owner: Any, attribute: str, marker: str = "") -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            setattr(owner, attribute, bool(e.value))
            self.viewer.changed()

        ui.switch(name, value=getattr(owner, attribute), on_change=change).props(f"dense data-pel={marker or attribute}").classes("text-xs")

    def color(self, name: str, owner: Any, attribute: str, marker: str = "") -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            if isinstance(e.value, str) and len(e.value) == 7:
                setattr(owner, attribute, _linear(e.value))
                self.viewer.changed()

        ui.color_input(name, value=_hex(getattr(owner, attribute)), on_change=change).props(f"dense data-pel={marker or attribute}").classes("w-full")

    # ---- Panel -------------------------------------------------------------------------------------------------------

    def build(self) -> None:
        self.panel.clear()
        with self.panel:
            ui.label("Pellucid").classes("text-lg")
            with ui.row().classes("w-full no-wrap"):
                ui.select(list(PRESETS), label="Preset", on_change=lambda e: self.preset(e.value)).props("dense options-dense data-pel=preset").classes("w-full")
            self.select("Picture", MODES, "mode")
            self.slider("Exposure", self.look, "exposure", 0.1, 4, 0.05)
            self.select("Tone mapping", {"soft": "Soft", "none": "None", "filmic": "Filmic", "agx-like": "AgX-like"}, "curve")
            self.slider("Shoulder", self.look, "shoulder", 0.3, 1, 0.05)
            with ui.expansion("Material", value=True).classes("w-full"):
                self.material()
            with ui.expansion("Lights").classes("w-full"):
                self.lights()
            with ui.expansion("Profile").classes("w-full"):
                self.profile()
            with ui.expansion("Compare").classes("w-full"):
                self.compare()
            with ui.expansion("Time and work", value=True).classes("w-full"):
                self.work()
            with ui.expansion("Mesh").classes("w-full"):
                self.mesh()
            with ui.expansion("Export").classes("w-full"):
                self.export()

    def material(self) -> None:
        self.select("Scattering", METHODS, "method")
        self.slider("Target error", self.look, "target_error", 0.0005, 0.02, 0.0005)
        self.slider("Radius, times", self.look, "radius_scale", 0.1, 5, 0.05)
        self.slider("Transmission", self.look, "transmission", 0, 2, 0.05)
        self.slider("Specular", self.look, "specular", 0, 1, 0.01)
        self.slider("Roughness", self.look, "roughness", 0.05, 1, 0.01)
        self.slider("f0", self.look, "f0", 0.0, 0.2, 0.002)
        self.switch("Two lobes of GGX", self.look, "ggx")
        self.slider("Second roughness", self.look, "roughness2", 0.05, 1, 0.01)
        self.slider("Its share", self.look, "lobe_mix", 0, 1, 0.01)
        self.slider("Pores", self.look, "pores", 0, 0.5, 0.01)
        self.slider("Pupil of eyes, mm", self.look, "pupil", 0.5, 4, 0.1)
        for c, name in enumerate(("Albedo red, times", "green", "blue")):
            self.channel(name, "albedo", c, 0.0, 2.0, 0.01)
        for c, name in enumerate(("Deep scatter red", "green", "blue")):
            self.channel(name, "deep_scatter", c, 0.0, 3.0, 0.05)

    def channel(self, name: str, attribute: str, c: int, low: float, high: float, step: float, then: Callable[[], None] = lambda: None) -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            values = list(getattr(self.look, attribute))
            if values[c] != e.value:
                values[c] = float(e.value)
                setattr(self.look, attribute, tuple(values))
                then()
                self.viewer.changed(moving=True)

        with ui.row().classes("w-full items-center no-wrap gap-2"):
            ui.label(name).classes("text-xs").style("width:8.5rem")
            ui.label().classes("text-xs text-right").style("width:3.2rem").bind_text_from(
                self.look, attribute, backward=lambda v: f"{v[c]:.3g}")
            ui.slider(min=low, max=high, step=step, value=getattr(self.look, attribute)[c], on_change=change).props(f"dense data-pel=slider-{attribute}-{c}")

    def lights(self) -> None:
        self.slider("Ambient", self.look, "ambient", 0, 1, 0.01)
        self.select("Shadow map, texels", [512, 1024, 2048, 4096], "shadow_size")
        for i, lamp in enumerate(self.look.lamps):
            self.switch(lamp.name, lamp, "on", f"lamp-{i}-on")
            self.slider("Intensity", lamp, "intensity", 0, 4, 0.05, f"lamp-{i}-intensity")
            self.slider("Azimuth", lamp, "azimuth", -180, 180, 1, f"lamp-{i}-azimuth")
            self.slider("Elevation", lamp, "elevation", -89, 89, 1, f"lamp-{i}-elevation")
            self.color("Colour", lamp, "color", f"lamp-{i}-color")
            self.switch("Shadow", lamp, "shadow", f"lamp-{i}-shadow")

    def profile(self) -> None:
        self.select("Profile", [*Profile.library_names(), "custom"], "profile", self.draw_profile)
        for c, name in enumerate(("custom: d red, mm", "green", "blue")):
            self.channel(name, "distance", c, 0.01, 5.0, 0.01, self.draw_profile)
        self.curve = ui.echart({
            "animation": False, "grid": {"left": 45, "right": 10, "top": 25, "bottom": 40}, "textStyle": {"color": "#ccc"},
            "title": {"text": "light by distance: 2πr R(r), 1/mm", "textStyle": {"fontSize": 11, "color": "#ccc"}},
            "xAxis": {"type": "value", "name": "mm", "nameLocation": "middle", "nameGap": 25}, "yAxis": {"type": "value"},
            "series": [{"type": "line", "showSymbol": False, "data": [], "lineStyle": {"color": c}} for c in ("#f66", "#6d6", "#69f")]}).style(
                "height:13rem;width:100%")
        self.draw_profile()

    def draw_profile(self) -> None:
        p = self.viewer.session.profile(self.look)
        scale = self.look.radius_scale
        r = np.linspace(0.01, 0.5 * p.info.reach, 120)
        radial, _ = p.evaluate(r)
        for c, series in enumerate(self.curve.options["series"]):
            series["data"] = np.stack([r * scale, 2 * np.pi * r * radial[:, c] / scale], 1).round(5).tolist()
        self.curve.update()

    def compare(self) -> None:
        def keep() -> None:
            self.viewer.session.other = self.look.copy()
            self.viewer.changed()

        def drop() -> None:
            self.viewer.session.other = None
            self.viewer.changed()

        def swap() -> None:
            s = self.viewer.session
            if s.other is not None:
                s.look, s.other = s.other, s.look
                self.build()
                self.viewer.changed()

        ui.label("Keeps the settings of now on the right of a line; change them on the left. Alt and drag moves the line.").classes("text-xs")
        with ui.row():
            ui.button("Keep", on_click=keep).props("dense data-pel=wipe-keep")
            ui.button("Swap", on_click=swap).props("dense data-pel=wipe-swap")
            ui.button("Drop", on_click=drop).props("dense data-pel=wipe-drop")
        self.slider("Line", self.viewer.session, "wipe", 0, 1, 0.01)

    def work(self) -> None:
        self.bars = {}
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
        lines += ["warning: " + w for w in frame.warnings]
        self.counts.set_text("\n".join(lines))

    async def load(self, path: Any) -> None:
        try:
            mesh = await self.viewer.on_thread(lambda: self.viewer.session.load(path))
        except Exception as error:  # the mesh before it stays
            ui.notify(f"{error}", type="negative", multi_line=True, close_button=True, timeout=0)
            return
        ui.notify(f"{len(mesh.positions)} vertices, {len(mesh.triangles)} triangles")
        self.viewer.changed()

    def mesh(self) -> None:
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

    def preset(self, name: str) -> None:
        if name not in PRESETS:
            return
        old, new = self.look, Look.from_dict(PRESETS[name])
        for keep in ("lamps", "ambient", "shadow_size", "exposure", "curve", "shoulder", "mode", "target_error"):
            setattr(new, keep, getattr(old, keep))
        self.viewer.session.look = new
        self.build()
        self.viewer.changed()

    def export(self) -> None:
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
                    files.write_image(path, self.viewer.session.frame(1920, 1080).pixels)
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
            self.build()
            self.viewer.changed()

        ui.upload(label="Read a look (.json)", auto_upload=True, on_upload=read).props("dense flat data-pel=look-upload").classes("w-full")


def serve(viewer: Viewer) -> None:
    """Adds the page and its socket to NiceGUI's application."""

    @ui.page("/", title="Pellucid")
    def page() -> None:
        Page(viewer)

    @app.websocket("/frames")
    async def frames(socket: WebSocket) -> None:
        await socket.accept()
        await viewer.stream(socket)
