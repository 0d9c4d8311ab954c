"""The viewer's session as it begins, and what it exports."""
import os
import subprocess

import numpy as np
import pytest

from pellucid import files
from pellucid.view.camera import Orbit
from pellucid.view.look import Look


def reset(session):
    session.look, session.other, session.orbit = Look(), None, Orbit()
    session.against, session.beside = "", False
    session.orbit.frame(session.mesh.low, session.mesh.high, 2)


def renders_again(folder):
    """Whether the command makes the exported picture again, to the bit."""
    command = os.environ.get("PELLUCID_COMMAND")
    if not command:
        pytest.skip("the pellucid command is not built")
    subprocess.run([command, "shade", "gbuffer.exr", "--scene", "scene.toml", "-o", "again.exr"], cwd=folder,
                   check=True, stdout=subprocess.DEVNULL)
    one, two = (files.read_image(folder / name) for name in ("picture.exr", "again.exr"))
    return all(np.array_equal(one[c], two[c]) for c in "RGB") and one["R"].max() > 0.2
