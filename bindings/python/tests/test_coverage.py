"""Everything that the C interface does can be reached from Python: each function of pellucid.h is called by
the native module, and each part of the native module by a Python file."""
import ast
import inspect
import re

from places import ROOT

import pellucid as pel
from pellucid import _native

# Functions that the native module does not name, beside those that count references, and what stands for
# them.
OTHERWISE = {"pelDeviceCreate": "pellucid::Device(", "pelDeviceCreateFromCl": "pellucid::Device::fromCl(",
             "pelEventWait": "pelEventIsDone(", "pelLutGetSize": "pelLutRead("}


def declared():
    text = (ROOT / "host/include/pellucid/pellucid.h").read_text()
    return re.findall(r"PEL_API[^;(]*?\b(pel[A-Z]\w*)\s*\(", text)


def sources(folder, pattern):
    return "\n".join(p.read_text() for p in sorted((ROOT / folder).glob(pattern)))


def test_every_function_of_the_header_is_called():
    functions = declared()
    assert len(functions) > 60
    native = sources("bindings/python/native", "*.cpp")
    assert all(call in native for call in OTHERWISE.values())
    missing = [f for f in functions
               if not (re.search(rf"\b{f}\b", native) or f in OTHERWISE
                       or re.fullmatch(r"pel\w+(Retain|Release)", f))]
    assert not missing, f"no way from Python to {', '.join(missing)}"


def test_every_enumeration_and_structure_is_there():
    text = (ROOT / "host/include/pellucid/pellucid.h").read_text()
    # Structures of pointers and handles, and what stands for them.
    arrays = {"PelImageDesc": pel.Image, "PelVertexView": pel.Vertices,
              "PelMeshTopologyDesc": pel.MeshTopology,
              "PelSubmit": pel.Event, "PelGaussian": pel.Profile.gaussians,
              "PelVertexRange": pel.LiveMesh.update,
              "PelWarmUp": pel.warm_up_programs, "PelTextureScatterDesc": pel.TextureScatter,
              "PelSurfaceIntegralDesc": pel.surface_integral}
    names = re.findall(r"typedef (?:enum|struct) (Pel\w+) \{", text)
    assert len(names) > 35
    missing = [n for n in names if n not in arrays
               and not hasattr(pel, "ErrorCode" if n == "PelError" else n[3:])]
    assert not missing


def native_parts():
    for name, value in vars(_native).items():
        if inspect.isclass(value):
            yield from ((f"{name}.{member}", member) for member in vars(value) if not member.startswith("_"))
        elif callable(value):
            yield name, name


def test_every_native_function_is_used_and_described():
    # A function that no Python file calls is as far away as one that is not bound.
    python = sources("bindings/python/pellucid", "*.py") + sources("apps", "*/*/*.py")
    stubs = sources("bindings/python/pellucid", "_native.pyi")
    parts = sorted(native_parts())
    assert len(parts) > 60
    unused = [p for p,
              member in parts if not re.search(rf"\.{member}\b", python) and member != "struct_offsets"]
    assert not unused, "of use to the tests alone"
    assert not [p for p, member in parts if not re.search(rf"^\s*(def )?{member}[(:]", stubs, re.M)]


def test_every_native_function_that_is_described_is_there():
    described = []
    for node in ast.parse(sources("bindings/python/pellucid", "_native.pyi")).body:
        if isinstance(node, ast.FunctionDef):
            described.append((_native, node.name))
        elif isinstance(node, ast.ClassDef):
            kind = getattr(_native, node.name)
            described += [(kind, part.name if isinstance(part, ast.FunctionDef) else part.target.id)
                          for part in node.body if isinstance(part, (ast.FunctionDef, ast.AnnAssign))]
    assert len(described) > 60
    assert not [(owner.__name__, name) for owner, name in described if not hasattr(owner, name)]


def test_every_call_that_does_work_can_be_submitted():
    for owner, name in [(pel.MeshTopology, "curvature"), (pel.MeshTopology, "normals"),
                        (pel.LiveMesh, "update"),
                        (pel.Buffer, "read"), (pel.Buffer, "write"), (pel.Lut, "read"),
                        (pel, "screen_curvature"),
                        (pel, "surface_integral"), (pel.Scatter, "execute"),
                        (pel.TextureScatter, "set_positions"),
                        (pel.TextureScatter, "draw"), (pel.TextureScatter, "execute")]:
        submit = getattr(owner, f"submit_{name}")
        known = inspect.signature(submit).parameters
        assert {"waits"} <= set(known), name
        for parameter in inspect.signature(getattr(owner, name)).parameters.values():
            same = known.get(parameter.name, parameter)
            assert same.default in (parameter.default, inspect.Parameter.empty), f"{name}: {parameter}"
    assert "waits" in inspect.signature(pel.Shader.submit).parameters
    for kind in ("curvature", "shadow", "specular", "eye"):
        assert {"wait", "waits"} <= set(inspect.signature(getattr(pel.Lut, kind)).parameters)
