"""Structures and enumerations: the same memory as in C, the same defaults, and wrong values named."""
import enum
import pickle
import pydoc

import numpy as np
import pytest

import pellucid as pel
from pellucid import _native, _types
from pellucid._struct import Struct

STRUCTS = [t for t in vars(_types).values() if isinstance(t, type) and issubclass(t, Struct)
           and t is not Struct]


@pytest.mark.parametrize("struct", STRUCTS, ids=lambda t: t.__name__)
def test_layout_is_the_compilers(struct):
    offsets = {name: offset for name, (_, offset, *_) in struct._dtype.fields.items()}
    assert offsets == _native.struct_offsets(struct._c_name)
    assert struct._dtype.itemsize == len(_native.struct_defaults(struct._c_name))
    assert struct()._data["struct_size"][0] == struct._dtype.itemsize


def test_all_plain_structures_are_there():
    assert {"Material", "Light", "Camera", "CurvatureLutDesc", "ShaderStats"} <= {t.__name__ for t in STRUCTS}


def test_defaults_come_from_the_library():
    assert pel.Material().roughness == np.float32(0.3)
    assert pel.Material().profile is None
    assert pel.CurvatureLutDesc().width == 64
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
    with pytest.raises(AttributeError, match="no field 'albdo'; did you mean 'albedo'.; it has albedo"):
        material.albdo = (1, 1, 1)
    with pytest.raises(TypeError, match="Material has no field 'roughnes'; did you mean 'roughness'"):
        pel.Material(roughnes=0.2)
    with pytest.raises(TypeError, match="did you mean 'width'"):
        pel.CurvatureLutDesc(widht=4)
    with pytest.raises(ValueError, match="'directionl'; did you mean 'directional'"):
        pel.Light(type="directionl")
    with pytest.raises(pel.PellucidError, match="did you mean 'skin'"):
        pel.Profile.named("skn")
    with pytest.raises(AttributeError, match="no attribute 'Materal'; did you mean 'Material'"):
        _ = pel.Materal


def test_help_is_about_the_package():
    text = pydoc.plain(pydoc.render_doc(pel))
    assert len(text.splitlines()) < 4500
    assert "__divmod__" not in text and "roughness" in text and "SPOT" in text
    assert not {"Any", "annotations"} & set(dir(pel)) and set(pel.__all__) <= set(dir(pel))


def test_array_fields_come_back_read_only():
    with pytest.raises(ValueError, match="read-only"):
        pel.Material().albedo[0] = 1


def test_documentation_has_units_and_python_names():
    words = " ".join(pel.Material.__doc__.split())
    assert "share of the light that the profile lets through thin parts" in words
    source = _types.__loader__.get_data(_types.__file__).decode()
    assert "Material.shadow_filter_width" in (pel.LightSlot.__doc__ or "") + source
    for name in pel.__all__:
        assert getattr(pel, name).__doc__, name


def public_members():
    for name in pel.__all__:
        value = getattr(pel, name)
        yield name, value
        if isinstance(value, type) and not issubclass(value, (Struct, enum.Enum)):
            members = {k: v for base in value.__mro__ if base.__module__.startswith("pellucid") for k,
                       v in vars(base).items()}
            for member, part in members.items():
                if not member.startswith("_") and (callable(part)
                                                   or isinstance(part,
                                                                 (property, classmethod, staticmethod))):
                    yield f"{name}.{member}", part


def test_every_public_name_is_documented():
    found = dict(public_members())
    assert len(found) > 100
    assert not [name for name, part in found.items() if not (part.__doc__ or "").strip()]


@pytest.mark.parametrize("made, instead", [
    (lambda d: d, "pellucid.Device"), (lambda d: pel.Buffer(d, 8), "Buffer.read"),
    (lambda d: pel.Profile.skin(), "make one there"),
    (lambda d: pel.Lut.specular(d, width=4, height=4), "Lut.from_texels"),
    (lambda d: pel.Shader(d), "make one"),
    (lambda d: pel.MeshTopology(d, [[0, 1, 2]], 3), "MeshTopology.load")])
def test_what_a_device_holds_is_not_pickled(device, made, instead):
    with pytest.raises(TypeError, match=f"belongs to this process.*{instead}"):
        pickle.dumps(made(device))


def test_errors_travel_between_processes():
    error = pickle.loads(pickle.dumps(pel.PellucidError(3, "no device")))
    assert error.code is pel.ErrorCode.NO_DEVICE and str(error) == "no device"
