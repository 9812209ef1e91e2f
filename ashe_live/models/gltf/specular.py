"""Specular-glossiness materials as metallic-roughness ones, texel by texel.

After the conversion in the extension's own archive (KHR_materials_pbrSpecularGlossiness, examples/convert-between-
workflows): the metal is what explains the brightness of both colours, given that a dielectric reflects 4 %.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.models.material import WHITE, LinearRGBA
from ashe_live.models.parsing.pictures import at_one_size

Values = NDArray[np.float32]
DIELECTRIC = 0.04
BRIGHTNESS: Values = np.array((0.299, 0.587, 0.114), np.float32)
ROWS_AT_ONCE = 128
LINEAR = LINEAR_FROM_SRGB_8BIT.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class MetalRough:
    """Factors, and the maps that they are factors of: (h, w, 4) uint8, as a Material has them."""

    base_colour: LinearRGBA
    metallic: float
    roughness: float
    base_map: Image | None = None
    roughness_map: Image | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SpecularGlossiness:
    """Factors, and the maps that they are factors of."""

    diffuse: LinearRGBA
    specular: tuple[float, ...]
    glossiness: float
    diffuse_map: Image | None  # (h, w, 4) uint8 sRGB with alpha
    shine_map: Image | None  # (h, w, 4) uint8 sRGB of the specular colour, with glossiness in place of alpha

    def with_mean_shine(self) -> "SpecularGlossiness":
        """With the mean of `shine_map` in its place, as one that is laid out like no diffuse map cannot be combined."""
        if self.shine_map is None:
            return self
        mean = self.shine_map.reshape(-1, 4).mean(axis=0)
        specular = tuple(np.asarray(self.specular) * LINEAR[mean[:3].astype(int)])
        return replace(self, specular=specular, glossiness=self.glossiness * float(mean[3]) / 255, shine_map=None)

    def as_metal_rough(self) -> MetalRough:
        """Converted: the maps texel by texel, at the larger one's size."""
        diffuse, specular = np.array(self.diffuse[:3], np.float32), np.array(self.specular, np.float32)
        if self.diffuse_map is None and self.shine_map is None:
            base, metal = _converted(diffuse[None], specular[None])
            red, green, blue = (float(value) for value in base[0])
            return MetalRough((red, green, blue, self.diffuse[3]), float(metal[0]), 1 - self.glossiness)
        white = np.full((1, 1, 4), 255, np.uint8)
        maps = (white if texels is None else texels for texels in (self.diffuse_map, self.shine_map))
        colours, shine = at_one_size(*maps)
        base_map, roughness_map = np.empty_like(colours), np.full_like(colours, 255)
        for first in range(0, len(colours), ROWS_AT_ONCE):
            rows = slice(first, first + ROWS_AT_ONCE)
            base, metal = _converted(LINEAR[colours[rows, :, :3]] * diffuse, LINEAR[shine[rows, :, :3]] * specular)
            base_map[rows, :, :3] = np.round(srgb_from_linear(base) * 255)
            base_map[rows, :, 3] = colours[rows, :, 3]
            roughness_map[rows, :, 1] = np.round(255 - self.glossiness * shine[rows, :, 3])
            roughness_map[rows, :, 2] = np.round(metal * 255)
        flat = roughness_map.reshape(-1, 4)
        factor: LinearRGBA = (*WHITE[:3], self.diffuse[3])
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
