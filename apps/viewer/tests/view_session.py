"""The viewer's session as it begins."""
from pellucid.view.camera import Orbit
from pellucid.view.look import Look


def reset(session):
    session.look, session.other, session.orbit = Look(), None, Orbit()
    session.orbit.frame(session.mesh.low, session.mesh.high, 2)
