"""Shading: arrays, progress, programs and options."""
import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, shader_for

import pellucid as pel


@pytest.mark.parametrize("moving", [False, True])
def test_lambert(device, moving_device, view, tolerance, moving):
    radiance = np.full((HEIGHT, WIDTH, 3), -1, np.float32)
    shader = shader_for(moving_device if moving else device, view, radiance)
    shader.execute()
    assert np.abs(radiance - view.lambert)[view.inside].max() < tolerance["shadeTerm"]
    assert (radiance[~view.inside] == -1).all()  # pixels without a material are left alone
    assert shader.stats().features == 0  # no curvature, no shadow, no ambient: only Lambert


def test_changed_arrays_are_seen_without_a_commit(device, view, tolerance):
    albedo = view.albedo.copy()
    radiance = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, radiance, albedo=albedo)
    shader.execute()
    albedo *= 0.5
    shader.execute()
    assert np.abs(radiance - view.lambert / 2).max() < tolerance["shadeTerm"]


def test_submitted_work_keeps_its_arrays(device, view):
    import gc

    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, albedo=view.albedo.copy())
    events = [shader.submit() for _ in range(20)]
    del shader
    gc.collect()
    events[-1].wait()
    assert np.abs(out - view.lambert).max() < 1e-3


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
    shaders = [pel.Shader(device).set_image("radiance", image) for image in images]
    for shader in shaders:
        shader.set_image("normal_shading",
                         normal).set_material(1, pel.Material()).set_lights([pel.Light()]).commit()
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
        assert resolved.diffusion_radius == info.radius
        assert np.array_equal(resolved.normal_blend, info.normal_blend)
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


def test_programs_are_built_ahead(device, view):
    shaders = [shader_for(device, view, np.zeros((HEIGHT, WIDTH, 3), np.float32)) for _ in range(2)]
    for shader in shaders:
        shader.set_image("position",
                         view.position).set_material(1, pel.Material(specular=1, shadow_filter_width=2))
    told = []
    device.set_progress(lambda fraction, what: told.append((fraction, what)))
    try:
        pel.warm_up_programs(device, shaders=shaders[:1])
    finally:
        device.set_progress(None)
    assert not told or (told[0][0] == 0 and told[-1][0] == 1 and told[0][1].startswith("building kernels 0/"))
    built = device.stats().programs_built
    shaders[1].commit()
    assert device.stats().programs_built == built and pel.warm_up_programs(device, shaders=shaders) == 0
    with pytest.raises(pel.PellucidError, match="PelProgramGroup"):
        pel.warm_up_programs(device, 64)


def test_options_are_passed_on(device, view, tolerance):
    out = np.full((HEIGHT, WIDTH, 3), 0.25, np.float32)
    shader_for(device, view, out).set_options(accumulate=1).commit().execute()
    assert np.abs(out - 0.25 - view.lambert)[view.inside].max() < tolerance["shadeTerm"]
