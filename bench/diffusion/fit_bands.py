#!/usr/bin/env python3
"""Weights of the bands by which scattering sums over the screen (kernels/lib/diffusion/levels.clh).

    python3 bench/diffusion/fit_bands.py

Bands of linear ramps are where the fit begins; a term keeps it near them. What is fitted is the whole sum on a plane, for Burley's profile and Gaussians of 0.5 to 12 pixels, on shadow edges,
disks and noise: the difference from an exact convolution, over what scattering changes. NumPy and SciPy are needed.
"""

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.signal import fftconvolve

SIDE, LEVELS, NEAR_RAMPS = 512, 7, 0.1
RINGS = (1, 2, 4, 5)  # squared distances of blocks in a band
INSIDE = slice(112, -112, 3)


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


def ring(e, squared):
    n, p = e.shape[0], np.pad(e, 2, mode="edge")
    pairs = [(j, i) for j in range(-2, 3) for i in range(-2, 3) if i * i + j * j == squared]
    return sum(p[2 + j : 2 + j + n, 2 + i : 2 + i + n] for j, i in pairs)


def sums(e, density):
    """What each ring brings with a weight of 1: of pixels, and of blocks of all levels together."""
    result = {}
    for level in range(LEVELS):
        for squared in RINGS:
            brought = ring(e, squared) * density(2.0**level * np.sqrt(squared)) * 4.0**level
            for _ in range(level):
                brought = finer(brought)
            key = (min(level, 1), squared)
            result[key] = result.get(key, 0) + brought
        e = coarser(e)
    return [result[0, s] for s in RINGS] + [result[1, s] for s in RINGS]


def exact_kernel(density, share):
    x, y = np.meshgrid(*2 * [np.arange(1 - SIDE // 2, SIDE // 2)])
    kernel = density(np.hypot(x, y))
    middle, part = SIDE // 2 - 1, (np.arange(16) + 0.5) / 16 - 0.5
    for j in range(-6, 7):
        for i in range(-6, 7):
            kernel[middle + j, middle + i] = density(np.hypot(*np.meshgrid(part + i, part + j))).mean()
    kernel[middle, middle] = share(np.sqrt(1 / np.pi))
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


def main():
    def ramp(r):
        return np.clip((3 - r) / 1.5, 0, 1)

    roots = np.sqrt(RINGS)
    begin = np.concatenate([ramp(roots), ramp(roots) - ramp(2 * roots)])
    rows, values = [], []
    for density, share in [burley(b) for b in (0.5, 1, 2, 4, 8)] + [gaussian(s) for s in (1, 2, 4, 8, 12)]:
        kernel, own = exact_kernel(density, share), share(np.sqrt(1 / np.pi))
        for e in [*pictures(), np.ones((SIDE, SIDE))]:
            scattered = e if e.min() == 1 else fftconvolve(e, kernel, mode="same")
            change = np.sqrt(np.mean((e - scattered)[INSIDE, INSIDE] ** 2)) or 0.02
            brought = np.stack([b[INSIDE, INSIDE].ravel() for b in sums(e, density)], 1)
            scale = 1 / change / np.sqrt(len(brought))
            rows.append(brought * scale)
            values.append((scattered - own * e)[INSIDE, INSIDE].ravel() * scale)
    count = len(rows)
    a, b = np.concatenate(rows), np.concatenate(values)
    normal = a.T @ a / count + NEAR_RAMPS * np.eye(len(begin))
    fitted = np.linalg.solve(normal, a.T @ b / count + NEAR_RAMPS * begin)
    for what, weights in (("pixels", fitted[: len(RINGS)]), ("blocks", fitted[len(RINGS) :])):
        print(what, " ".join(f"{np.sqrt(s):.2f}: {w:.2f}" for s, w in zip(RINGS, weights)))


if __name__ == "__main__":
    main()
