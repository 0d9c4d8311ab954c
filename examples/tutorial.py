"""From a mesh to a picture with Pellucid: tutorial.py MESH PICTURE.png

The library shades what a renderer hands it; trimesh and Embree stand in for the renderer here.
Install: pip install . trimesh scipy embreex pillow
"""
import sys

import numpy as np
import trimesh
from PIL import Image

import pellucid as pel

# 1. A mesh, scaled to a head 240 mm high, y up; all lengths are in mm from here on.
mesh = trimesh.load(sys.argv[1], force="mesh")
mesh.apply_translation(-mesh.bounds.mean(0))
mesh.apply_scale(240 / mesh.extents[1])
normals = np.float32(mesh.vertex_normals)

# 2. Curvature of each vertex, on the device.
device = pel.Device()
topology = pel.MeshTopology(device, mesh.faces, positions=np.float32(mesh.vertices), weld="exact")
curvature = topology.curvature(np.float32(mesh.vertices), normals)

# 3. A G-buffer: one parallel ray per pixel, looking down -z; vertex data interpolated where it hits.
y, x = np.mgrid[135:-135:360j, -135:135:360j]
start = np.stack([x, y, np.full_like(x, 500)], -1).reshape(-1, 3)
points, ray, face = mesh.ray.intersects_location(start, np.tile([0.0, 0, -1], (len(start), 1)), multiple_hits=False)
weights = np.float32(trimesh.triangles.points_to_barycentric(mesh.triangles[face], points))
normal, curve, skin = np.zeros((*x.shape, 3), "f4"), np.zeros(x.shape, "f4"), np.zeros(x.shape, "u1")
hit = np.unravel_index(ray, x.shape)
n = np.einsum("ij,ijk->ik", weights, normals[mesh.faces[face]])
normal[hit] = n / np.linalg.norm(n, axis=1, keepdims=True)
curve[hit], skin[hit] = (weights * curvature[mesh.faces[face]]).sum(1), 1

# 4. Shade it with light from the side: plain on the left, scattering on the right.
picture = np.zeros((*x.shape[:1], 2 * x.shape[1], 3), np.float32)
for half, lut in enumerate([None, pel.Lut.curvature(device)]):
    shader = pel.Shader(device).set_image("radiance", picture[:, 360 * half:][:, :360])
    shader.set_image("normal_shading", normal).set_image("curvature", curve).set_image("material", skin)
    shader.set_material(1, pel.Material(albedo=(0.8, 0.6, 0.5)), lut)
    shader.set_lights([pel.Light(to_light=(0.96, 0.2, 0.2))]).commit().execute()
Image.fromarray(np.uint8(255 * np.clip(picture, 0, 1) ** (1 / 2.2))).save(sys.argv[2])
