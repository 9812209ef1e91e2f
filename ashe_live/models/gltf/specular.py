"""Specular-glossiness materials as metallic-roughness ones, texel by texel.

After the conversion in the extension's own archive (KHR_materials_pbrSpecularGlossiness, examples/convert-between-
workflows): the metal is what explains the brightness of both colours, given that a dielectric reflects 4 %.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.models.material import WHITE, LinearRGBA
from ashe_live.models.parsing.pictures import resized

Values = NDArray[np.float32]
DIELECTRIC = 0.04
BRIGHTNESS: Values = np.array((0.299, 0.587, 0.114), np.float32)
ROWS_AT_ONCE = 128
LINEAR = LINEAR_FROM_SRGB_8BIT.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class MetalRough:
    """Factors, and the maps that they are factors of."""

    base_colour: LinearRGBA
    metallic: float
    roughness: float
    base_map: Image | None = None
    roughness_map: Image | None = None


def metal_rough_from_specular(
    diffuse: LinearRGBA,
    specular: tuple[float, ...],
    glossiness: float,
    diffuse_map: Image | None,
    shine_map: Image | None,
    is_averaged: bool = False,
) -> MetalRough:
    """Maps are (h, w, 4) uint8: sRGB with alpha; sRGB with glossiness in place of alpha.

    `is_averaged`: they are laid out differently, so the mean of the second stands for all of it.
    """
    if shine_map is not None and is_averaged:
        mean = shine_map.reshape(-1, 4).mean(axis=0)
        specular = tuple(np.asarray(specular) * LINEAR[mean[:3].astype(int)])
        glossiness, shine_map = glossiness * float(mean[3]) / 255, None
    diffuse_factor, specular_factor = np.array(diffuse[:3], np.float32), np.array(specular, np.float32)
    if diffuse_map is None and shine_map is None:
        base, metal = _converted(diffuse_factor[None], specular_factor[None])
        red, green, blue = (float(value) for value in base[0])
        return MetalRough((red, green, blue, diffuse[3]), float(metal[0]), 1 - glossiness)
    size = max((texels.shape[1], texels.shape[0]) for texels in (diffuse_map, shine_map) if texels is not None)
    white = np.full((size[1], size[0], 4), 255, np.uint8)
    colours, shine = (white if texels is None else resized(texels, size) for texels in (diffuse_map, shine_map))
    base_map, roughness_map = np.empty_like(white), white.copy()
    for first in range(0, size[1], ROWS_AT_ONCE):
        rows = slice(first, first + ROWS_AT_ONCE)
        base, metal = _converted(
            LINEAR[colours[rows, :, :3]] * diffuse_factor, LINEAR[shine[rows, :, :3]] * specular_factor
        )
        base_map[rows, :, :3] = np.round(srgb_from_linear(base) * 255)
        base_map[rows, :, 3] = colours[rows, :, 3]
        roughness_map[rows, :, 1] = np.round(255 - glossiness * shine[rows, :, 3])
        roughness_map[rows, :, 2] = np.round(metal * 255)
    flat = roughness_map.reshape(-1, 4)
    factor: LinearRGBA = (*WHITE[:3], diffuse[3])
    if (flat == flat[0]).all():
        return MetalRough(factor, float(flat[0, 2]) / 255, float(flat[0, 1]) / 255, base_map)
    return MetalRough(factor, 1.0, 1.0, base_map, roughness_map)


def _converted(diffuse: Values, specular: Values) -> tuple[Values, Values]:
    """Base colour (..., 3) and metal (...) from linear colours (..., 3)."""
    left = 1 - specular.max(axis=-1)
    d, s = (np.sqrt(colour * colour @ BRIGHTNESS) for colour in (diffuse, specular))
    # The metal m solves base(m) = base from the diffuse colour = base from the specular one, a quadratic.
    b = d * left / (1 - DIELECTRIC) + s - 2 * DIELECTRIC
    root = np.sqrt(np.maximum(b * b - 4 * DIELECTRIC * (DIELECTRIC - s), 0))
    metal = np.where(s < DIELECTRIC, 0, np.clip((root - b) / (2 * DIELECTRIC), 0, 1)).astype(np.float32)
    share = metal[..., None]
    from_diffuse = diffuse * (left / (1 - DIELECTRIC))[..., None] / np.maximum(1 - share, 1e-4)
    from_specular = (specular - DIELECTRIC * (1 - share)) / np.maximum(share, 1e-4)
    base = np.clip(from_diffuse + (from_specular - from_diffuse) * share * share, 0, 1)
    return base.astype(np.float32), metal
