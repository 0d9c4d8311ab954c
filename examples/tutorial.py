"""From a mesh to a picture with Pellucid: tutorial.py PICTURE.png [MESH] [--up auto|y|z]

The library shades what a renderer hands it; the package's small OpenGL renderer stands in for yours here.
Install: pip install 'pellucid[view]'
"""
import argparse

import numpy as np

import pellucid as pel
from pellucid import files
from pellucid.view.camera import Orbit, direction
from pellucid.view.renderer import Renderer
from pellucid.view.session import eyes_of

arguments = argparse.ArgumentParser()
arguments.add_argument("picture")
arguments.add_argument("mesh", nargs="?", default=files.standard_head())
arguments.add_argument("--up", default="auto", choices=("auto", "y", "z"))
a = arguments.parse_args()

# 1. A mesh; all lengths are in its unit, and 240 mm is the height of a head.
mesh = files.load_mesh(a.mesh, up=a.up)
size = np.subtract(mesh.high, mesh.low)
mm = 240 / float(size @ np.abs(mesh.up))

# 2. Curvature of each vertex, on the device.
device = pel.Device()
topology = pel.MeshTopology(device, mesh.triangles, positions=mesh.positions, weld="exact")
curvature = topology.curvature(mesh.positions, mesh.normals, smoothing_passes=2)

# 3. A G-buffer, and depth seen from the light: what your renderer has already.
renderer, orbit = Renderer(), Orbit(azimuth=25)
renderer.set_mesh(mesh, curvature, mm)
orbit.frame(mesh.low, mesh.high, aspect=1)
middle = np.add(mesh.low, mesh.high) / 2
eye, matrix = orbit.matrices(mesh.up, mesh.front, middle, 2 * renderer.radius, aspect=1)
g = renderer.gbuffer(matrix, 480, 480)
depth, light = renderer.shadow_map(direction(mesh.up, mesh.front, azimuth=100, elevation=20), 1024, mesh.up)
light.shadow_filter_texels = 48  # shadows are made from the map

# 4. Shade it: plain on the left, scattering on the right.
picture = np.zeros((480, 960, 3), np.float32)
other = pel.Material(scattering="none", specular=0.0, shadow_filter_width=1 / mm)
plain = pel.Material(specular=0.3, shadow_filter_width=1 / mm)
for half, skin in enumerate([plain, pel.Material(profile="skin", specular=0.3)]):
    shader = pel.Shader(device).set_options(millimetres_per_unit=mm)
    shader.set_image("radiance", picture[:, 480 * half:][:, :480])
    for slot in ("position", "normal_geometric", "normal_shading", "curvature", "albedo", "material"):
        shader.set_image(slot, getattr(g, slot))
    for id in np.unique(g.material[g.material > 0]):  # 1 is skin; the eyes and teeth of the head have others
        shader.set_material(int(id), skin if id == 1 else other)
    for id, model in eyes_of(mesh, mm=mm).items():
        shader.set_eye(id, model)
    shader.set_lights([light]).set_light_image(0, "shadow_map", depth)
    shader.set_ambient(pel.Ambient(constant=[0.05] * 3)).set_camera(pel.Camera(position=eye))
    shader.commit().execute()
files.write_image(a.picture, picture)
