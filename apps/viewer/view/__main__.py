"""``python -m pellucid.view [MESH|SCENE]``"""
from __future__ import annotations

import argparse
import contextlib
import ipaddress
import logging
import socket
import sys
from pathlib import Path
from typing import Any
from urllib.parse import quote


def free_port(host: str, port: int) -> int:
    """This port, or the next one that no program listens at. OSError where there is none, or no such host."""
    family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    for offset in range(50):
        with socket.socket(family, kind, protocol) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as the server does
            try:
                probe.bind((address[0], port + offset, *address[2:]))
                return int(probe.getsockname()[1])
            except PermissionError:
                raise
            except (OSError, OverflowError) as error:
                last = error
    raise OSError(f"no port from {port} to {port + 49} can be used on {host}: {last}")


def address(host: str, port: int, token: str) -> str:
    return f"http://{f'[{host}]' if ':' in host else host}:{port}/?token={quote(token, safe='')}"


def main() -> int:
    parser = argparse.ArgumentParser(prog="pellucid view", description="A look-dev viewer in the browser.")
    parser.add_argument("mesh", nargs="?", metavar="MESH|SCENE",
                        help="OFF, OBJ, PLY, STL or glTF file, or a scene (.toml) with its G-buffer "
                        "(default: what was open last, else a head that comes with pellucid)")
    parser.add_argument("--fresh", action="store_true",
                        help="begin with the head, not with what was open last")
    parser.add_argument("--gbuffer", help="of a scene (default: SCENE_gbuffer.exr or gbuffer.exr beside it)")
    parser.add_argument("--up", choices=("auto", "y", "z"),
                        help="which way is up in the mesh (auto: y in OBJ files)")
    parser.add_argument("--unit-mm", type=float, help="millimetres per unit of the mesh; 1 at first")
    parser.add_argument("--subdivide", type=int, help="levels of subdivision (2 for the heads, 0 for others)")
    parser.add_argument("--look", help="a look.json that the viewer wrote")
    parser.add_argument("--device", default="", help="OpenCL device, as `pellucid devices` lists them")
    parser.add_argument("--host", default="127.0.0.1",
                        help="address to listen at; others than 127.0.0.1 let the network in, over plain "
                             "HTTP")
    parser.add_argument("--port", type=int, default=8350, help="or the next one that is free (8350)")
    parser.add_argument("--token", default="",
                        help="one that stays valid, in place of random ones that are valid once")
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    a = parser.parse_args()
    if a.unit_mm is not None and not a.unit_mm > 0:
        parser.error("--unit-mm must be above 0")
    import json

    from .. import Device, PellucidError, files
    from .look import Look
    from .memory import Memory, recall, remember, standard_file

    def lacking(error: ImportError) -> int:
        print(f"pellucid view: {error}; pip install 'pellucid[view]' brings what the viewer needs",
              file=sys.stderr)
        return 1

    try:
        from .scene_session import SceneSession
        from .server import Viewer
        from .session import UNITS, Session
    except ImportError as error:
        return lacking(error)

    memory, resumed = Memory(standard_file()), ""
    if memory.problem:
        print(f"pellucid view: {memory.problem}", file=sys.stderr)

    def opened(device: Device) -> Any:
        nonlocal resumed
        if a.mesh and a.mesh.lower().endswith(".toml"):
            return SceneSession(a.mesh, a.gbuffer, device)
        session = Session(device, a.unit_mm or 1.0)
        if not (a.mesh or a.fresh or a.look):
            flags = {"mm": a.unit_mm, "subdivide": a.subdivide, "up": a.up}
            resumed = recall(memory, session, **{k: v for k, v in flags.items() if v is not None})
            if resumed:
                return session
        if a.look:
            with open(a.look, encoding="utf-8") as file:
                session.look = Look.from_dict(json.load(file))
            for name in ("iris_texture", "surroundings"):
                beside = Path(a.look).parent / getattr(session.look, name)
                if getattr(session.look, name) and beside.is_file():  # as the viewer exports it
                    setattr(session.look, name, str(beside))
        session.load(a.mesh or files.standard_head(), a.subdivide, a.up or "auto")
        return session

    try:
        port = free_port(a.host, a.port)
        if a.port and port != a.port:
            print(f"pellucid view: port {a.port} is in use; this is {port}", file=sys.stderr)
        viewer = Viewer(lambda: Device(a.device), opened, memory)
        try:  # while the viewer opens the mesh
            from nicegui import app, ui

            from .guard import Guard, Keys
            from .page import serve
        except ImportError as error:
            return lacking(error)
        viewer.opened().resumed = bool(resumed)
    except (OSError, ValueError, TypeError, RuntimeError, PellucidError) as error:
        print(f"pellucid view: {error}", file=sys.stderr)
        return 3
    try:
        local = ipaddress.ip_address(a.host).is_loopback
    except ValueError:
        local = a.host == "localhost"
    if not local:
        print("pellucid view: the network can reach this page; its token travels unencrypted",
              file=sys.stderr)

    if resumed:
        print(f"pellucid view: {resumed}, as it was left (--fresh: begin anew)", file=sys.stderr)

    def leave() -> None:
        try:
            if isinstance(viewer.session, Session):
                remember(memory, viewer.session)
            else:
                memory.update(open=memory.opened)
        except OSError as error:
            print(f"pellucid view: {error}", file=sys.stderr)

    app.on_shutdown(leave)
    keys = Keys(port, a.token, lambda key: print(f"for another browser: {address(a.host, port, key)}",
                                                 flush=True))
    app.add_middleware(Guard, keys=keys)
    serve(viewer)
    better = viewer.session.better_unit() if isinstance(viewer.session, Session) else None
    if better is not None:
        print(f"pellucid view: {viewer.session.size_text()} If its lengths are in {UNITS[better]}: --unit-mm "
              f"{better:g}", file=sys.stderr)
    print(address(a.host, port, keys.key), flush=True)
    if not a.no_browser:
        import webbrowser

        app.on_startup(lambda: webbrowser.open(address(a.host, port, keys.key)))
    logging.getLogger("nicegui").setLevel(logging.ERROR)  # it warns of each slow propagation of bindings
    with contextlib.suppress(KeyboardInterrupt):  # the way to end it, which uvicorn raises once more
        ui.run(host=a.host, port=port, show=False, reload=False, show_welcome_message=False, dark=True,
               ws_per_message_deflate=False)  # JPEG files do not become smaller
    return 0


if __name__ in {"__main__", "__mp_main__"}:
    raise SystemExit(main())
