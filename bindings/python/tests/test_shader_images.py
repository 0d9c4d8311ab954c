"""Images of a shader in many layouts and formats, and those that do not fit."""
import weakref

import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, black, shaded, shader_for

import pellucid as pel


def strided(image):
    """The same values inside a larger array, with gaps between pixels and rows."""
    memory = np.full((image.shape[0] * 2, image.shape[1] + 3, image.shape[2] + 2), 7, image.dtype)
    part = memory[::2, 1:-2, 1:-1]
    part[...] = image
    return part


@pytest.mark.parametrize("change", [
    strided, lambda a: np.ascontiguousarray(a.transpose(2, 0, 1)).transpose(1, 2, 0),  # planar
    lambda a: np.concatenate([a, np.full((*a.shape[:2], 1), 9, a.dtype)], -1)])
def test_layouts_give_the_same_bits(device, view, change):
    expected = shaded(device, view)
    images = dict(normal_shading=change(view.normal), albedo=change(view.albedo))
    assert np.array_equal(shaded(device, view, **images), expected)
    out = strided(black())
    shader_for(device, view, out).execute()
    assert np.array_equal(out, expected)
    assert (out.base == 7).sum() == out.base.size - out.size  # the gaps are untouched


def test_half_and_bytes(device, view):
    half = np.zeros((HEIGHT, WIDTH, 4), np.float16)
    shader_for(device, view, half, normal_shading=view.normal.astype(np.float16),
               albedo=np.dstack([np.rint(view.albedo * 255), view.inside]).astype(np.uint8)).execute()
    # Half normals err by 2^-12 each, bytes by 1/510, half results by 2^-12 of at most 1.
    assert np.abs(half[..., :3].astype(float) - view.lambert).max() < 2**-11 * 2 + 1 / 510


@pytest.mark.parametrize("last", ["albedo", "radiance"])
def test_an_array_that_is_input_and_output(device, view, last):
    expected, both = shaded(device, view), view.albedo.copy()
    shader = shader_for(device, view, both)
    shader.set_image("albedo", both).set_image(last, None).set_image(last, both).commit().execute()
    assert np.array_equal(both[view.inside], expected[view.inside])


def read_only(array):
    array.flags.writeable = False
    return array


@pytest.mark.parametrize("slot, image, message", [
    ("normal_shading", np.zeros((4, 4, 3)), "normal_shading has 3 components of float64"),
    ("normal_shading", np.zeros(4, np.float32), r"normal_shading has the shape \(4,\)"),
    ("normal_shading", np.zeros((4, 4, 5), np.float32), "normal_shading has 5 components of float32"),
    ("normal_shading", np.zeros((4, 4, 3), np.float32)[::-1], "normal_shading has a negative stride"),
    ("albedo", np.broadcast_to(np.float32(1), (4, 4, 3)), "albedo is broadcast"),
    ("albedo", np.zeros((0, 4, 3), np.float32), "albedo is empty"),
    ("albedo", np.zeros((3, 4, 4), np.float16).transpose(1, 2, 0), "components that lie apart"),
    ("albedo", np.zeros((5, 4, 3), np.float32).transpose(1, 0, 2), "ascontiguousarray"),
    ("albedo", np.zeros((4, 4), [("n", np.float32, 3), ("id", np.uint8)])["n"], "ascontiguousarray"),
    ("albdo", np.zeros((4, 4, 3), np.float32), "slot is 'albdo'; did you mean 'albedo'"),
    *[(slot, read_only(np.zeros((4, 4, 3), np.float32)), f"{slot} is read-only")
      for slot in ("radiance", "out_diffuse")],
    *[(slot, np.ones(shape, dtype), f"{slot} has the byte order of another machine .*big-endian")
      for slot, shape, dtype in [("normal_shading", (4, 4, 3), ">f4"), ("albedo", (4, 4, 3), ">f2"),
                                 ("material", (4, 4), ">u2"), ("normal_shading", (4, 4, 2), ">i2"),
                                 ("curvature", (1, 1), ">f4")]],
])
def test_images_that_do_not_fit_are_named(device, slot, image, message):
    with pytest.raises((ValueError, pel.PellucidError), match=message):
        pel.Shader(device).set_image(slot, image)


def test_formats_by_name(device):
    buffer = pel.Buffer(device, 4 * 4 * 4)
    for image in (read_only(np.zeros((4, 4, 3), np.float32)),
                  pel.Image(device, np.zeros((4, 4, 4), np.uint8), "rgba8_srgb"),
                  pel.Image(device, np.zeros((4, 4, 4), ">u1")),  # bytes have no order
                  pel.Image(device, buffer, "rgba8_unorm", width=4, height=4)):
        pel.Shader(device).set_image("albedo", image)
    with pytest.raises(pel.PellucidError):
        pel.Shader(device).set_image("albedo", pel.Image(device, buffer, "rgba8_unorm", width=5, height=4))
    for data, name, message in [
            (buffer, None, "needs format, width and height"),
            (np.zeros((4, 4, 3), np.float32), "rgba8_srgb", "stored as 4 x uint8, the array as 3 x float32"),
            (np.zeros((4, 4), ">u2"), "r16_uint", "byte order of another machine")]:
        with pytest.raises(ValueError, match=message):
            pel.Image(device, data, name)


def test_images_are_held_until_they_are_taken_back(device):
    def image(*shape):
        return pel.Image(device, np.full(shape, 0.5, np.float32))

    shader = pel.Shader(device).set_lights([pel.Light()] * 2).set_material(1, pel.Material())
    shader.set_eye(1, pel.Eye())
    setters = {"image": lambda i: shader.set_image("albedo", i),
               "light image": lambda i: shader.set_light_image(1, "shadow_map", i),
               "scattered texture": lambda i: shader.set_scattered_texture(1, i),
               "iris texture": lambda i: shader.set_iris_texture(1, i),
               "ambient cube": shader.set_ambient_cube, "reflection cube": shader.set_reflection_cube,
               "environment": shader.set_environment}
    for name, take in setters.items():
        cube = "cube" in name or name == "environment"
        made = image(8, 8) if "light" in name else image(48 if cube else 8, 8, 3)
        held = weakref.ref(made)
        take(made)
        del made
        assert held() is not None, name
        take(None)
        assert held() is None, name
    maps = [image(4, 4) for _ in range(2)]
    for light, map in enumerate(maps):
        shader.set_light_image(light, "shadow_map", map)
    held = [weakref.ref(map) for map in maps]
    del maps, map
    shader.set_lights([pel.Light()])
    assert held[0]() is not None and held[1]() is None
