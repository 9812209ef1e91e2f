"""A picture of a known body, prepared once for all that looks at the edges in it."""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, cached_by_array, once_for_each
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.light.known_body.outline.edges import ShadowEdges, shadow_edges
from ashe_live.light.known_body.outline.profiles import EdgeImage
from ashe_live.light.known_body.outline.room import Room
from ashe_live.light.known_body.outline.texture import without_texture
from ashe_live.light.known_body.pictures.shots import Shot
from ashe_live.light.known_body.rims import Beside, Rims
from ashe_live.light.known_body.table import BRIGHTEST, pixel_from_cell
from ashe_live.light.pixels.view import View

BESIDE_BODY = cv2.getStructuringElement(cv2.MORPH_RECT, (5, 5))  # within which blur mixes other things with the table
EDGE_BROAD_PX = 7  # of a known shadow's edge, where no other is looked for
FARTHEST_PX = 1e4  # of an edge from the picture: beyond, it is drawn as if it were there


@dataclass(frozen=True, eq=False)
class Photo:
    """A picture of a known body; results are cached."""

    view: View
    body: Proxy
    picture: Float32  # (h, w, 3) linear light, B, G, R
    light: Float32  # (h, w) its mean over the channels, without a rough table's texture
    around: Float32  # (h, w) the same, on a rough table its means around each pixel: stones shine, but not together
    lit_rgb: Float  # (3,) linear light of the lit table, R, G, B; where lamps are known, at the body's foot
    room: Room
    pose_shape_errors: PoseShapeErrors | None = None  # how the body and its frame may be off

    @staticmethod
    def of(shot: Shot, body: Proxy, lit_rgb: Float) -> "Photo":
        """lit_rgb: (3,) linear light R, G, B of the lit table in its picture."""
        light = np.asarray(cv2.transform(shot.picture, np.full((1, 3), 1 / 3)), dtype=np.float32)
        light, around = without_texture(light, shot.view.is_ground, float(lit_rgb.mean()))
        return Photo(shot.view, body, shot.picture, light, around, lit_rgb, Room.of(shot.view, body), shot.errors)

    @cached_property
    def edge_image(self) -> EdgeImage:
        """In which edges are seen wherever the table is, as long as no light is known."""
        return EdgeImage(self.body, self.view, self.light, self.room, self.pose_shape_errors)

    @cached_by_array
    def shadow_edges(self, light: Float) -> ShadowEdges | None:
        """The outline of the body's shadow in a light (4,); None where it has none in the picture."""
        return shadow_edges(self.body, light, self.view)

    def beside(self, rims: Rims, known: Float) -> tuple[Beside, Mask]:
        """The picture beside shadows' outlines; and (h, w) what of it is bare table away from the body, and from the
        edges of the shadows in `known` lights (l, 4).
        """
        beside, is_table = self._at_outlines(rims)
        is_away = is_table.view(np.uint8).copy()
        for one in known:
            edges = self.shadow_edges(one)
            if edges is not None:
                outline = np.round(edges.corners_px.clip(-FARTHEST_PX, FARTHEST_PX)).astype(np.int32)
                cv2.polylines(is_away, [outline], True, 0, EDGE_BROAD_PX)
        return beside, is_away.view(bool)

    @once_for_each
    def _at_outlines(self, rims: Rims) -> tuple[Beside, Mask]:
        """As `beside`, whatever lights are known."""
        around = self.around / np.float32(self.lit_rgb.mean())
        is_table = cv2.erode((self.view.is_ground & (around < BRIGHTEST)).view(np.uint8), BESIDE_BODY)
        return rims.beside(around, pixel_from_cell(self.view, self.body)), is_table.view(bool)
