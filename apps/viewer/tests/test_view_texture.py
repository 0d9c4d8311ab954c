"""The viewer's scattering in the texture of a mesh."""
import numpy as np
import pytest
from view_session import renders_again

from pellucid.view.export import export
from pellucid.view.look import SKIN, Lamp
from pellucid.view.session import Session


def test_the_method_in_the_texture(session, tmp_path):
    # Where scattering shows, at edges of shadows, the texture's is that of the other methods.
    session.look.lamps, session.look.ambient, session.look.pores = [Lamp("Key", 75.0, 15.0)], 0.02, 0.0
    session.orbit.azimuth = 25
    by = {}
    for method in ("none", "separable", "texture"):
        session.look.method = method
        by[method] = session.radiance(None, 640, 360)
    skin = session.gbuffer(640, 360).material == SKIN
    changes = [(by[method] - by["none"])[skin, 0] for method in ("texture", "separable")]
    assert np.abs(changes[1]).max() > 0.1 and np.corrcoef(changes)[0, 1] > 0.6
    export(session, tmp_path / "look", 160, 90)
    session.look.lamps[0].intensity = 0.2  # made again
    assert session.radiance(None, 640, 360)[skin].mean() < 0.8 * by["texture"][skin].mean()
    session.look.method = "auto"
    # Texture coordinates of another size are let go.
    assert session.radiance(None, 320, 180).shape == (180, 320, 3)
    bare = Session(session.device)
    (tmp_path / "bare.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    bare.load(tmp_path / "bare.obj")
    bare.look.method = "texture"
    with pytest.raises(ValueError, match="no texture coordinates"):
        bare.frame(160, 90)
    assert renders_again(tmp_path / "look")
