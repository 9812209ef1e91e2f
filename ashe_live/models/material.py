"""What a surface is made of: glTF 2.0's metallic-roughness model, with its factors in linear light.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#materials, appendix B.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
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


MAP_SETS = 2  # of texture coordinates that a mesh may have


@dataclass(frozen=True, slots=True)
class MapLayout:
    """How a map lies on a mesh: by which of its texture coordinates, moved and turned how, and what lies beyond it."""

    uv_set: int = 0  # of the mesh
    # Row by row (2, 3), from (u, v, 1) of the mesh to the map's u and v, both from the bottom left.
    matrix: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    repeats: tuple[bool, bool] = (True, True)  # across and upwards; else its border goes on
    mirrors: tuple[bool, bool] = (False, False)  # every other repetition is turned round, which texels are doubled for
    is_sharp: bool = False  # texels are squares, not blended

    def for_set(self, uv_set: int) -> "MapLayout":
        return replace(self, uv_set=uv_set)

    @property
    def is_plain(self) -> bool:
        """Whether the map's coordinates are the mesh's first ones."""
        return self.uv_set == 0 and self.matrix == PLAIN_LAYOUT.matrix


PLAIN_LAYOUT = MapLayout()


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
    layouts: Mapping[str, MapLayout] = field(default_factory=dict)  # of maps, by their fields' names; else PLAIN_LAYOUT

    def __post_init__(self) -> None:
        for name in MAPS:
            texels = getattr(self, name)
            if texels is None:
                continue
            if texels.ndim != 3 or texels.shape[2] != 4 or texels.dtype != np.uint8 or texels.size == 0:
                raise ValueError(f"{name} is (h, w, 4) uint8, not {texels.shape} {texels.dtype}")
            set_frozen(self, **{name: frozen_view(np.ascontiguousarray(texels))})
        set_frozen(self, layouts={name: self.layouts[name] for name in MAPS if name in self.layouts})
        numbers = (*self.base_colour, self.metallic, self.roughness, self.normal_scale, *self.emissive)
        laid_out = (value for layout in self.layouts.values() for value in layout.matrix)
        if not np.isfinite([*numbers, *laid_out, self.occlusion_strength, self.alpha_cutoff]).all():
            raise ValueError("a material's factor is not finite")

    @property
    def maps(self) -> dict[str, Image]:
        """The maps that there are, by their fields' names."""
        return {name: texels for name in MAPS if (texels := getattr(self, name)) is not None}

    def layout(self, name: str) -> MapLayout:
        """Of the map in the field of that name."""
        return self.layouts.get(name, PLAIN_LAYOUT)

    @property
    def uv_sets(self) -> int:
        """How many sets of texture coordinates its maps need."""
        return max((self.layout(name).uv_set + 1 for name in self.maps), default=0)

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
# What formats without materials look like, and glTF meshes that name none: matt plastic. Many of their files have
# holes, so both sides are seen.
UNKNOWN = Material(roughness=0.7)
