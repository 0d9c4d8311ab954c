"""The properties of the pixel below the mouse."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from .look import NAMES, SKIN

if TYPE_CHECKING:
    from .session import Session


def pixel_of(session: Session, x: float, y: float) -> Optional[tuple[Any, int, int]]:
    """The G-buffer that is shown, row and column; None outside of the object. `x`, `y`: 0 to 1, from the top
    left."""
    if session.side_by_side:
        x = 2 * x % 1
    g = session.shown
    if g is None or not (0 <= x < 1 and 0 <= y < 1):
        return None
    height, width = g.material.shape
    row, column = int(y * height), int(x * width)
    return (g, row, column) if g.material[row, column] > 0 else None


def describe_pixel(session: Session, x: float, y: float) -> str:
    """The pixel in words, one fact a line; "" outside of the object."""
    found = pixel_of(session, x, y)
    if found is None:
        return ""
    g, row, column = found
    id, normal = int(g.material[row, column]), g.normal_shading[row, column]
    key = session.to_light(session.look.lamps[0])
    position = g.position[row, column] - session.centre
    lines = [f"{NAMES.get(id, f'material {id}')}, column {column}, row {row}",
             "from the centre {:.1f}, {:.1f}, {:.1f} mm".format(*position * session.mm),
             f"N·L of the key light {float(normal @ key):.3f}",
             f"curvature {g.curvature[row, column] / session.mm:.4f} per mm",
             "albedo {:.3f}, {:.3f}, {:.3f}".format(*g.albedo[row, column])]
    made = session.last_pass
    if made is not None and made.outputs["radiance"].shape[:2] == g.material.shape:
        lines.append("radiance {:.4f}, {:.4f}, {:.4f}".format(*made.outputs["radiance"][row, column]))
        if id == SKIN:
            lines.append(f"scattering: {session.scattering_at(row, column)}")
    return "\n".join(lines)


def place(session: Session, x: float, y: float) -> Optional[np.ndarray]:
    """The point that is seen, in the mesh's coordinates."""
    found = pixel_of(session, x, y)
    return None if found is None else found[0].position[found[1], found[2]].astype(float)
