"""Structures and enumerations: the same memory as in C, the same defaults, and wrong values named."""
import copy
import enum
import inspect
import pickle
import pydoc
from dataclasses import is_dataclass

import numpy as np
import pytest

import pellucid as pel
from pellucid import _native, _types
from pellucid._struct import Struct

STRUCTS = [t for t in vars(_types).values() if isinstance(t, type) and issubclass(t, Struct)
           and t is not Struct]


assert {"Material", "Light", "Camera", "CurvatureLutDesc", "ShaderStats"} <= {t.__name__ for t in STRUCTS}


@pytest.mark.parametrize("struct", STRUCTS, ids=lambda t: t.__name__)
def test_layout_is_the_compilers(struct):
    offsets = {name: offset for name, (_, offset, *_) in struct._dtype.fields.items()}
    assert offsets == _native.struct_offsets(struct._c_name)
    assert struct._dtype.itemsize == len(_native.struct_defaults(struct._c_name))
    assert struct()._data["struct_size"][0] == struct._dtype.itemsize


def test_fields_have_the_librarys_defaults_and_keep_what_they_are_given():
    assert pel.Material().roughness == np.float32(0.3) and pel.Material().profile is None
    assert pel.CurvatureLutDesc().width == 64 and pel.Light().spot_direction.tolist() == [0, 0, -1]
    light = pel.Light(type="spot", color=(1, 2, 3), range=5, world_to_shadow=np.arange(16).reshape(4, 4))
    assert light.type is pel.LightType.SPOT and light.color.tolist() == [1, 2, 3] and light.range == 5
    assert light.world_to_shadow.tolist() == list(range(16))
    twin = copy.copy(light)
    twin.range = 6
    assert light.range == 5 and copy.deepcopy(pel.Material(profile="skin")).profile.info.name == "skin"
    assert light.copy() == light and pel.Light() != light and light.to_dict()["type"] == "spot"
    table = pel.LutInfo(kind="shadow", shadow=pel.ShadowLutDesc(width=7))
    assert table.shadow.width == 7 and table.copy().shadow == table.shadow


@pytest.mark.parametrize("use, error, message", [
    (lambda: pel.Light(type="neon"), ValueError, "Light.type is 'neon'; it must be one of directional"),
    (lambda: pel.Light(type="directionl"), ValueError, "'directionl'; did you mean 'directional'"),
    (lambda: pel.Light(color=(1, 2)), ValueError, "Light.color is .*3 numbers"),
    (lambda: pel.Material(specular="much"), ValueError, "Material.specular is 'much'; it must be a number"),
    (lambda: pel.Material(thickness_taps=-1), ValueError, "Material.thickness_taps is -1; it must be from 0"),
    (lambda: pel.Material(thickness_taps=2.5), ValueError, "an integer"),
    (lambda: pel.CurvatureParams(estimator=99), ValueError, "estimator is 99; it must be one of edge"),
    (lambda: pel.LutInfo(shadow=pel.CurvatureLutDesc()), ValueError, "LutInfo.shadow is .*a ShadowLutDesc"),
    (lambda: pel.Material().albedo.fill(1), ValueError, "read-only"),
    (lambda: setattr(pel.Material(), "albdo", 1), AttributeError,
     "no field 'albdo'; did you mean 'albedo'.; it has albedo"),
    (lambda: pel.Material(roughnes=0.2), TypeError, "no field 'roughnes'; did you mean 'roughness'"),
    (lambda: pel.Profile.named("skn"), pel.PellucidError, "did you mean 'skin'"),
    (lambda: pel.Materal, AttributeError, "no attribute 'Materal'; did you mean 'Material'"),
])
def test_wrong_names_and_values_are_named(use, error, message):
    with pytest.raises(error, match=message):
        use()


def test_help_is_about_the_package():
    text = pydoc.plain(pydoc.render_doc(pel))
    # A structure takes about 70 lines; what NumPy and enumerations inherit would be thousands.
    assert len(text.splitlines()) < 4800
    assert "__divmod__" not in text and "roughness" in text and "SPOT" in text
    assert not {"Any", "annotations"} & set(dir(pel)) and set(pel.__all__) <= set(dir(pel))


def public(module):
    """Names of a module and of its classes' members."""
    found = {name: getattr(module, name) for name in module.__all__}
    for name, value in list(found.items()):
        if isinstance(value, type) and not issubclass(value, (Struct, enum.Enum)):
            members = {k: v for base in value.__mro__ if base.__module__.startswith("pellucid")
                       for k, v in vars(base).items() if not k.startswith("_")}
            found |= {f"{name}.{k}": v for k, v in members.items()
                      if callable(v) or isinstance(v, (property, classmethod, staticmethod))}
    return found


def test_calls_have_the_defaults_of_the_command():
    from pellucid import files, gltf
    from pellucid.conventions import camera_from_view_projection, light_from_view_projection
    calls = {name: call for name, call in public(pel).items() if not isinstance(call, property)}
    for call in (files.standard_head, files.load_mesh, files.reference, files.write_image, files.tonemap,
                 gltf.load_gltf, camera_from_view_projection, light_from_view_projection):
        calls[call.__name__] = call
    found = {}
    for name, call in calls.items():
        if isinstance(call, type) and (issubclass(call, (Struct, enum.Enum)) or is_dataclass(call)):
            continue
        for p in inspect.signature(getattr(call, "__func__", call)).parameters.values():
            # Calls wait unless told otherwise; other defaults than these are 0, False, None or empty.
            plain = p.default is True if p.name == "wait" else not p.default or p.default is p.empty
            if p.name[0] != "_" and not plain:
                found.setdefault(name, {})[p.name] = p.default
    integral = {"millimetres_per_unit": 1, "cut": (0, 0, 0), "tolerance": 1e-3}
    tone = {"exposure": 1, "shoulder": 0.8, "curve": "soft"}
    convention = {"depth": "-1..1", "y_up": True}
    assert found == {
        "Profile.burley": {"fit": pel.BurleyFit.DIFFUSE_TRANSMISSION}, "Profile.dipole": {"eta": 1.3},
        "Scatter.set_material": {"scale": 1}, "surface_integral": integral,
        "submit_surface_integral": integral, "standard_head": {"which": "female"},
        "load_mesh": {"up": "auto"}, "reference": {"samples": 64, "seed": 1, "boundary": "index-matched"},
        "write_image": tone, "tonemap": tone, "load_gltf": {"unit_mm": 1000},
        "camera_from_view_projection": convention,
        "light_from_view_projection": {**convention, "first_row": "top"}}


def test_every_public_name_is_documented():
    words = " ".join(pel.Material.__doc__.split())
    assert "share of the light that the profile lets through thin parts" in words
    source = _types.__loader__.get_data(_types.__file__).decode()
    assert "Material.shadow_filter_width" in source  # not the name in C
    found = public(pel)
    assert len(found) > 100 and not [name for name, part in found.items() if not (part.__doc__ or "").strip()]


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
