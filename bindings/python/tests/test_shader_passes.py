"""What lies before shading: blurred normals, normal maps, wide shadows, ambient cubes; and the outputs beside radiance."""
import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, shader_for

import pellucid as pel


def show_blurred_normal(device, view, **options):
    """A shader whose radiance is 1 + Nb / 2."""
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, albedo=np.ones_like(view.albedo), position=view.position)
    sh = np.zeros((9, 3))
    for channel, basis in enumerate((3, 1, 2)):
        sh[basis, channel] = 0.5 / np.sqrt(3 / (4 * np.pi))
    shader.set_material(1, pel.Material(normal_blend=[1, 1, 1], diffusion_radius=3, uv_scale=100)).set_lights([])
    shader.set_ambient(pel.Ambient(constant=[1, 1, 1], sh=sh)).set_options(**options)
    return shader, out


def test_normals_blurred_on_screen(device, view):
    rough = view.normal + np.random.default_rng(2).normal(0, 0.2, view.normal.shape).astype(np.float32)
    rough /= np.maximum(np.linalg.norm(rough, axis=-1, keepdims=True), 1e-6)
    shader, out = show_blurred_normal(device, view, blur_normals=1)
    shader.set_image("normal_shading", rough).commit().execute()
    assert shader.stats().features & pel.Feature.BLUR_NORMALS
    inner = view.position[..., 2] > 5
    error = lambda n: np.sqrt(((n - view.normal) ** 2).sum(-1)[inner].mean())
    assert error(2 * (out - 1)) < error(rough) / 3  # some 10 x 10 pixels are averaged


def test_normal_map(device, view, tolerance):
    texels = np.zeros((16, 8, 3), np.float32)
    texels[...] = [0.6, 0, 0.8]
    shader, out = show_blurred_normal(device, view)
    tangent = np.cross([0, 1, 0], view.normal)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-6)
    shader.set_image("uv", np.zeros((HEIGHT, WIDTH, 2), np.float32)).set_image("tangent", tangent.astype(np.float32))
    for levels in (texels, [texels, texels[::2, ::2]], np.rint(np.dstack([texels * 127.5 + 127.5, texels[..., :1]])).astype(np.uint8)):
        shader.set_normal_map(1, levels).commit().execute()
        assert shader.stats().features & pel.Feature.NORMAL_MAP
        right = 0.6 * tangent + 0.8 * view.normal
        close = tolerance["mappedNormal"] if levels is not texels and isinstance(levels, list) or levels is texels else 0.01
        assert np.abs(2 * (out - 1) - right)[view.inside].max() < close
    shader.set_normal_map(1, None).commit().execute()
    assert np.abs(2 * (out - 1) - view.normal)[view.inside].max() < tolerance["mappedNormal"]
    with pytest.raises(ValueError, match="3 components of float64"):
        shader.set_normal_map(1, texels.astype(float))
    with pytest.raises(pel.PellucidError, match="must be 4 x 8"):
        shader.set_normal_map(1, [texels, texels])


def wall_light():
    """A light straight above and its shadow map: a wall at x < 0 between it and the sphere."""
    depth = np.ones((64, 64), np.float32)
    depth[:, :32] = 0.1
    return pel.Light(to_light=[0, 0, 1], shadow_filter_texels=32, shadow_depth_range=50,
                     world_to_shadow=[1 / 30, 0, 0, 0.5, 0, -1 / 30, 0, 0.5, 0, 0, -1 / 50, 0.5, 0, 0, 0, 1]), depth


def cube_directions(n):
    """The directions of the texels of a cube map's six faces, (6, n, n, 3)."""
    s, t = np.meshgrid((2 * np.arange(n) + 1) / n - 1, (2 * np.arange(n) + 1) / n - 1)
    one = np.ones_like(s)
    return np.stack([np.stack(f, -1) for f in [(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one)]])


def test_wide_shadow_from_a_shadow_map(device, view):
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, position=view.position)
    light, depth = wall_light()
    shader.set_lights([light]).set_light_image(0, "shadow_map", depth)
    shader.set_material(1, pel.Material(shadow_filter_width=4)).commit().execute()
    assert shader.stats().features == pel.Feature.SHADOW | pel.Feature.FILTER_SHADOW
    lambert = view.albedo * view.normal[..., 2:]
    x = view.position[..., 0]
    assert np.abs(out[view.inside & (x < -2.5)]).max() == 0
    lit = view.inside & (x > 2.5)
    assert np.abs(out - lambert)[lit].max() < 1e-5


@pytest.mark.parametrize("form", ["moments", "exponential", "cascades", "cube_radial"])
def test_wide_shadow_from_every_form_of_map(device, view, form):
    """The same wall, in maps of other forms."""
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, position=view.position)
    light, depth = wall_light()
    maps = {"shadow_map": depth}
    feature = pel.Feature["SHADOW_" + form.upper().removesuffix("_RADIAL")]
    if form == "moments":
        light.shadow_content = "moments"
        maps["shadow_map"] = np.stack([depth, depth * depth], -1)
    elif form == "exponential":
        light.shadow_content, light.shadow_exponent = "exponential", 80
        maps["shadow_map"] = np.exp(80 * depth)
    elif form == "cascades":
        light.shadow_cascades = 2
        light.cascade_to_shadow = np.stack([light.world_to_shadow] * 3)  # the second is as the first was
        light.cascade_depth_range = [50, 50, 50]
        light.world_to_shadow = [1 / 6, 0, 0, 0.5, 0, -1 / 6, 0, 0.5, 0, 0, -1 / 50, 0.5, 0, 0, 0, 1]
        maps["cascade_1"] = depth.copy()
    else:
        height = 60
        light = pel.Light(type="point", position=[0, 0, height], color=[1, 1, 1], shadow_filter_texels=32,
                          shadow_projection="cube_radial", shadow_depth_range=100,
                          world_to_shadow=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -height, 0, 0, 0, 1])
        maps["shadow_map"] = np.where(cube_directions(64)[..., 0] < 0, 0.2, 1).reshape(6 * 64, 64).astype(np.float32)
    shader.set_lights([light]).set_material(1, pel.Material(shadow_filter_width=4))
    for slot, image in maps.items():
        shader.set_light_image(0, slot, image)
    shader.commit().execute()
    assert shader.stats().features == pel.Feature.SHADOW | pel.Feature.FILTER_SHADOW | feature
    lambert = view.albedo * view.normal[..., 2:]
    if form == "cube_radial":
        away = np.float32([0, 0, height]) - view.position
        square = (away ** 2).sum(-1, keepdims=True)
        lambert = view.albedo * np.maximum((view.normal * away).sum(-1, keepdims=True), 0) / square ** 1.5
    x = view.position[..., 0]
    assert np.abs(out[view.inside & (x < -2.5)]).max() <= 1e-3 * lambert.max()
    lit = view.inside & (x > 2.5)
    assert np.abs(out - lambert)[lit].max() < 1e-5


def test_outputs_add_up_to_radiance(device, view, tolerance):
    shader, out = show_blurred_normal(device, view)
    shader.set_lights([pel.Light(to_light=view.to_light)]).set_camera(pel.Camera(position=[0, 0, 100]))
    shader.set_image("thickness", np.full((HEIGHT, WIDTH), 4, np.float32))
    shader.set_material(1, pel.Material(specular=1, specular_model="ggx", deep_scatter_color=[1, 0.2, 0.1],
                                        deep_scatter_ambient=0.5))
    parts = {name: np.zeros((HEIGHT, WIDTH, 3), np.float32) for name in ("out_diffuse", "out_deep_scatter", "out_specular")}
    thickness = np.zeros((HEIGHT, WIDTH), np.float16)
    for name, image in parts.items():
        shader.set_image(name, image)
    shader.set_image("out_thickness", thickness).commit().execute()
    assert shader.stats().features & pel.Feature.OUTPUTS and shader.stats().features & pel.Feature.GGX
    assert all(image[view.inside].max() > 0.01 for image in parts.values())
    assert np.abs(sum(parts.values()) - out).max() < tolerance["shadeTerm"]
    assert (thickness == 4 * view.inside).all()


def test_ambient_cube(device, view, tolerance):
    # Light that grows along (1, 2, -1): a cube of it against the harmonics of order 1.
    d = cube_directions(32)
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    cube = np.repeat((0.6 + d @ [0.1, 0.2, -0.1])[..., None], 3, -1).astype(np.float32)
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out).set_lights([]).set_ambient_cube(cube).commit()
    shader.execute()
    assert shader.stats().features == pel.Feature.AMBIENT | pel.Feature.AMBIENT_CUBE
    expected = view.albedo * (0.6 + view.normal @ np.float32([0.1, 0.2, -0.1]))[..., None]
    assert np.abs(out - expected)[view.inside].max() < tolerance["cubeOfHarmonics"]
    once = out.copy()
    cube *= 2  # in place: seen by the next execution
    shader.execute()
    assert np.abs(out - 2 * once).max() < 1e-6
    shader.set_ambient_cube(np.concatenate(list(cube), 1)).commit().execute()  # side by side
    assert np.abs(out - 2 * once).max() < 1e-6
    shader.set_ambient_cube(None).commit().execute()
    assert not out.any()
    for wrong, message in [(np.zeros((5, 4, 4, 3), np.float32), "six faces"), (np.zeros((4, 4, 3), np.float32), "4 x 4"),
                           (np.zeros((6, 5, 4, 3), np.float32)[:, :4], "ascontiguousarray"),
                           (np.zeros((12, 2), np.float32), "three components")]:
        with pytest.raises((ValueError, pel.PellucidError), match=message):
            shader.set_ambient_cube(wrong)


def test_turned_taps_are_an_option(device, view):
    shader = shader_for(device, view, np.zeros((HEIGHT, WIDTH, 3), np.float32))
    assert not pel.ShaderOptions().rotate_taps
    shader.set_options(rotate_taps=1).commit().execute()  # no taps here: allowed, and nothing to turn
