"""The maps of one glTF material, as far as a mesh's texture coordinates let them be drawn."""

from typing import Any

from ashe_live.core.arrays import Image
from ashe_live.models.material import MAP_SETS, MapLayout


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
