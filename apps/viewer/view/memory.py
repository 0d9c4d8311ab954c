"""Data that the viewer keeps between two runs: the user's presets, and the last session."""
from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

from .. import _native
from .._errors import PellucidError
from .camera import Orbit
from .look import Look, filled
from .surroundings import STUDIO


def standard_file() -> Path:
    base = os.environ.get("APPDATA" if os.name == "nt" else "XDG_CONFIG_HOME")
    return (Path(base) if base else Path.home() / ".config") / "pellucid" / "view.json"


class Memory:
    """A JSON file: {"presets": {name: look}, "last": {...}, "open": {panel: bool}}."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.values: dict[str, Any] = {}
        self.problem = ""  # why the file was not read; it is left alone until something is saved
        self._read()
        self.opened = self.part("open").copy()  # of this run

    def _read(self) -> None:
        try:
            found = json.loads(self.path.read_text(encoding="utf-8"))
            if not isinstance(found, dict):
                raise ValueError("it holds no JSON object")
            self.values = found
        except FileNotFoundError:
            pass
        except (OSError, ValueError, RecursionError) as error:
            self.problem = f"{self.path} was not read: {error}"

    def part(self, name: str) -> dict[str, Any]:
        """A part, as it was when the file was last read or written."""
        if not isinstance(self.values.get(name), dict):
            self.values[name] = {}
        return self.values[name]

    def update(self, **parts: dict[str, Any]) -> None:
        """Sets values in parts of the file, which another viewer may have written meanwhile; None removes
        one. Raises OSError."""
        self._read()
        for name, values in parts.items():
            self.part(name).update(values)
            self.values[name] = {key: value for key, value in self.part(name).items() if value is not None}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        _native.write_file(str(self.path), json.dumps(self.values, indent=1).encode())


def remember(memory: Memory, session: Any) -> None:
    """Saves what a session shows, and how its mesh was read. Raises OSError."""
    memory.update(open=memory.opened, last={
        "mesh": str(Path(session.mesh.source).absolute()) if session.mesh.source else "",
        "mm": session.mm, "look": session.look.to_dict(), "orbit": asdict(session.orbit), **session.read})


def recall(memory: Memory, session: Any, **asked: Any) -> str:
    """Shows the last session, but with what is `asked`: mm, subdivide, up. Returns the mesh's file, or "" if
    there is none, it no longer exists (the look is then shown alone), or it cannot be shown."""
    last, unit = memory.part("last"), session.mm
    try:
        look, orbit = Look.from_dict(last["look"]), filled(Orbit(), last["orbit"], "the camera")
        for name in ("iris_texture", "surroundings"):  # files dropped on the page were deleted with that run
            if getattr(look, name) not in ("", STUDIO) and not Path(getattr(look, name)).is_file():
                setattr(look, name, "")
        if not Path(last["mesh"]).is_file():  # such as one that was dropped on the page
            session.look = look
            return ""
        last = last | asked
        session.mm = float(last["mm"])
        session.load(last["mesh"], last.get("subdivide"), last.get("up", "auto"))
    except (KeyError, TypeError, ValueError, OSError, PellucidError):
        session.mm = unit
        return ""
    session.look, session.orbit = look, orbit
    return str(last["mesh"])
