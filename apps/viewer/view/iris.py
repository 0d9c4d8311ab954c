"""Pictures of irises from files."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import files
from .._show import linear

LINEAR = (".exr", ".hdr")  # files of light; others are of sRGB


def iris_image(path: Any) -> NDArray[np.float32]:
    """The middle square of an image as linear albedo, (n, n, 3): its inscribed circle is the iris' rim.

    Raises
    ------
    FileError
        A file that is missing or damaged.
    ValueError
        An image without colours.
    """
    channels = files.read_image(path)
    missing = [c for c in "RGB" if c not in channels]
    if missing:
        raise ValueError(f"{path} has the channels {', '.join(channels)}; R, G and B are needed for an iris")
    image = np.stack([channels[c] for c in "RGB"], 2)
    n = min(image.shape[:2])
    top, left = (image.shape[0] - n) // 2, (image.shape[1] - n) // 2
    image = np.ascontiguousarray(image[top:top + n, left:left + n], np.float32)
    if Path(str(path)).suffix.lower() not in LINEAR:
        image = linear(image)
    return image
