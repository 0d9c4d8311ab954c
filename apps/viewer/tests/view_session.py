"""The viewer's session as it begins, and what it exports."""
import os
import subprocess

import numpy as np
import pytest

files = pytest.importorskip("pellucid.files", reason="this build reads no files")  # skips what imports this
from pellucid.view.camera import Orbit  # noqa: E402
from pellucid.view.look import Look  # noqa: E402


def reset(session):
    session.look, session.other, session.orbit = Look(), None, Orbit()
    session.against, session.beside, session.wipe = "", False, 0.5
    session.count, session.report = False, None
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


def pixels(path):
    """The colours of a picture, (h, w, 3)."""
    image = files.read_image(path)
    return np.stack([image[c] for c in "RGB"], -1)
