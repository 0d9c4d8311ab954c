"""A deferred renderer in OpenGL that hands its G-buffer to Pellucid: opengl_host.py PICTURE.png

It draws a ring of jade before a wall with shaders of its own, reads back what they wrote, and gives Pellucid
the very matrices that it gave to OpenGL. Rows that OpenGL counts from below are turned by the projection for
the G-buffer; the shadow map stays as it is, and `first_row` says so. Works with any OpenGL 3.3 through EGL: a
GPU's driver, or Mesa without one.
Install: pip install pellucid moderngl
"""

import sys

import moderngl
import numpy as np

import pellucid as pel
from pellucid.conventions import light_from_view_projection
from pellucid.files import write_image

if len(sys.argv) != 2:
    sys.exit("usage: opengl_host.py PICTURE.png")
WIDTH, HEIGHT, MAP = 960, 540, 1024
EYE, TO_LIGHT = np.array([0.0, -260.0, 60.0]), np.array([0.6, -0.62, 0.505])


def torus(major=55.0, minor=12.0, rings=160, segments=64):
    """Positions, normals (n, 3) and triangles about the y axis, mm; its curvature is about 1 / minor."""
    v, u = np.meshgrid(2 * np.pi * np.arange(segments) / segments, 2 * np.pi * np.arange(rings) / rings)
    out = np.stack([np.cos(u), np.zeros_like(u), np.sin(u)], -1)
    normal = np.cos(v)[..., None] * out + np.sin(v)[..., None] * [0, 1, 0]
    i, j = np.meshgrid(np.arange(rings), np.arange(segments), indexing="ij")
    at = lambda a, b: (a % rings) * segments + b % segments  # noqa: E731
    faces = np.stack([at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)], -1)
    return (major * out + minor * normal).reshape(-1, 3), normal.reshape(-1, 3), faces.reshape(-1, 3)


def look_at(eye, target, up=(0.0, 0.0, 1.0)):
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    m = np.eye(4)
    m[:3, :3] = right, np.cross(back, right), back
    m[:3, 3] = -m[:3, :3] @ eye
    return m


def perspective(fov, aspect, near, far):
    t = 1 / np.tan(np.radians(fov) / 2)
    return np.array(
        [
            [t / aspect, 0, 0, 0],
            [0, t, 0, 0],
            [0, 0, (near + far) / (near - far), 2 * near * far / (near - far)],
            [0, 0, -1, 0],
        ]
    )


def parallel(half, near, far):
    return np.array(
        [
            [1 / half, 0, 0, 0],
            [0, 1 / half, 0, 0],
            [0, 0, 2 / (near - far), (near + far) / (near - far)],
            [0, 0, 0, 1],
        ]
    )


VERTEX = """#version 330 core
uniform mat4 clip; in vec3 place, outward; in float id; out vec3 p, n; flat out float m;
void main() { p = place; n = outward; m = id; gl_Position = clip * vec4(place, 1.0); }"""
GBUFFER = """#version 330 core
in vec3 p, n; flat in float m; layout(location = 0) out vec4 position; layout(location = 1) out vec4 normal;
void main() { position = vec4(p, m); normal = vec4(normalize(n), 0.0); }"""
DEPTH = """#version 330 core
in vec3 p, n; flat in float m; layout(location = 0) out float depth;
void main() { depth = gl_FragCoord.z; }"""

# Geometry, as this renderer keeps it: the ring is material 1, the wall behind it material 2.
ring, ring_normals, ring_faces = torus()
wall = np.array([[-150, 60, -100], [150, 60, -100], [-150, 60, 100], [150, 60, 100]], float)
vertices = np.concatenate(
    [
        np.c_[ring, ring_normals, np.full(len(ring), 1)],
        np.c_[wall, np.tile([0, -1, 0], (4, 1)), np.full(4, 2)],
    ]
).astype("f4")
faces = np.concatenate([ring_faces, len(ring) + np.array([[0, 1, 2], [2, 1, 3]])]).astype("u4")

gl = moderngl.create_standalone_context(backend="egl", require=330)
gl.enable_only(moderngl.DEPTH_TEST)
buffer, indices = gl.buffer(vertices.tobytes()), gl.buffer(faces.tobytes())


def draw(fragment, clip, size, textures):
    """Each texture, as an array whose row 0 is the one that OpenGL calls the lowest."""
    program = gl.program(VERTEX, fragment)
    # A compiler drops what its shader does not read.
    layout = (("place", 3), ("outward", 3), ("id", 1))
    text = " ".join(f"{n}f" if name in program else f"{4 * n}x" for name, n in layout)
    frame = gl.framebuffer(textures, gl.depth_renderbuffer(size))
    frame.use()
    frame.clear(*([1.0] * 4 if fragment is DEPTH else [0.0] * 4))
    program["clip"].write(clip.T.astype("f4").tobytes())
    gl.vertex_array(
        program, [(buffer, text, *[name for name, _ in layout if name in program])], indices
    ).render()
    return [
        np.frombuffer(frame.read(components=t.components, attachment=i, dtype="f4"), "f4")
        .reshape(size[1], size[0], -1)
        .copy()
        for i, t in enumerate(textures)
    ]


camera = perspective(30, WIDTH / HEIGHT, 50, 1000) @ look_at(EYE, np.zeros(3))
turned = np.diag([1.0, -1.0, 1.0, 1.0]) @ camera  # so that the first row is the top one
first, second = draw(
    GBUFFER, turned, (WIDTH, HEIGHT), [gl.texture((WIDTH, HEIGHT), 4, dtype="f4") for _ in range(2)]
)
sun = parallel(200, 0, 800) @ look_at(400 * TO_LIGHT, np.zeros(3))
(depth,) = draw(DEPTH, sun, (MAP, MAP), [gl.texture((MAP, MAP), 1, dtype="f4")])

device = pel.Device()
picture = np.zeros((HEIGHT, WIDTH, 3), np.float32)
normal = np.ascontiguousarray(second[..., :3])
shader = (
    pel.Shader(device)
    .set_image("radiance", picture)
    .set_image("position", np.ascontiguousarray(first[..., :3]))
)
shader.set_image("material", np.ascontiguousarray(first[..., 3])).set_image(
    "normal_geometric", normal
).set_image("normal_shading", normal)
shader.set_material(1, pel.Material(profile="jade", albedo=(0.35, 0.75, 0.45), specular=0.6, roughness=0.12))
shader.set_material(
    2, pel.Material(scattering="none", albedo=(0.3, 0.3, 0.32), specular=0.0, shadow_filter_width=2.0)
)
shader.set_lights(
    [light_from_view_projection(sun, first_row="bottom", color=(1.4, 1.35, 1.25), shadow_filter_texels=48)]
).set_light_image(0, "shadow_map", depth[..., 0].copy())
shader.set_ambient(pel.Ambient(constant=[0.06] * 3)).set_camera(pel.Camera(position=EYE)).commit().execute()
write_image(sys.argv[1], picture)
