"""``python -m pellucid.view [MESH]``"""
from __future__ import annotations

import argparse
import ipaddress
import secrets
import sys


def main() -> int:
    parser = argparse.ArgumentParser(prog="pellucid view", description="A look-dev viewer in the browser.")
    parser.add_argument("mesh", nargs="?", help="OFF, OBJ, PLY or STL file (default: a head that comes with pellucid)")
    parser.add_argument("--up", choices=("auto", "y", "z"), default="auto", help="which way is up in the mesh (auto: y in OBJ files)")
    parser.add_argument("--unit-mm", type=float, default=1.0, help="millimetres per unit of the mesh (1)")
    parser.add_argument("--subdivide", type=int, help="levels of subdivision (2 for the heads, 0 for others)")
    parser.add_argument("--look", help="a look.json that the viewer wrote")
    parser.add_argument("--device", default="", help="OpenCL device, as `pellucid devices` lists them")
    parser.add_argument("--host", default="127.0.0.1", help="address to listen at; others than 127.0.0.1 let the network in, over plain HTTP")
    parser.add_argument("--port", type=int, default=8350)
    parser.add_argument("--token", help="instead of a random one")
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    a = parser.parse_args()
    if not a.unit_mm > 0:
        parser.error("--unit-mm must be above 0")
    try:
        from nicegui import app, ui

        from .page import serve
        from .server import TokenGuard, Viewer
    except ImportError as error:
        print(f"pellucid view: {error}; pip install 'pellucid[view]' brings what the viewer needs", file=sys.stderr)
        return 1
    import json

    from .. import Device, PellucidError, files
    from .look import Look
    from .session import Session

    try:
        look = Look.from_dict(json.load(open(a.look, encoding="utf-8"))) if a.look else Look()
        viewer = Viewer(lambda: Session(Device(a.device), a.unit_mm))
        viewer.session.look = look
        mesh = a.mesh or files.standard_head()
        viewer._thread.submit(lambda: viewer.session.load(mesh, a.subdivide, a.up)).result()
    except (OSError, ValueError, RuntimeError, PellucidError) as error:
        print(f"pellucid view: {error}", file=sys.stderr)
        return 3
    token = a.token or secrets.token_urlsafe(16)
    app.add_middleware(TokenGuard, token=token)
    serve(viewer)
    shown = f"[{a.host}]" if ":" in a.host else a.host
    try:
        local = ipaddress.ip_address(a.host).is_loopback
    except ValueError:
        local = a.host == "localhost"
    if not local:
        print("pellucid view: the network can reach this page; its token travels unencrypted", file=sys.stderr)
    address = f"http://{shown}:{a.port}/?token={token}"
    print(address, flush=True)
    if not a.no_browser:
        import webbrowser

        app.on_startup(lambda: webbrowser.open(address))
    ui.run(host=a.host, port=a.port, show=False, reload=False, show_welcome_message=False, dark=True)
    return 0


if __name__ in {"__main__", "__mp_main__"}:
    raise SystemExit(main())
