"""A ball in a G-buffer whose answer is known, and a shader over it."""
import numpy as np

import pellucid as pel

HEIGHT, WIDTH = 37, 61


class View:
    """A sphere of radius 10 seen from +z, orthographic, material 1 on a background of 0."""

    def __init__(self):
        y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
        px, py = (x - WIDTH / 2 + 0.5) / 1.6, (HEIGHT / 2 - 0.5 - y) / 1.6
        self.inside = inside = px**2 + py**2 < 100
        pz = np.sqrt(np.where(inside, 100 - px**2 - py**2, 0))
        self.position = (np.stack([px, py, pz], -1) * inside[..., None]).astype(np.float32)
        self.normal = self.position / 10
        self.material = inside.astype(np.uint8)
        albedo = np.random.default_rng(1).uniform(0.2, 0.9, (HEIGHT, WIDTH, 3))
        self.albedo = albedo.astype(np.float32) * inside[..., None]
        self.to_light = np.float32([0.6, 0.0, 0.8])
        self.lambert = self.albedo * np.maximum(self.normal @ self.to_light, 0)[..., None]


def black():
    return np.zeros((HEIGHT, WIDTH, 3), np.float32)


def shader_for(device, view, radiance, **images):
    given = dict(normal_shading=view.normal, material=view.material, albedo=view.albedo) | images
    shader = pel.Shader(device).set_image("radiance", radiance)
    for slot, image in given.items():
        shader.set_image(slot, image)
    shader.set_material(1, pel.Material()).set_lights([pel.Light(to_light=view.to_light)])
    return shader.commit()


def shaded(device, view, change=None, **images):
    """The picture of such a shader after `change(shader)`."""
    radiance = black()
    shader = shader_for(device, view, radiance, **images)
    if change:
        change(shader)
        shader.commit()
    shader.execute()
    return radiance
