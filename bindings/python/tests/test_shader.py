"""Shading: arrays, progress, programs and options, normal maps and ambient cubes."""
import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, black, shaded, shader_for

import pellucid as pel


@pytest.mark.parametrize("moving", [False, True])
def test_lambert(device, moving_device, view, tolerance, moving):
    radiance, albedo = np.full((HEIGHT, WIDTH, 3), -1, np.float32), view.albedo.copy()
    shader = shader_for(moving_device if moving else device, view, radiance, albedo=albedo)
    shader.execute()
    assert np.abs(radiance - view.lambert)[view.inside].max() < tolerance["shadeTerm"]
    assert (radiance[~view.inside] == -1).all()  # pixels without a material are left alone
    assert shader.stats().features == 0  # no curvature, no shadow, no ambient: only Lambert
    passes = shader.passes()
    assert [p.name for p in passes] == ["classify_tiles", "shade"]
    memory = shader.memory()
    assert [m.name for m in memory] == ["classify_tiles", "constants"]
    assert sum(m.held for m in memory) == sum(m.needed for m in memory) == shader.stats().scratch_bytes
    assert all(p.milliseconds > 0 and p.tiles == shader.stats().tiles_total for p in passes)
    albedo *= 0.5  # in place, without a commit
    shader.execute()
    assert np.abs(radiance - view.lambert / 2)[view.inside].max() < tolerance["shadeTerm"]
    radiance[...] = 0.25
    shader.set_options(accumulate=1).commit().execute()
    assert np.abs(radiance - 0.25 - view.lambert / 2)[view.inside].max() < tolerance["shadeTerm"]


@pytest.mark.parametrize("use, code", [
    (lambda s: s.execute(), pel.ErrorCode.INVALID_STATE),
    (lambda s: s.set_image("radiance", black()).commit(), None),  # no normals
    (lambda s: s.set_material(0, pel.Material()), None), (lambda s: s.set_lights([pel.Light()] * 65), None)])
def test_states(device, use, code):
    with pytest.raises(pel.PellucidError) as caught:
        use(pel.Shader(device))
    assert code in (None, caught.value.code)


@pytest.mark.parametrize("moving", [False, True])
def test_progress_of_a_large_frame(moving_device, moving):
    device = moving_device
    device._in_place = not moving and device.info.type == pel.DeviceType.CPU
    normal = np.zeros((1500, 2000, 3), np.float32)
    normal[..., 2] = 1
    images = [np.zeros_like(normal) for _ in range(3)]
    shaders = [pel.Shader(device).set_image("radiance", image).set_image("normal_shading", normal)
               .set_material(1, pel.Material()).set_lights(pel.Light()).commit() for image in images]
    shaders[0].execute()
    seen = []
    device.set_progress(lambda fraction, what: seen.append((fraction, what)))
    shaders[1].execute()
    fractions = [fraction for fraction, what in seen if what == "shading"]
    assert fractions[0] == 0 and fractions[-1] == 1 and 3 < len(seen) == len(fractions)
    assert fractions == sorted(fractions)
    assert np.array_equal(images[1], images[0]) and images[0].any()
    device.set_progress(lambda fraction, what: fraction < 0.5)
    with pytest.raises(pel.PellucidError) as caught:
        shaders[2].execute()
    assert caught.value.code is pel.ErrorCode.CANCELLED
    device.set_progress(None)
    shaders[2].execute()
    assert np.array_equal(images[2], images[0])


def test_a_material_may_name_its_profile(device, view):
    marble, curvature = pel.Profile.named("marble"), np.full((HEIGHT, WIDTH), 0.1, np.float32)

    def check(shader, profile):
        material = pel.Material(profile=profile)
        assert material.profile.info.name == "marble" and material.copy().profile is material.profile
        shader.set_material(1, material)
        del material
        resolved = shader.commit().material(1)
        assert resolved.diffusion_radius == marble.info.radius
        assert np.array_equal(resolved.normal_blend, marble.info.normal_blend)

    pictures = [shaded(device, view, lambda s, p=profile: check(s, p), curvature=curvature)
                for profile in ("marble", marble)]
    assert np.array_equal(*pictures) and np.abs(pictures[0] - view.lambert).max() > 0.01
    with pytest.raises(ValueError, match="Profile"):
        pel.Material(profile=3)
    with pytest.raises(pel.PellucidError, match="marble"):
        pel.Material(profile="granite")


def test_warnings_say_what_has_no_effect(device, view):
    shader = shader_for(device, view, black())
    assert shader.warnings() == []
    shader.set_material(1, pel.Material(deep_scatter_color=(1, 0, 0))).commit()
    assert len(shader.warnings()) == 1 and "deepScatterColor" in shader.warnings()[0]


def test_programs_are_built_ahead(device, view):
    shaders = [shader_for(device, view, black(), position=view.position) for _ in range(2)]
    for shader in shaders:
        shader.set_material(1, pel.Material(specular=1, shadow_filter_width=2))
    seen = []
    device.set_progress(lambda fraction, what: seen.append((fraction, what)))
    try:
        pel.warm_up_programs(device, shaders=shaders[:1])
    finally:
        device.set_progress(None)
    assert not seen or (seen[0][0] == 0 and seen[-1][0] == 1 and seen[0][1].startswith("building kernels 0/"))
    built = device.stats().programs_built
    shaders[1].commit()
    assert device.stats().programs_built == built and pel.warm_up_programs(device, shaders=shaders) == 0
    with pytest.raises(pel.PellucidError, match="PelProgramGroup"):
        pel.warm_up_programs(device, 64)


def test_normal_map(device, view):
    """As one array, whose levels are made; as a list of levels; in bytes; and taken away again."""
    texels, out = np.full((16, 8, 3), [0.6, 0, 0.8], np.float32), black()
    shader = shader_for(device, view, out, position=view.position,
                        uv=np.zeros((HEIGHT, WIDTH, 2), np.float32),
                        tangent=np.tile(np.float32([0, 1, 0]), (HEIGHT, WIDTH, 1)))
    shader.set_material(1, pel.Material(normal_blend=[1, 1, 1], diffusion_radius=3, uv_scale=100))
    shader.set_lights([]).set_ambient(pel.Ambient(sh=np.eye(9, 3, -1))).commit().execute()
    plain = out.copy()
    in_bytes = np.rint(np.dstack([texels * 127.5 + 127.5, texels[..., :1]])).astype(np.uint8)
    found = []
    for levels in (texels, [texels, texels[::2, ::2]], in_bytes, None):
        shader.set_normal_map(1, levels).commit().execute()
        assert bool(shader.stats().features & pel.Feature.NORMAL_MAP) == (levels is not None)
        found.append(out.copy())
    assert not np.allclose(found[0], plain) and np.array_equal(found[3], plain)
    assert np.allclose(found[0], found[1], atol=1e-6) and np.allclose(found[0], found[2], atol=0.01)
    with pytest.raises(ValueError, match="3 components of float64"):
        shader.set_normal_map(1, texels.astype(float))
    with pytest.raises(pel.PellucidError, match="must be 4 x 8"):
        shader.set_normal_map(1, [texels, texels])


def test_ambient_cube(device, view):
    cube = np.random.default_rng(3).uniform(0, 1, (6, 8, 8, 3)).astype(np.float32)
    out = black()
    shader = shader_for(device, view, out).set_lights([]).set_ambient_cube(cube).commit()
    shader.execute()
    assert shader.stats().features == pel.Feature.AMBIENT | pel.Feature.AMBIENT_CUBE
    once = out.copy()
    cube *= 2  # in place: seen by the next execution
    shader.execute()
    assert once[view.inside].max() > 0.1 and np.abs(out - 2 * once).max() < 1e-6
    shader.set_ambient_cube(np.concatenate(list(cube), 1)).commit().execute()  # side by side
    assert np.abs(out - 2 * once).max() < 1e-6
    shader.set_ambient_cube(None).commit().execute()
    assert not out.any()
    for wrong, message in [(np.zeros((5, 4, 4, 3), np.float32), "six faces"),
                           (np.zeros((4, 4, 3), np.float32), "4 x 4"),
                           (np.zeros((6, 5, 4, 3), np.float32)[:, :4], "ascontiguousarray"),
                           (np.zeros((12, 2), np.float32), "three components")]:
        with pytest.raises((ValueError, pel.PellucidError), match=message):
            shader.set_ambient_cube(wrong)
