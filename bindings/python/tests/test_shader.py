"""Shading, against Lambert and Schlick written out in NumPy, in many layouts."""
import numpy as np
import pytest

import pellucid as pel

HEIGHT, WIDTH = 37, 61


class View:
    """A sphere of radius 10 seen from +z, orthographic, material 1 on a background of 0."""

    def __init__(self):
        y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
        px, py = (x - WIDTH / 2 + 0.5) / 1.6, (HEIGHT / 2 - 0.5 - y) / 1.6
        inside = px**2 + py**2 < 100
        pz = np.sqrt(np.where(inside, 100 - px**2 - py**2, 0))
        self.position = (np.stack([px, py, pz], -1) * inside[..., None]).astype(np.float32)
        self.normal = self.position / 10
        self.material = inside.astype(np.uint8)
        self.albedo = np.random.default_rng(1).uniform(0.2, 0.9, (HEIGHT, WIDTH, 3)).astype(np.float32) * inside[..., None]
        self.inside = inside
        self.to_light = np.float32([0.6, 0.0, 0.8])
        self.lambert = self.albedo * np.maximum(self.normal @ self.to_light, 0)[..., None]


@pytest.fixture(scope="module")
def view():
    return View()


def shader_for(device, view, radiance, **images):
    given = dict(normal_shading=view.normal, material=view.material, albedo=view.albedo) | images
    shader = pel.Shader(device).set_image("radiance", radiance)
    for slot, image in given.items():
        shader.set_image(slot, image)
    shader.set_material(1, pel.Material()).set_lights([pel.Light(to_light=view.to_light)])
    return shader.commit()


@pytest.mark.parametrize("moving", [False, True])
def test_lambert(device, moving_device, view, tolerance, moving):
    radiance = np.full((HEIGHT, WIDTH, 3), -1, np.float32)
    shader = shader_for(moving_device if moving else device, view, radiance)
    shader.execute()
    assert np.abs(radiance - view.lambert)[view.inside].max() < tolerance["shadeTerm"]
    assert (radiance[~view.inside] == -1).all()  # pixels without a material are left alone
    assert shader.stats().features == 0  # no curvature, no shadow, no ambient: nothing but Lambert


def test_changed_arrays_are_seen_without_a_commit(device, view, tolerance):
    albedo = view.albedo.copy()
    radiance = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, radiance, albedo=albedo)
    shader.execute()
    albedo *= 0.5
    shader.execute()
    assert np.abs(radiance - view.lambert / 2).max() < tolerance["shadeTerm"]


def strided(image):
    """The same values inside a larger array, with gaps between pixels and rows."""
    memory = np.full((image.shape[0] * 2, image.shape[1] + 3, image.shape[2] + 2), 7, image.dtype)
    part = memory[::2, 1:-2, 1:-1]
    part[...] = image
    return part


LAYOUTS = {
    "strided": strided,
    "planar": lambda a: np.ascontiguousarray(a.transpose(2, 0, 1)).transpose(1, 2, 0),
    "four components": lambda a: np.concatenate([a, np.full((*a.shape[:2], 1), 9, a.dtype)], -1),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts_give_the_same_bits(device, view, layout):
    expected = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader_for(device, view, expected).execute()
    change = LAYOUTS[layout]
    out = change(np.zeros((HEIGHT, WIDTH, 3), np.float32)) if layout != "planar" else np.zeros_like(expected)
    shader_for(device, view, out, normal_shading=change(view.normal), albedo=change(view.albedo)).execute()
    assert np.array_equal(out[..., :3], expected)
    if layout == "strided":
        assert (out.base == 7).sum() == out.base.size - out.size  # the gaps are untouched


def test_columns_in_place_of_rows_are_refused(device):
    with pytest.raises(pel.PellucidError, match="rowStride"):
        pel.Shader(device).set_image("albedo", np.zeros((5, 4, 3), np.float32).transpose(1, 0, 2))


def test_half_and_bytes(device, view):
    half = np.zeros((HEIGHT, WIDTH, 4), np.float16)
    shader_for(device, view, half, normal_shading=view.normal.astype(np.float16),
               albedo=np.dstack([np.rint(view.albedo * 255), view.inside]).astype(np.uint8)).execute()
    # Half normals err by 2^-12 each, bytes by 1/510, half results by 2^-12 of at most 1.
    assert np.abs(half[..., :3].astype(float) - view.lambert).max() < 2**-11 * 2 + 1 / 510


def test_scattering_softens_the_terminator(device, view):
    lut = pel.Lut.curvature(device, width=128, height=32)
    curvature = np.where(view.inside, np.float32(0.1), 0)
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, curvature=curvature)
    shader.set_material(1, pel.Material(), lut).commit().execute()
    assert shader.stats().features & pel.Feature.DIRECT_SCATTER
    dark = view.inside & (view.normal @ view.to_light < -0.02) & (view.normal @ view.to_light > -0.1)
    light = out[dark] / view.albedo[dark]
    assert (light[:, 0] > 0.005).all() and (light[:, 0] > light[:, 2]).all()  # red crosses the terminator


def test_accumulate(device, view, tolerance):
    out = np.full((HEIGHT, WIDTH, 3), 0.25, np.float32)
    shader = shader_for(device, view, out).set_options(accumulate=1).commit()
    shader.execute()
    assert np.abs(out - 0.25 - view.lambert)[view.inside].max() < tolerance["shadeTerm"]


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_invalid_pixels_are_always_counted(device, view, value):
    radiance = np.ones((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, radiance, normal_shading=np.full_like(view.normal, value))
    shader.execute()
    stats = shader.stats()
    assert stats.pixels_invalid == stats.pixels_shaded == view.inside.sum()
    assert (radiance[view.inside] == 0).all()


def test_submitted_work_keeps_its_arrays(device, view):
    import gc

    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, albedo=view.albedo.copy())
    events = [shader.submit() for _ in range(20)]
    del shader
    gc.collect()
    events[-1].wait()
    assert np.abs(out - view.lambert).max() < 1e-3


@pytest.mark.parametrize("slot, image, message", [
    ("normal_shading", np.zeros((4, 4, 3)), "normal_shading has 3 components of float64"),
    ("normal_shading", np.zeros(4, np.float32), r"normal_shading has the shape \(4,\)"),
    ("normal_shading", np.zeros((4, 4, 5), np.float32), "normal_shading has 5 components of float32"),
    ("normal_shading", np.zeros((4, 4, 3), np.float32)[::-1], "normal_shading has a negative stride"),
    ("albedo", np.broadcast_to(np.float32(1), (4, 4, 3)), "albedo is broadcast"),
    ("albedo", np.zeros((3, 4, 4), np.float16).transpose(1, 2, 0), "components that lie apart"),
    ("albdo", np.zeros((4, 4, 3), np.float32), "slot is 'albdo'; it must be one of radiance"),
    ("normal_shading", np.zeros((4, 4, 3), ">f4"), "normal_shading has the byte order of another machine .*big-endian"),
    ("albedo", np.zeros((4, 4, 3), ">f2"), "albedo has the byte order of another machine"),
    ("albedo", np.zeros((3, 4, 4), ">f4").transpose(1, 2, 0), "albedo has the byte order of another machine"),
    ("material", np.ones((4, 4), ">u2"), "material has the byte order of another machine"),
    ("material", np.ones((4, 4), ">u4"), "material has the byte order of another machine"),
    ("normal_shading", np.zeros((4, 4, 2), ">i2"), "normal_shading has the byte order of another machine"),
    ("curvature", np.zeros((1, 1), ">f4"), "curvature has the byte order of another machine"),
])
def test_images_that_do_not_fit_are_named(device, slot, image, message):
    with pytest.raises(ValueError, match=message):
        pel.Shader(device).set_image(slot, image)


def test_formats_by_name(device):
    buffer = pel.Buffer(device, 4 * 4 * 4)
    pel.Shader(device).set_image("albedo", pel.Image(device, np.zeros((4, 4, 4), np.uint8), "rgba8_srgb"))
    pel.Shader(device).set_image("albedo", pel.Image(device, buffer, "rgba8_unorm", width=4, height=4))
    with pytest.raises(ValueError, match="needs format, width and height"):
        pel.Image(device, buffer)
    with pytest.raises(ValueError, match="stored as 4 x uint8, the array as 3 x float32"):
        pel.Image(device, np.zeros((4, 4, 3), np.float32), "rgba8_srgb")
    with pytest.raises(pel.PellucidError):
        pel.Shader(device).set_image("albedo", pel.Image(device, buffer, "rgba8_unorm", width=5, height=4))


def test_a_named_format_does_not_hide_the_byte_order(device):
    with pytest.raises(ValueError, match="byte order of another machine"):
        pel.Image(device, np.zeros((4, 4), ">u2"), "r16_uint")
    pel.Image(device, np.zeros((4, 4, 3), "<f4" if np.dtype("<f4").isnative else ">f4"))  # named, and this machine's own
    pel.Image(device, np.zeros((4, 4, 4), ">u1"))  # bytes have no order


def test_read_only_radiance_is_refused(device):
    radiance = np.zeros((4, 4, 3), np.float32)
    radiance.flags.writeable = False
    with pytest.raises(ValueError, match="radiance is read-only"):
        pel.Shader(device).set_image("radiance", radiance)


def test_states(device, view):
    shader = pel.Shader(device)
    with pytest.raises(pel.PellucidError) as caught:
        shader.execute()
    assert caught.value.code is pel.ErrorCode.INVALID_STATE
    with pytest.raises(pel.PellucidError):
        shader.set_image("radiance", np.zeros((4, 4, 3), np.float32)).commit()  # no normals
    with pytest.raises(pel.PellucidError):
        shader.set_material(0, pel.Material())
    with pytest.raises(pel.PellucidError):
        shader.set_lights([pel.Light()] * 65)


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


class Fractions:
    def __init__(self, last=2.0):
        self.seen, self.last = [], last

    def __call__(self, fraction, what):
        assert what == "shading"
        self.seen.append(fraction)
        return fraction < self.last


@pytest.mark.parametrize("moving", [False, True])
def test_progress_of_a_large_frame(moving):
    device = pel.Device()
    if moving:
        device._in_place = False
    normal = np.zeros((1500, 2000, 3), np.float32)
    normal[..., 2] = 1
    images = [np.zeros_like(normal) for _ in range(3)]
    shaders = [pel.Shader(device).set_image("radiance", i).set_image("normal_shading", normal).set_material(1, pel.Material())
               .set_lights([pel.Light()]).commit() for i in images]
    shaders[0].execute()
    told = Fractions()
    device.set_progress(told)
    shaders[1].execute()
    assert told.seen[0] == 0 and told.seen[-1] == 1 and len(told.seen) > 3 and told.seen == sorted(told.seen)
    assert np.array_equal(images[1], images[0]) and images[0].any()
    device.set_progress(Fractions(0.5))
    with pytest.raises(pel.PellucidError) as caught:
        shaders[2].execute()
    assert caught.value.code is pel.ErrorCode.CANCELLED
    device.set_progress(None)
    shaders[2].execute()
    assert np.array_equal(images[2], images[0])


def cube_directions(n):
    """The directions of the texels of a cube map's six faces, (6, n, n, 3)."""
    s, t = np.meshgrid((2 * np.arange(n) + 1) / n - 1, (2 * np.arange(n) + 1) / n - 1)
    one = np.ones_like(s)
    return np.stack([np.stack(f, -1) for f in [(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one)]])


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


def test_programs_are_built_ahead_and_frames_in_bands():
    device = pel.Device()
    rows, columns = np.mgrid[0:60, 0:64].astype(np.float32)
    position = np.dstack([columns, rows, np.zeros_like(rows)])
    normal = np.zeros_like(position)
    normal[..., 2] = 1
    normal[::3, :, 0] = 0.3
    light = pel.Light(shadow_depth_range=100.0, shadow_filter_texels=8)
    light.world_to_shadow = np.diag([1 / 64, 1 / 64, 0.01, 1]).astype(np.float32)
    depth = np.full((32, 32), 0.2, np.float32)

    def shader(out, **options):
        s = pel.Shader(device).set_options(**options).set_image("radiance", out).set_image("normal_shading", normal)
        s.set_image("position", position).set_material(1, pel.Material(shadow_filter_width=20.0)).set_lights([light])
        return s.set_light_image(0, "shadow_map", depth)

    whole, banded = np.zeros_like(position), np.zeros_like(position)
    ahead = shader(np.zeros_like(position))
    told = []
    device.set_progress(lambda fraction, what: told.append((fraction, what)))
    assert pel.warm_up_programs(device, shaders=[ahead]) == 2  # shading, wide shadow
    assert told[0] == (0, "building programs") and told[-1] == (1, "building programs")
    device.set_progress(None)
    built = device.stats().programs_built
    shader(whole).commit().execute()
    bands = shader(banded, scratch_budget=64 * 4 * 20).commit()
    bands.execute()
    assert device.stats().programs_built == built and pel.warm_up_programs(device, shaders=[ahead]) == 0
    assert bands.stats().bands == 3
    assert np.array_equal(whole, banded) and whole.any()
    with pytest.raises(pel.PellucidError, match="at least 512"):
        shader(banded, scratch_budget=100).commit()
    with pytest.raises(pel.PellucidError, match="PelProgramGroup"):
        pel.warm_up_programs(device, 64)


def test_a_material_may_name_its_profile(device, view):
    curvature = np.full((HEIGHT, WIDTH), 0.1, np.float32)
    pictures = []
    for profile in ("marble", pel.Profile.named("marble")):
        radiance = np.zeros((HEIGHT, WIDTH, 3), np.float32)
        shader = shader_for(device, view, radiance, curvature=curvature)
        material = pel.Material(profile=profile)
        assert material.profile.info.name == "marble" and material.copy().profile is material.profile
        shader.set_material(1, material)
        del material
        shader.commit().execute()
        pictures.append(radiance)
        resolved, info = shader.material(1), pel.Profile.named("marble").info
        assert resolved.diffusion_radius == info.radius and np.array_equal(resolved.normal_blend, info.normal_blend)
    assert np.array_equal(*pictures) and np.abs(pictures[0] - view.lambert).max() > 0.01
    with pytest.raises(ValueError, match="Profile"):
        pel.Material(profile=3)
    with pytest.raises(pel.PellucidError, match="marble"):
        pel.Material(profile="granite")


def test_warnings_say_what_has_no_effect(device, view):
    shader = shader_for(device, view, np.zeros((HEIGHT, WIDTH, 3), np.float32))
    assert shader.warnings() == []
    shader.set_material(1, pel.Material(deep_scatter_color=(1, 0, 0))).commit()
    assert len(shader.warnings()) == 1 and "deepScatterColor" in shader.warnings()[0]
