"""Everything that the C interface does can be reached from Python: each function of pellucid.h is called by
the native module, and each part of the native module by a Python file."""
import ast
import inspect
import re

from places import ROOT

import pellucid as pel
from pellucid import _native

HEADER = (ROOT / "host/include/pellucid/pellucid.h").read_text()
# Functions that the native module does not name, except reference counting, and what stands for them.
OTHERWISE = {"pelDeviceCreate": "pellucid::Device(", "pelDeviceCreateFromCl": "pellucid::Device::fromCl(",
             "pelDeviceCreateWith": "pellucid::Device(desc)", "pelSetName": "named<Shader>(",
             "pelErrorName": "PellucidError", "pelEventWait": "pelEventIsDone(",
             "pelLutGetSize": "pelLutRead", "pelProfileLibraryName": "Profile::libraryNames",
             "pelMeshTopologySave": "t.save()"}
# Structures of pointers and handles, and what stands for them.
ARRAYS = {"PelImageDesc": pel.Image, "PelVertexView": pel.Vertices, "PelMeshTopologyDesc": pel.MeshTopology,
          "PelSubmit": pel.Event, "PelGaussian": pel.Profile.gaussians, "PelVertexRange": pel.LiveMesh.update,
          "PelWarmUp": pel.warm_up_programs, "PelScatterWork": pel.Scatter.warm_up,
          "PelTextureScatterDesc": pel.TextureScatter,
          "PelDeviceDesc": pel.Device, "PelSurfaceIntegralDesc": pel.surface_integral}


def sources(folder, pattern):
    return "\n".join(p.read_text() for p in sorted((ROOT / folder).glob(pattern)))


def test_every_function_enumeration_and_structure_of_the_header_is_there():
    functions = re.findall(r"PEL_API[^;(]*?\b(pel[A-Z]\w*)\s*\(", HEADER)
    native = sources("bindings/python/native", "*.cpp")
    assert len(functions) > 60 and all(call in native for call in OTHERWISE.values())
    missing = [f for f in functions if not (re.search(rf"\b{f}\b", native) or f in OTHERWISE
                                            or re.fullmatch(r"pel\w+(Retain|Release)", f))]
    names = re.findall(r"typedef (?:enum|struct) (Pel\w+) \{", HEADER)
    assert len(names) > 35
    missing += [n for n in names if n not in ARRAYS
                and not hasattr(pel, "ErrorCode" if n == "PelError" else n[3:])]
    assert not missing, f"no way from Python to {', '.join(missing)}"


def test_every_native_function_is_used_and_described():
    # A function that no Python file calls is as far away as one that is not bound.
    python = sources("bindings/python/pellucid", "*.py") + sources("apps", "*/*/*.py")
    found = {name for name, value in vars(_native).items() if callable(value) and not inspect.isclass(value)}
    found |= {f"{kind}.{member}" for kind, value in vars(_native).items() if inspect.isclass(value)
              for member in vars(value) if not member.startswith("_")}
    assert len(found) > 60
    names = {part: part.split(".")[-1] for part in found}
    assert not [part for part, name in names.items()
                if not re.search(rf"\.{name}\b", python) and name != "struct_offsets"], "only tests use it"
    described = set()
    for node in ast.parse(sources("bindings/python/pellucid", "_native.pyi")).body:
        if isinstance(node, ast.FunctionDef):
            described.add(node.name)
        elif isinstance(node, ast.ClassDef):
            parts = {p.name if isinstance(p, ast.FunctionDef) else p.target.id for p in node.body
                     if isinstance(p, (ast.FunctionDef, ast.AnnAssign))}
            described |= {f"{node.name}.{part}" for part in parts if not part.startswith("_")}
    assert described == found


def test_every_call_that_does_work_can_be_submitted():
    for owner, name in [(pel.MeshTopology, "curvature"), (pel.MeshTopology, "normals"),
                        (pel.LiveMesh, "update"), (pel.Buffer, "read"), (pel.Buffer, "write"),
                        (pel.Lut, "read"), (pel, "screen_curvature"), (pel, "surface_integral"),
                        (pel.Scatter, "execute"), (pel.TextureScatter, "set_positions"),
                        (pel.TextureScatter, "draw"), (pel.TextureScatter, "execute")]:
        known = inspect.signature(getattr(owner, f"submit_{name}")).parameters
        assert "waits" in known, name
        for parameter in inspect.signature(getattr(owner, name)).parameters.values():
            same = known.get(parameter.name, parameter)
            assert same.default in (parameter.default, inspect.Parameter.empty), f"{name}: {parameter}"
    assert "waits" in inspect.signature(pel.Shader.submit).parameters
    for kind in ("curvature", "shadow", "specular", "eye"):
        assert {"wait", "waits"} <= set(inspect.signature(getattr(pel.Lut, kind)).parameters)
