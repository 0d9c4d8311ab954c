"""The picture that every diffusion method approximates, for what the viewer shows.

Irradiance is computed at the vertices, with shadows from the shadow maps; the surface integral then spreads
it. So shadow edges are only as sharp as the mesh is fine; `pellucid reference` traces them exactly.
"""
from __future__ import annotations

import dataclasses
import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from ..scatter import surface_integral
from .lambert import irradiance_at
from .look import SKIN, Look, skin_triangles
from .passes import tinted

if TYPE_CHECKING:
    from .session import Session


def vertex_irradiance(session: Session, look: Look) -> NDArray[np.float32]:
    """Irradiance / pi at each vertex of skin, (n, 3); 0 elsewhere."""
    mesh = session.mesh
    e = irradiance_at(session, look, mesh.positions, mesh.normals)
    if mesh.ids is not None:
        e[mesh.ids != SKIN] = 0
    return e


class Reference:
    """The reference of one picture, on a thread of its own or at once. Every eighth pixel of every eighth
    row comes first."""

    STEPS = (8, 4, 2, 1)
    SECONDS = 0.5  # that one piece of the work may take; between two of them it can be cancelled

    def __init__(self, key: Any, compute: Callable[[Any], NDArray[np.float32]], points: NDArray[np.float32],
                 seen: NDArray[np.bool_]) -> None:
        self.key = key
        self._compute, self._points, self._seen = compute, points, seen
        self._values = np.zeros((*seen.shape, 3), np.float32)
        self._known = ~seen
        self._error: Optional[Exception] = None
        self._cancelled = threading.Event()
        self.fraction = 0.0

    def start(self, report: Optional[Callable[[], None]]) -> None:
        """Computes on a thread that calls `report` after each piece of the work; without `report` at once."""
        if report is None:
            self._run(lambda: None, int(self._seen.sum()))
        else:
            threading.Thread(target=self._run, args=(report, 1024), name="pellucid-reference",
                             daemon=True).start()

    def _run(self, report: Callable[[], None], size: int) -> None:
        total, made, before = int(self._seen.sum()), 0, np.zeros_like(self._seen)
        try:
            for step in self.STEPS:
                lattice = np.zeros_like(self._seen)
                lattice[::step, ::step] = True
                pixels = np.argwhere(lattice & self._seen & ~before)
                before |= lattice
                while len(pixels) and not self._cancelled.is_set():
                    (rows, columns), pixels = pixels[:size].T, pixels[size:]
                    started = time.monotonic()
                    self._values[rows,
                                 columns] = self._compute(np.ascontiguousarray(self._points[rows, columns]))
                    self._known[rows, columns] = True
                    made += len(rows)
                    self.fraction = made / total
                    size = max(256,
                               int(size * min(2.0, self.SECONDS / max(time.monotonic() - started, 1e-3))))
                    report()
        except Exception as error:
            self._error = error
        self.fraction = 1.0
        report()

    def cancel(self) -> None:
        self._cancelled.set()

    def picture(self) -> NDArray[np.float32]:
        """What is known so far; between known pixels the nearest one above on the left."""
        if self._error is not None:
            raise self._error
        values, known = self._values.copy(), self._known.copy()
        height, width = known.shape
        for step in reversed(self.STEPS[:-1]):
            rows, columns = (np.arange(n) // step * step for n in (height, width))
            near = np.ix_(rows, columns)
            fill = ~known & self._known[near]
            values[fill] = self._values[near][fill]
            known |= fill
        return values


def reference(session: Session, name: str, look: Look, width: int, height: int,
              small: bool = False) -> NDArray[np.float32]:
    """Diffuse radiance of the skin that is seen, (height, width, 3); 0 elsewhere.

    Kept by `name` until light, camera or profile change. If the session has a `report` callback, this is the
    result so far.
    """
    g = session.gbuffer(width, height, small)
    lamps = [dataclasses.astuple(lamp) for lamp in look.lamps]
    key = (session.drawn_state(width, height, small), lamps, look.ambient, look.surroundings,
           look.surroundings_light, look.surroundings_turn, session.profile(look), look.radius_scale,
           look.shadow_size)
    made = session.references.get(name)
    if made is None or made.key != key:
        session.cancel_reference(name)
        mesh, profile = session.mesh, session.profile(look)
        radius = profile.info.radius * look.radius_scale
        triangles = skin_triangles(mesh)
        irradiance, device, mm = vertex_irradiance(session, look), session.device, session.mm

        def compute(points: Any) -> NDArray[np.float32]:
            return surface_integral(device, mesh.positions, triangles, irradiance, points, profile=profile,
                                    diffusion_radius=radius, millimetres_per_unit=mm)

        seen = (g.material == SKIN) & bool(len(triangles))
        made = session.references[name] = Reference(key, compute, g.position.copy(), seen)
        made.start(session.report)
    return made.picture() * tinted(g, look)
