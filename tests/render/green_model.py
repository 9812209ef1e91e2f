"""Pictures of a green model on light grey ground with a shadow of ratio 0.2: what is model and what is shadow."""

import numpy as np

# Everything lit is brighter than this by far, everything in the shadow darker: the ratio is 0.2 in linear light.
SHADOW_BELOW = 150


def split(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Masks (h, w) of the green model, and of shadowed ground."""
    blue, green, red = np.moveaxis(picture.astype(int), 2, 0)
    is_model = (green > red + 10) & (green > blue + 10)
    return is_model, ~is_model & (green < SHADOW_BELOW)
