"""A picture of a known body in which the edges of its shadow are looked for."""

from dataclasses import dataclass

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.outline.edges import ShadowEdges, shadow_edges
from ashe_live.light.known_body.outline.profiles import Profiles
from ashe_live.light.known_body.outline.room import Room
from ashe_live.light.known_body.table import height_px
from ashe_live.light.pixels.view import View


@dataclass(frozen=True, slots=True, eq=False)
class EdgeImage:
    """The picture, the body in it, and where on the table edges can be seen."""

    body: Proxy
    view: View
    light: Float32  # (h, w) linear
    room: Room  # the bare table, without what is in the penumbrae of lights that are known

    @property
    def height_m(self) -> float:
        """Of the body."""
        return self.body.height_m

    @property
    def height_px(self) -> float:
        """Of the body in the picture, as if seen from the side."""
        return height_px(self.body, self.view)

    def edges(self, light: Float) -> ShadowEdges | None:
        """Where those of the shadow in a light (4,), marker frame, are predicted; None where it has none here."""
        return shadow_edges(self.body, light, self.view)

    def profiles(self, edges: ShadowEdges, wanted_px: Float) -> Profiles:
        """The picture across predicted edges, within `wanted_px` (n,) of them, or less where there is less room."""
        return Profiles.of(edges, wanted_px, self.light, self.room)
