"""What a surface is made of: glTF 2.0's metallic-roughness model, with its factors in linear light.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#materials, appendix B.
"""

from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

import numpy as np

from ashe_live.core.arrays import Image, frozen_view, set_frozen

LinearRGB = tuple[float, float, float]
LinearRGBA = tuple[float, float, float, float]
WHITE: LinearRGBA = (1.0, 1.0, 1.0, 1.0)
BLACK: LinearRGB = (0.0, 0.0, 0.0)
# A dielectric's highlight at this roughness is broader and fainter than its own shading.
MATT_ROUGHNESS = 0.9
# Rougher than this a dielectric blurs what it mirrors to a tone.
MIRROR_ROUGHNESS = 0.5


class Alpha(Enum):
    """What the base colour's alpha does."""

    OPAQUE = "opaque"  # nothing
    CUT_OUT = "mask"  # below the cut-off there is no surface
    BLEND = "blend"  # the surface lets through what is behind it


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """Every map is (h, w, 4) uint8, top row first, a factor of the number beside it, and needs texture coordinates."""

    base_colour: LinearRGBA = WHITE
    base_map: Image | None = None  # sRGB with alpha
    metallic: float = 0.0  # 0: plastic, wood, paper; 1: bare metal
    roughness: float = 1.0  # perceptual; 0: polished, 1: matt
    metallic_roughness_map: Image | None = None  # linear; green: roughness, blue: metallic
    normal_map: Image | None = None  # linear; tangent space, x right, y up, z outwards, from [-1, 1]
    normal_scale: float = 1.0  # of the map's x and y
    occlusion_map: Image | None = None  # linear; red: the share of ambient light that arrives
    occlusion_strength: float = 1.0  # 0: the occlusion map is ignored
    emissive: LinearRGB = BLACK  # radiance in units of lit level white's
    emissive_map: Image | None = None  # sRGB
    alpha: Alpha = Alpha.OPAQUE
    alpha_cutoff: float = 0.5  # of CUT_OUT
    double_sided: bool = True  # False: the side that normals point away from is never seen

    def __post_init__(self) -> None:
        for name in MAPS:
            texels = getattr(self, name)
            if texels is None:
                continue
            if texels.ndim != 3 or texels.shape[2] != 4 or texels.dtype != np.uint8 or texels.size == 0:
                raise ValueError(f"{name} is (h, w, 4) uint8, not {texels.shape} {texels.dtype}")
            set_frozen(self, **{name: frozen_view(np.ascontiguousarray(texels))})
        numbers = (*self.base_colour, self.metallic, self.roughness, self.normal_scale, *self.emissive)
        if not np.isfinite([*numbers, self.occlusion_strength, self.alpha_cutoff]).all():
            raise ValueError("a material's factor is not finite")

    @property
    def maps(self) -> dict[str, Image]:
        """The maps that there are, by their fields' names."""
        return {name: texels for name in MAPS if (texels := getattr(self, name)) is not None}

    @property
    def is_matt(self) -> bool:
        """Its own shading is all there is to see of it."""
        return self.metallic == 0 and self.roughness >= MATT_ROUGHNESS and self.metallic_roughness_map is None

    @property
    def is_mirror(self) -> bool:
        """What surrounds it is seen in it."""
        return self.metallic > 0 or self.roughness < MIRROR_ROUGHNESS or self.metallic_roughness_map is not None

    def without_maps(self) -> "Material":
        """For a mesh without texture coordinates."""
        nothing: dict[str, Any] = dict.fromkeys(self.maps)
        return replace(self, **nothing) if nothing else self


MAPS = ("base_map", "metallic_roughness_map", "normal_map", "occlusion_map", "emissive_map")
SRGB_MAPS = ("base_map", "emissive_map")
