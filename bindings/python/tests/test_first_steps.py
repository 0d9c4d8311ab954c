"""What a newcomer writes first: it works, or the message says what would."""
import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, shader_for

import pellucid as pel


def test_one_light_and_a_sequence_of_one_are_the_same(device, view):
    pictures = []
    for lights in (pel.Light(to_light=(0, 0, 1)), (pel.Light(to_light=(0, 0, 1)),),
                   iter([pel.Light(to_light=(0, 0, 1))])):
        radiance = np.zeros((HEIGHT, WIDTH, 3), np.float32)
        shader_for(device, view, radiance).set_lights(lights).commit().execute()
        pictures.append(radiance)
    assert pictures[0].max() > 0.1
    assert np.array_equal(pictures[0], pictures[1]) and np.array_equal(pictures[0], pictures[2])


def test_a_mask_is_a_material_image(device, view):
    expected, radiance = (np.zeros((HEIGHT, WIDTH, 3), np.float32) for _ in range(2))
    shader_for(device, view, expected).execute()
    shader_for(device, view, radiance, material=view.inside).execute()
    assert expected.max() > 0.1 and np.array_equal(radiance, expected)


@pytest.mark.parametrize("ids",
                         [np.ones((4, 4), np.int64), np.ones((4, 4), np.int32), np.ones((4, 4), np.uint64),
                          np.ones((4, 4, 2), np.uint8)])
def test_ids_of_another_type_say_which_would_do(device, ids):
    with pytest.raises(ValueError,
                       match=rf"material has . components of {ids.dtype}; .* uint8, uint16 or uint32 "
                             rf".*astype\(numpy.uint8\)"):
        pel.Shader(device).set_image("material", ids)
    picture = np.ones((4, 4, 3), np.float32)
    with pytest.raises(ValueError, match="ids has .*uint8"):
        pel.screen_curvature(device, picture, picture, ids=ids)
    with pytest.raises(ValueError, match="ids has .*uint8"):
        pel.Scatter(device).execute(picture, picture, ids=ids)


@pytest.mark.parametrize("call, wanted", [
    (lambda s: s.set_lights(["sun"]), "Light"),
    (lambda s: s.set_lights([pel.Material()]), "Light"),
    (lambda s: s.set_material(1, "jade"), "Material"),
    (lambda s: s.set_material(1, pel.Light()), "Material"),
    (lambda s: s.set_camera(pel.Light()), "Camera"),
    (lambda s: s.set_ambient(pel.Camera()), "Ambient"),
    (lambda s: s.set_options(pel.Camera()), "ShaderOptions"),
    (lambda s: s.set_eye(1, pel.Material()), "Eye"),
])
def test_something_else_in_place_of_a_structure(device, call, wanted):
    with pytest.raises(TypeError, match=f"a pellucid.{wanted} is needed"):
        call(pel.Shader(device))


def test_profiles_go_by_name_everywhere(device, view):
    jade = pel.Profile.named("jade")
    for make in (pel.Lut.curvature, pel.Lut.shadow):
        assert np.array_equal(make(device, width=8, height=8, profile="jade").read(),
                              make(device, width=8, height=8, profile=jade).read())
    pictures = []
    for profile in (jade, "jade"):
        scatter = pel.Scatter(device)
        scatter.set_material(1, profile)
        pictures.append(scatter.execute(view.lambert.copy(), view.position, ids=view.material))
    assert np.array_equal(*pictures) and not np.array_equal(pictures[0], view.lambert)
    triangle, points = np.float32([[0, 0, 0], [9, 0, 0], [0, 9, 0]]), np.float32([[1, 1, 0]])
    light = [pel.surface_integral(device, triangle, [[0, 1, 2]], np.ones((3, 3), np.float32), points,
                                  profile=p) for p in (jade, "jade", None)]
    assert np.array_equal(light[0], light[1]) and not np.array_equal(light[0], light[2])
    for call in (lambda: pel.Scatter(device).set_material(1, 3), lambda: pel.Lut.curvature(device, profile=3),
                 lambda: pel.surface_integral(device, triangle, [[0, 1, 2]], np.ones((3, 3), np.float32),
                                              points, profile=3)):
        with pytest.raises(ValueError, match="it must be a Profile or the name of one of the library"):
            call()
    with pytest.raises(pel.PellucidError, match="jade"):  # lists the names that there are
        pel.Scatter(device).set_material(1, "jad")
