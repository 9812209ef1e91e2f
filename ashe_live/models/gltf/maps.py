"""The maps of one glTF material, as far as a mesh's texture coordinates let them be drawn."""

import math
from typing import Any

from ashe_live.core.arrays import Image
from ashe_live.models.gltf.schema import CLAMP_TO_EDGE, MIRRORED_REPEAT, REPEAT
from ashe_live.models.material import MAP_SETS, MapLayout
from ashe_live.models.parsing.json_kinds import Json

NEAREST = 9728


class Maps:
    """A material's maps as they are gathered, by the sets of texture coordinates that the mesh has."""

    def __init__(self, uv_sets: frozenset[int]) -> None:
        self.texels: dict[str, Any] = {}  # as a Material takes them
        self.layouts: dict[str, MapLayout] = {}
        self.unplaced: dict[str, tuple[Image, MapLayout]] = {}  # for which the mesh has no coordinates
        self.sets: list[int] = []
        self.has_third_set = self.lacks_coordinates = False
        self._there = uv_sets

    def takes(self, layout: MapLayout) -> bool:
        """Whether the map can be drawn: laid out, or in one colour where the mesh has no such coordinates.

        Notes what is in the way, so it is asked before a map's picture is read.
        """
        is_there = layout.uv_set in self._there
        has_room = layout.uv_set in self.sets or len(self.sets) < MAP_SETS
        self.has_third_set |= is_there and not has_room
        self.lacks_coordinates |= not is_there
        return has_room or not is_there

    def takes_base_map(self, layout: MapLayout) -> bool:
        """Whether a base map can be drawn, which is laid out as the one is that is there already, if any."""
        if (base := self.layouts.get("base_map")) is not None:
            return layout.uv_set in self.sets and base == layout.for_set(self.sets.index(layout.uv_set))
        return layout.uv_set in self._there and "base_map" not in self.unplaced and self.takes(layout)

    def add(self, name: str, layout: MapLayout, texels: Image) -> None:
        if not self.takes(layout):
            return
        if layout.uv_set not in self._there:
            self.unplaced[name] = texels, layout
            return
        if layout.uv_set not in self.sets:
            self.sets.append(layout.uv_set)
        self.texels[name] = texels
        self.layouts[name] = layout.for_set(self.sets.index(layout.uv_set))


def layout_of(texture: Json, sampler: Json) -> MapLayout:
    """How glTF's reference to a texture lays it out, with the set of texture coordinates by the file's number."""
    moved = texture.get("extensions", {}).get("KHR_texture_transform", {})
    across, down = sampler.get("wrapS", REPEAT), sampler.get("wrapT", REPEAT)
    (a, b, e), (c, d, f) = _from_top_left(moved)
    if across == MIRRORED_REPEAT:
        a, b, e = a / 2, b / 2, e / 2
    if down == MIRRORED_REPEAT:
        c, d, f = c / 2, d / 2, f / 2
    return MapLayout(
        uv_set=moved.get("texCoord", texture.get("texCoord", 0)),
        matrix=(a, b, e, c, d, f),
        repeats=(across != CLAMP_TO_EDGE, down != CLAMP_TO_EDGE),
        mirrors=(across == MIRRORED_REPEAT, down == MIRRORED_REPEAT),
        is_sharp=sampler.get("magFilter") == NEAREST,
    )


def _from_top_left(moved: Json) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """KHR_texture_transform, whose origin is a picture's top left corner, for coordinates from its bottom left."""
    (x, y), (scale_x, scale_y) = moved.get("offset", (0.0, 0.0)), moved.get("scale", (1.0, 1.0))
    cosine, sine = math.cos(moved.get("rotation", 0.0)), math.sin(moved.get("rotation", 0.0))
    a, b, c, d = cosine * scale_x, sine * scale_y, -sine * scale_x, cosine * scale_y
    return (a, -b, b + x), (-c, d, 1 - d - y)
