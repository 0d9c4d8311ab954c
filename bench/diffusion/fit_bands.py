#!/usr/bin/env python3
"""Weights of the bands by which scattering sums over the screen (kernels/lib/diffusion/bands.clh).

    python3 bench/diffusion/fit_bands.py

What is fitted is the whole sum on planes, seen from the front and at an angle (pixels two and three times as
long as wide), for Burley's profile and Gaussians of a third of a pixel to 8 pixels. Pictures are shadow
edges, disks, noise, and smooth light whose second difference is the same everywhere: of these the sum must
get the second moment of the profile right. Errors are differences from an exact convolution, over what
scattering changes. Weights are 0 or more, so that no light becomes negative. NumPy and SciPy are needed; it
takes two minutes.
"""

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import least_squares
from scipy.signal import fftconvolve

SIDE, LEVELS = 512, 7
RINGS = (1, 2, 4, 5)  # squared distances of blocks in a band
OFFSETS = {s: [(j, i) for j in range(-2, 3) for i in range(-2, 3) if i * i + j * j == s] for s in RINGS}
INSIDE = slice(112, -112, 6)
WEIGHT_ERROR = 5  # factor of the error of a plane's total weight: below 1 it would pass for occluded surface


def burley(b):
    return (
        lambda d: (np.exp(-d / b) + np.exp(-d / 3 / b)) / (8 * np.pi * b * np.maximum(d, 1e-9)),
        lambda r: 1 - 0.25 * np.exp(-r / b) - 0.75 * np.exp(-r / 3 / b),
    )


def gaussian(s):
    return (
        lambda d: np.exp(-d * d / 2 / s / s) / (2 * np.pi * s * s),
        lambda r: 1 - np.exp(-r * r / 2 / s / s),
    )


def coarser(a):
    return a.reshape(a.shape[0] // 2, 2, a.shape[1] // 2, 2).mean((1, 3))


def finer(c):
    """Linear between the middles of four blocks."""
    n, p = c.shape[0], np.pad(c, 1, mode="edge")
    out = np.zeros((2 * n, 2 * n))
    for oy in (0, 1):
        for ox in (0, 1):
            y, x = (slice(2, n + 2) if o else slice(0, n) for o in (oy, ox))
            out[oy::2, ox::2] = (9 * c + 3 * p[y, 1:-1] + 3 * p[1:-1, x] + p[y, x]) / 16
    return out


def sums(e, density, long):
    """What each ring brings with a weight of 1: of pixels, and of blocks of all levels together."""
    result = {}
    for level in range(LEVELS):
        n, p = e.shape[0], np.pad(e, 2, mode="edge")
        for squared in RINGS:
            brought = sum(
                density(2.0**level * np.hypot(i * long, j)) * p[2 + j : 2 + j + n, 2 + i : 2 + i + n]
                for j, i in OFFSETS[squared]
            )
            brought = brought * (4.0**level * long)
            for _ in range(level):
                brought = finer(brought)
            key = (min(level, 1), squared)
            result[key] = result.get(key, 0) + brought
        e = coarser(e)
    return [result[0, s] for s in RINGS] + [result[1, s] for s in RINGS]


def exact_kernel(density, long):
    x, y = np.meshgrid(*2 * [np.arange(1 - SIDE // 2, SIDE // 2)])
    kernel = density(np.hypot(x * long, y)) * long
    middle, part = SIDE // 2 - 1, (np.arange(32) + 0.5) / 32 - 0.5
    for j in range(-6, 7):
        for i in range(-6, 7):
            u, v = np.meshgrid(part + i, part + j)
            kernel[middle + j, middle + i] = density(np.hypot(u * long, v)).mean() * long
    return kernel / kernel.sum()


def pictures():
    rng = np.random.default_rng(1)
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    for a in (0.2, 0.64, 1.3):
        yield (np.cos(a) * x + np.sin(a) * y > 300 + 20 * np.sin(y / 17)).astype(float)
    for r in (3, 6, 12, 25, 50):
        yield ((x - 250) ** 2 + (y - 260) ** 2 < r * r).astype(float)
    noise = rng.random((SIDE, SIDE))
    for s in (0, 1, 2, 4):
        smooth = gaussian_filter(noise, s)
        yield (smooth - smooth.mean()) / smooth.std() * 0.2 + 0.5
    yield (x - 255.5) ** 2 / 1e4
    yield (y - 255.5) ** 2 / 1e4
    yield np.maximum(x + 0.3 * y - 320, 0) / 100


def share_of_blocks(share, long, blocks):
    """Of an ellipse, from its radii at every eighth of a turn (shareOfCentre)."""
    minor, major = blocks / np.pi, blocks / np.pi * long * long
    oblique = 2 * minor * major / (minor + major)
    return 0.25 * (share(np.sqrt(minor)) + share(np.sqrt(major))) + 0.5 * share(np.sqrt(oblique))


class Case:
    """One profile on one plane."""

    def __init__(self, profile, long):
        density, self.share = profile
        self.long = long
        kernel = exact_kernel(density, long)
        middle = (SIDE // 2, SIDE // 2)
        self.weights = np.array([b[middle] for b in sums(np.ones((SIDE, SIDE)), density, long)])
        self.pictures = []
        for e in pictures():
            scattered = fftconvolve(e, kernel, mode="same")[INSIDE, INSIDE].ravel()
            own = e[INSIDE, INSIDE].ravel()
            brought = np.stack([b[INSIDE, INSIDE].ravel() for b in sums(e, density, long)], 1)
            change = np.sqrt(np.mean((own - scattered) ** 2))
            self.pictures.append((own, scattered, brought, 1 / change / np.sqrt(len(own))))

    def errors(self, pixels, blocks, inside, own_area):
        minor, major = own_area / np.pi, own_area / np.pi * self.long**2
        own = self.share(np.sqrt(2 * minor * major / (minor + major)))
        centre = share_of_blocks(self.share, self.long, 4 * inside)
        weight = centre + blocks @ self.weights[4:]
        for e, scattered, brought, scale in self.pictures:
            near = brought[:, :4] @ pixels / (pixels @ self.weights[:4])
            found = (own * e + (centre - own) * near + brought[:, 4:] @ blocks) / weight
            yield (found - scattered) * scale / (2 if self.long > 2 else 1)
        yield [WEIGHT_ERROR / self.long * (weight - 1)]


def main():
    profiles = [burley(b) for b in (0.35, 0.5, 1, 2, 4)] + [gaussian(s) for s in (1, 2, 4, 8)]
    cases = [Case(p, long) for p in profiles for long in (1, 2)]
    cases += [Case(p, 3) for p in (burley(0.5), burley(1), gaussian(4))]

    def parts(v):  # only the pixels' ratios matter
        return np.concatenate([[1], v[:3]]), v[3:7], v[7], v[8]

    def errors(v):
        return np.concatenate([e for case in cases for e in case.errors(*parts(v))])

    begin = np.array([0.6, 0.5, 0.5, 0.01, 0.3, 1, 0.6, 8, 1])
    fit = least_squares(errors, begin, bounds=([0] * 7 + [2, 0.3], [4] * 7 + [12, 2]), max_nfev=80)
    pixels, blocks, inside, own_area = parts(fit.x)
    for what, weights in (("pixels", pixels), ("blocks", blocks)):
        print(what, " ".join(f"{np.sqrt(s):.2f}: {w:.2f}" for s, w in zip(RINGS, weights)))
    print(f"inside {inside:.2f}  own area {own_area:.2f}")


if __name__ == "__main__":
    main()
