"""Shades the head of the package with only NumPy beside it, and writes a picture: head.py PICTURE.png

What a renderer would draw is made here by marking the pixel of each vertex of the finely divided head. Ends
with 1 if scattering does not carry red light past the terminator.
"""

import sys

import numpy as np

import pellucid as pel
from pellucid import files

SIZE = 200
mesh = files.load_mesh(files.standard_head(), subdivide=3)
mm = 240 / float(np.subtract(mesh.high, mesh.low) @ np.abs(mesh.up))
device = pel.Device()
topology = pel.MeshTopology(device, mesh.triangles, positions=mesh.positions, weld="exact")
curvature = topology.curvature(mesh.positions, mesh.normals, smoothing_passes=2)

# Seen from the front: the foremost vertex of each pixel.
high, low = np.array(mesh.high), np.array(mesh.low)
scale = 0.95 * SIZE / max(high[:2] - low[:2])
column = ((mesh.positions[:, 0] - (high[0] + low[0]) / 2) * scale + SIZE / 2).astype(int)
row = (SIZE / 2 - (mesh.positions[:, 1] - (high[1] + low[1]) / 2) * scale).astype(int)
seen = (mesh.normals[:, 2] > 0) & (column >= 0) & (column < SIZE) & (row >= 0) & (row < SIZE)
order = np.flatnonzero(seen)[np.argsort(mesh.positions[seen, 2], kind="stable")]
pixel = row[order], column[order]
normals, curvatures = np.zeros((SIZE, SIZE, 3), np.float32), np.zeros((SIZE, SIZE), np.float32)
material = np.zeros((SIZE, SIZE), np.uint8)
normals[pixel], curvatures[pixel], material[pixel] = mesh.normals[order], curvature[order], 1

pictures = []
for skin in (
    pel.Material(albedo=(0.76, 0.54, 0.44), scattering="none"),
    pel.Material(albedo=(0.76, 0.54, 0.44), profile="skin"),
):
    radiance = np.zeros((SIZE, SIZE, 3), np.float32)
    shader = (
        pel.Shader(device)
        .set_options(millimetres_per_unit=mm)
        .set_image("radiance", radiance)
        .set_image("normal_shading", normals)
    )
    shader.set_image("curvature", curvatures).set_image("material", material).set_material(1, skin)
    shader.set_lights([pel.Light(to_light=(-0.96, 0.0, 0.28))]).commit().execute()
    pictures.append(radiance)
files.write_image(sys.argv[1], np.hstack(pictures), exposure=1.5)
again = files.read_image(sys.argv[1])
gain = (pictures[1] - pictures[0])[(material == 1) & (pictures[0].max(-1) < 0.02)].mean(0)
print(f"{device.info.name} ({device.info.platform}): {int(material.sum())} pixels")
print(f"light past the terminator: {gain.round(5)}")
sys.exit(not (gain[0] > 2 * gain[2] > 0 and again["R"].shape == (SIZE, 2 * SIZE)))
