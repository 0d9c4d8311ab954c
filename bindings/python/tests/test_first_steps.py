"""What a newcomer writes first: it works, or the message says what would."""
import numpy as np
import pytest
from shader_view import shaded

import pellucid as pel


def test_lights_masks_and_profiles_in_their_short_forms(device, view):
    light = pel.Light(to_light=view.to_light)
    expected = shaded(device, view)
    assert expected.max() > 0.1
    for lights in (light, (light,), iter([light])):
        assert np.array_equal(shaded(device, view, lambda shader, given=lights: shader.set_lights(given)),
                              expected)
    assert np.array_equal(shaded(device, view, material=view.inside), expected)  # a mask of bool


@pytest.mark.parametrize("ids", [np.ones((4, 4), np.int64), np.ones((4, 4), np.int32),
                                 np.ones((4, 4), np.uint64), np.ones((4, 4, 2), np.uint8)])
def test_ids_of_another_type_say_which_would_do(device, ids):
    with pytest.raises(ValueError, match=rf"material has . components of {ids.dtype}; .* uint8, uint16 or "
                                         rf"uint32 .*astype\(numpy.uint8\)"):
        pel.Shader(device).set_image("material", ids)
    picture = np.ones((4, 4, 3), np.float32)
    for call in (lambda: pel.screen_curvature(device, picture, picture, ids=ids),
                 lambda: pel.Scatter(device).execute(picture, picture, ids=ids)):
        with pytest.raises(ValueError, match="ids has .*uint8"):
            call()


@pytest.mark.parametrize("call, wanted", [
    (lambda s: s.set_lights(["sun"]), "Light"),
    (lambda s: s.set_lights([pel.Material()]), "Light"),
    (lambda s: s.set_material(1, "jade"), "Material"),
    (lambda s: s.set_camera(pel.Light()), "Camera"),
    (lambda s: s.set_ambient(pel.Camera()), "Ambient"),
    (lambda s: s.set_options(pel.Camera()), "ShaderOptions"),
    (lambda s: s.set_eye(1, pel.Material()), "Eye"),
])
def test_something_else_in_place_of_a_structure(device, call, wanted):
    with pytest.raises(TypeError, match=f"a pellucid.{wanted} is needed"):
        call(pel.Shader(device))


def test_profiles_go_by_name_everywhere(device, view):
    triangle, points = np.float32([[0, 0, 0], [9, 0, 0], [0, 9, 0]]), np.float32([[1, 1, 0]])

    def scattered(profile):
        scatter = pel.Scatter(device)
        scatter.set_material(1, profile)
        return scatter.execute(view.lambert.copy(), view.position, ids=view.material)

    for make in (lambda p: pel.Lut.curvature(device, width=8, height=8, profile=p).read(),
                 lambda p: pel.Lut.shadow(device, width=8, height=8, profile=p).read(), scattered,
                 lambda p: pel.surface_integral(device, triangle, [[0, 1, 2]], np.ones((3, 3), np.float32),
                                                points, profile=p)):
        by_name = make("jade")
        assert np.array_equal(by_name, make(pel.Profile.named("jade")))
        assert not np.array_equal(by_name, make(None))
        with pytest.raises(ValueError, match="it must be a Profile or the name of one of the library"):
            make(3)
    with pytest.raises(pel.PellucidError, match="jade"):  # lists the names that there are
        scattered("jad")
