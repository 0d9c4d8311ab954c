"""docs/gallery is what the viewer makes: looks, modes, lights, scenes and pictures."""
import re
from pathlib import Path

import numpy as np
import pytest
from view_session import pixels

from pellucid.view import gallery

KEPT = Path(__file__).resolve().parents[3] / "docs/gallery"


def paths(folder):
    return {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}


def numbers(text):
    """The text without its numbers, and these."""
    number = r"-?\d+\.?\d*(?:e-?\d+)?"
    return re.sub(number, "#", text), [float(n) for n in re.findall(number, text)]


def test_the_docs_show_what_the_viewer_makes(tmp_path):
    """After a change that is meant to be visible, look at the new pictures at full size and keep them:
    ``python -m pellucid.view.gallery docs/gallery --pictures-only --size 400``."""
    try:
        gallery.make(tmp_path, True, gallery.GALLERY, 400)
    except RuntimeError as error:
        pytest.skip(f"no OpenGL: {error}")
    assert paths(tmp_path) == paths(KEPT)
    for name in sorted(paths(KEPT)):
        made, kept = tmp_path / name, KEPT / name
        if name.endswith(".png"):
            # Drivers may put edges of triangles half a pixel apart.
            off = np.abs(pixels(made) - pixels(kept)).max(-1)
            assert off.mean() < 0.001 and (off > 0.05).mean() < 0.005, name
        else:
            (words, values), (known, wanted) = (numbers(p.read_text(encoding="utf-8")) for p in (made, kept))
            assert words == known and values == pytest.approx(wanted, rel=1e-4, abs=1e-6), name
