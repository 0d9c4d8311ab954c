"""The examples that use OpenGL, as their first lines say to run them."""
import os
import subprocess
import sys
from pathlib import Path

import moderngl
import numpy as np
import pytest
from view_session import pixels

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def run(example, *arguments):
    try:
        moderngl.create_standalone_context(backend="egl", require=330).release()
    except Exception as error:
        pytest.skip(f"no OpenGL: {error}")
    made = subprocess.run([sys.executable, EXAMPLES / example, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=300)
    assert made.returncode == 0, made.stdout
    return pixels(arguments[0])


def test_tutorial(tmp_path):
    found = run("tutorial.py", tmp_path / "head.png")
    known = pixels(EXAMPLES / "tutorial.png")
    assert found.shape == known.shape == (480, 960, 3)
    # Drivers may put edges of triangles half a pixel apart.
    off = np.abs(found - known).max(-1)
    assert off.mean() < 0.002 and (off > 0.05).mean() < 0.01
    plain, scattered = found[:, :480], found[:, 480:]
    covered = plain.max(-1) > 0.02
    assert 0.3 < covered.mean() < 0.8
    # Red light crosses the terminator, blue hardly: scattering shifts dark places to red.
    dark = covered & (plain.max(-1) < 0.3)
    gain = (scattered - plain)[dark].mean(0)
    assert gain[0] > gain[2] + 0.002


def test_up(tmp_path):
    """A long box that stands along z; the head stands along y."""
    points = [f"{x} {y} {z}" for z in (0, 4) for y in (0, 1) for x in (0, 1)]
    faces = ["0 3 1", "0 2 3", "4 5 7", "4 7 6", "0 1 5", "0 5 4", "2 7 3", "2 6 7", "0 4 6", "0 6 2",
             "1 3 7", "1 7 5"]
    path = tmp_path / "box.off"
    path.write_text("\n".join(["OFF\n8 12 0", *points, *("3 " + f for f in faces)]) + "\n")
    seen = run("tutorial.py", tmp_path / "box.png", path, "--up", "z")[:, :480].max(-1) > 0.02
    assert seen.any(1).sum() > 2 * seen.any(0).sum()


def test_deferred_gl_shades_skin_and_nothing_else(tmp_path):
    program = Path(os.environ.get("PELLUCID_COMMAND", "")).with_name("deferred_gl")
    if not program.exists():
        pytest.skip("deferred_gl is not built: it needs the headers of EGL, OpenGL and libpng")
    head = EXAMPLES.parent / "data/heads/head_male.obj"
    for method in ("auto", "none"):
        made = subprocess.run([program, head, tmp_path / method, "--frames", "4", "--size", "320x320",
                               "--method", method, "--stages"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if made.returncode == 77:
            pytest.skip(made.stdout)
        assert made.returncode == 0, made.stdout
    without = pixels(tmp_path / "auto/without-skin.png")
    scattered, plain, turned = (pixels(tmp_path / name) for name in
                                ("auto/frame-000.png", "none/frame-000.png", "auto/frame-001.png"))
    # The renderer leaves skin black, and has the wall and the eyes, which nobody changes.
    skin = without.max(-1) == 0
    assert 0.2 < skin.mean() < 0.6 and not skin[:10].any()
    np.testing.assert_array_equal(scattered[~skin], without[~skin])
    np.testing.assert_array_equal(plain[~skin], without[~skin])
    assert (scattered[skin].max(-1) > 0).mean() > 0.99
    # Where it turns dark, red light has come further than blue.
    dark = skin & (plain.max(-1) < np.quantile(plain[skin].max(-1), 0.2))
    gain = (scattered - plain)[dark].mean(0)
    assert gain[0] > gain[2] + 0.002
    assert np.abs(turned - scattered)[skin].mean() > 0.02
    wrong = subprocess.run([program, head, tmp_path / "wrong", "--frames", "0"], stderr=subprocess.PIPE,
                           text=True)
    assert wrong.returncode == 1 and "--frames 0" in wrong.stderr
