"""Both native modules raise the documented kinds of errors: each has a C++ library of its own in a wheel."""

import base64
import struct

import pellucid
from pellucid import files

TRIANGLE = """{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,CORNERS"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]}"""
corners = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
with open("triangle.gltf", "w") as out:
    out.write(TRIANGLE.replace("CORNERS", corners))
assert len(pellucid.load_gltf("triangle.gltf").mesh.triangles) == 1
for kind, call in [
    (ValueError, lambda: pellucid.load_gltf("triangle.gltf", profiles={"Nobody": "skin"})),
    (ValueError, lambda: files.tonemap([[0, 0, 0]], curve="x")),
    (files.FileError, lambda: files.load_mesh("none.obj")),
    (pellucid.PellucidError, lambda: pellucid.Profile.burley(-1, 0.5)),
]:
    try:
        call()
    except kind:
        continue
    raise SystemExit(f"no {kind.__name__}")
