"""Structures and enumerations: the same memory as in C, the same defaults, and wrong values named."""
import pickle

import numpy as np
import pytest

import pellucid as pel
from pellucid import _native, _types
from pellucid._struct import Struct

STRUCTS = [t for t in vars(_types).values() if isinstance(t, type) and issubclass(t, Struct) and t is not Struct]


@pytest.mark.parametrize("struct", STRUCTS, ids=lambda t: t.__name__)
def test_layout_is_the_compilers(struct):
    offsets = {name: offset for name, (_, offset, *_) in struct._dtype.fields.items()}
    assert offsets == _native.struct_offsets(struct._c_name)
    assert struct._dtype.itemsize == len(_native.struct_defaults(struct._c_name))
    assert struct()._data["struct_size"][0] == struct._dtype.itemsize


def test_all_plain_structures_are_there():
    assert {"Material", "Light", "Camera", "CurvatureLutDesc", "ShaderStats"} <= {t.__name__ for t in STRUCTS}


def test_defaults_come_from_the_library():
    assert pel.Material().diffusion_radius == np.float32(2.7)
    assert pel.CurvatureLutDesc().width == 512
    assert pel.Light().spot_direction.tolist() == [0, 0, -1]


def test_fields_keep_what_they_are_given():
    light = pel.Light(type="spot", color=(1, 2, 3), range=5, world_to_shadow=np.arange(16).reshape(4, 4))
    assert light.type is pel.LightType.SPOT
    assert light.color.tolist() == [1, 2, 3] and light.range == 5
    assert light.world_to_shadow.tolist() == list(range(16))
    assert light.copy() == light and pel.Light() != light
    assert light.to_dict()["type"] == "spot"


@pytest.mark.parametrize("use, message", [
    (lambda: pel.Light(type="neon"), "Light.type is 'neon'; it must be one of directional, point, spot"),
    (lambda: pel.Light(color=(1, 2)), "Light.color is .*3 numbers"),
    (lambda: pel.Material(specular="much"), "Material.specular is 'much'; it must be a number"),
    (lambda: pel.Material(thickness_taps=-1), "Material.thickness_taps is -1; it must be from 0 to"),
    (lambda: pel.Material(thickness_taps=2.5), "an integer"),
    (lambda: pel.CurvatureParams(estimator=99), "estimator is 99; it must be one of edge"),
])
def test_wrong_values_are_named(use, message):
    with pytest.raises(ValueError, match=message):
        use()


def test_unknown_fields_are_named():
    material = pel.Material()
    with pytest.raises(AttributeError, match="no field 'albdo'; it has albedo"):
        material.albdo = (1, 1, 1)
    with pytest.raises(TypeError):
        pel.Material(albdo=(1, 1, 1))


def test_array_fields_come_back_read_only():
    with pytest.raises(ValueError, match="read-only"):
        pel.Material().albedo[0] = 1


def test_documentation_has_units_and_python_names():
    assert "length; 2.7 mm for skin" in pel.Material.__doc__
    assert "Material.shadow_filter_width" in pel.LightSlot.__dict__.get("__doc__", "") + _types.__loader__.get_data(
        _types.__file__).decode()
    for name in pel.__all__:
        assert getattr(pel, name).__doc__, name


def test_errors_travel_between_processes():
    error = pickle.loads(pickle.dumps(pel.PellucidError(3, "no device")))
    assert error.code is pel.ErrorCode.NO_DEVICE and str(error) == "no device"
