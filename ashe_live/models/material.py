"""What a surface is made of: glTF 2.0's metallic-roughness model, with its factors in linear light.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#materials, appendix B.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

import numpy as np

from ashe_live.core.arrays import Float, Image, frozen_view, set_frozen
from ashe_live.core.colour import linear_from_srgb

LinearRGB = tuple[float, float, float]
LinearRGBA = tuple[float, float, float, float]
WHITE: LinearRGBA = (1.0, 1.0, 1.0, 1.0)
BLACK: LinearRGB = (0.0, 0.0, 0.0)
# A dielectric's highlight at this roughness is broader and fainter than its own shading.
MATT_ROUGHNESS = 0.9
# Rougher than this a dielectric blurs what it mirrors to a tone.
MIRROR_ROUGHNESS = 0.5


class Alpha(Enum):
    """The meaning of the base colour's alpha."""

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
    coat: float = 0.0  # share of the surface under a layer of glass, by its factor alone
    coat_roughness: float = 0.0  # of that layer
    normal_map: Image | None = None  # linear; tangent space, x right, y up, z outwards, from [-1, 1]
    normal_scale: float = 1.0  # of the map's x and y
    occlusion_map: Image | None = None  # linear; red: the share of ambient light that arrives
    occlusion_strength: float = 1.0  # 0: the occlusion map is ignored
    emissive: LinearRGB = BLACK  # radiance in units of lit level white's
    emissive_map: Image | None = None  # sRGB
    is_unlit: bool = False  # what it emits is its colour, of which the vertices' colours are a factor as well
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
        numbers = [*self.base_colour, self.metallic, self.roughness, self.normal_scale, *self.emissive]
        numbers += [self.coat, self.coat_roughness]
        laid_out = (value for layout in self.layouts.values() for value in layout.matrix)
        if not np.isfinite([*numbers, *laid_out, self.occlusion_strength, self.alpha_cutoff]).all():
            raise ValueError("a material's factor is not finite")

    @property
    def maps(self) -> dict[str, Image]:
        """The maps that it has, by their fields' names."""
        return {name: texels for name in MAPS if (texels := getattr(self, name)) is not None}

    def layout(self, name: str) -> MapLayout:
        """Layout of the map in the field of that name."""
        return self.layouts.get(name, PLAIN_LAYOUT)

    @property
    def uv_sets(self) -> int:
        """How many sets of texture coordinates its maps need."""
        return max((self.layout(name).uv_set + 1 for name in self.maps), default=0)

    @property
    def is_matt(self) -> bool:
        """Its own shading is all there is to see of it."""
        is_rough = self.roughness >= MATT_ROUGHNESS and self.metallic_roughness_map is None
        return is_rough and self.metallic == 0 and self.coat == 0

    @property
    def is_mirror(self) -> bool:
        """Whether its surroundings are seen in it."""
        smoothest = min(self.roughness, self.coat_roughness) if self.coat > 0 else self.roughness
        return self.metallic > 0 or smoothest < MIRROR_ROUGHNESS or self.metallic_roughness_map is not None

    def without_maps(self) -> "Material":
        """For a mesh without texture coordinates: in the one colour that `in_one_place` says."""
        maps = self.maps
        if not maps:
            return self
        factors = {name: getattr(self, name) for name in ("base_colour", "metallic", "roughness", "emissive")}
        folded = in_one_place(factors, {name: (texels, self.layout(name)) for name, texels in maps.items()})
        nothing: dict[str, Any] = dict.fromkeys(maps)
        return replace(self, **nothing, **folded)


MAPS = ("base_map", "metallic_roughness_map", "normal_map", "occlusion_map", "emissive_map")
SRGB_MAPS = ("base_map", "emissive_map")
NO_COORDINATES = (0.0, 1.0)  # from the bottom left: glTF's (0, 0), as a vertex has them whose mesh brings none


def in_one_place(factors: dict[str, Any], maps: Mapping[str, tuple[Image, MapLayout]]) -> dict[str, Any]:
    """A material's factors times what maps hold where a mesh without texture coordinates would look them up.

    OpenGL's default for an attribute that is not there is 0, so that renderers draw such a mesh in the colour of the
    picture's corner. Normals and occlusion are left out.
    """
    found = dict(factors)
    for name, (texels, layout) in maps.items():
        texel = _texel(texels, layout, name in SRGB_MAPS)
        match name:
            case "base_map":
                found["base_colour"] = tuple(map(float, np.multiply(found["base_colour"], texel)))
            case "metallic_roughness_map":
                found["roughness"] = found["roughness"] * float(texel[1])
                found["metallic"] = found["metallic"] * float(texel[2])
            case "emissive_map":
                found["emissive"] = tuple(map(float, np.multiply(found["emissive"], texel[:3])))
    return found


def _texel(texels: Image, layout: MapLayout, is_srgb: bool) -> Float:
    """(4,) linear, at NO_COORDINATES; between texels their mean by bilinear weights."""
    at = np.reshape(layout.matrix, (2, 3)) @ (*NO_COORDINATES, 1.0)
    counts = texels.shape[1::-1]
    indices, weights = [], []
    for share, count, repeats in zip((at[0], 1 - at[1]), counts, layout.repeats, strict=True):
        place = share * count - 0.5
        near = np.floor(place) + np.arange(2)
        indices.append((near % count if repeats else np.clip(near, 0, count - 1)).astype(int))
        after = place - near[0]
        weights.append(np.round((1 - after, after)) if layout.is_sharp else np.array((1 - after, after)))
    (columns, rows), (across, down) = indices, weights
    four = texels[rows][:, columns] / 255
    if is_srgb:
        four[..., :3] = linear_from_srgb(four[..., :3])
    return np.asarray(np.einsum("i,j,ijk->k", down, across, four))


# Material of formats without materials, and of glTF meshes that name none: matt plastic, seen from both sides, as many
# of their files have holes.
UNKNOWN = Material(roughness=0.7)
