"""A picture of a known body, prepared once for all that looks at it, and what it says of lights as a whole."""

from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, cached_by_array, upper_quantile
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.core.transforms import camera_centre
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.observed import Lit, Observed
from ashe_live.light.known_body.outline.edges import ShadowEdges, shadow_edges
from ashe_live.light.known_body.outline.profiles import EdgeImage
from ashe_live.light.known_body.outline.room import Room
from ashe_live.light.known_body.outline.texture import without_texture
from ashe_live.light.known_body.rims import Beside, RimSteps
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.sides.bounce import sent_by_sides
from ashe_live.light.known_body.sides.facets import Facets, facets_of
from ashe_live.light.known_body.sides.shading import PAPER, Sides, fall_off
from ashe_live.light.known_body.table import (
    BRIGHTEST,
    CELLS_A_HEIGHT,
    LEAST_CELLS,
    SIDE,
    TableMap,
    linear_picture,
    pixel_from_cell,
    places,
    relative_light,
    sent_by_table,
    table_around,
)
from ashe_live.light.known_body.templates import Templates, templates_of
from ashe_live.light.pixels.view import View

MEAN: Float = np.full(3, 1 / 3)  # weights of R, G, B
BESIDE_CELL = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
BESIDE_BODY = cv2.getStructuringElement(cv2.MORPH_RECT, (5, 5))  # within which blur mixes other things with the table
EDGE_BROAD_PX = 7  # of a known shadow's edge, where no other is looked for
FARTHEST_PX = 1e4  # of an edge from the picture: beyond, it is drawn as if it were there
LEAST_EDGE = 0.05  # difference between the shaded parts of neighbouring cells, from which on an edge is there
DEEP = 0.1  # part of the table's light that a shadow is taken to lack, at least, when its steps are compared with that
BESIDE_HEIGHTS = 1.2  # how far from its foot the table counts as beside the body, in the body's heights
OPEN_TABLE = 0.8  # quantile of the ground's brightness in the picture that is the open table's, if any of it is open


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """The light of the table and of the body's facets, R, G, B."""

    table: TableMap
    relative: Float32  # (n, n, 3) the table's light over the lit table's
    facets: Facets
    from_table: Float  # (k, 3) what the table sends to each facet, in the picture's linear light

    def observed(self, channels: Float, templates: Templates, everywhere: Lit, is_used: Mask | bool = True) -> Observed:
        """By a sum of the channels with weights (3,), to look for further lights `everywhere`.

        is_used: (n, n) cells that are compared with lights' shadows.
        """
        values = self.relative @ channels.astype(np.float32)
        weight = (self.table.seen & (values < BRIGHTEST) & is_used).astype(np.float32)
        sides = Sides.of(self.facets, self.from_table, channels)
        return Observed(values, weight, templates.hidden_sky, templates.hidden_slope, sides, everywhere)


@dataclass(frozen=True, eq=False)
class Seen:
    """A picture of a known body, prepared once for all that looks at it; results are cached."""

    view: View
    body: Proxy
    picture: Float32  # (h, w, 3) linear light, B, G, R
    light: Float32  # (h, w) its mean over the channels, without a rough table's texture
    around: Float32  # (h, w) the same, on a rough table its means around each pixel: stones shine, but not together
    lit_rgb: Float  # (3,) linear light of the lit table, R, G, B; where lamps are known, at the body's foot
    is_table: Mask  # (n, n) cells that are seen and no brighter than a table in the light of suns
    room: Room
    templates: Templates  # everywhere that a light is looked for
    measured: Measured
    observed: Observed  # by the mean of the channels
    pose_shape_errors: PoseShapeErrors | None = None  # how the body and its frame may be off

    @staticmethod
    def of(view: View, body: Proxy, errors: PoseShapeErrors | None = None) -> "Seen | None":
        """None where next to nothing of the table is in view."""
        picture = linear_picture(view)
        table = table_around(view, body, picture)
        if table is None:
            return None
        light = np.asarray(cv2.transform(picture, np.full((1, 3), 1 / 3)), dtype=np.float32)
        relative, lit_rgb = relative_light(table)
        facets = facets_of(view, body, picture)
        templates = templates_of(body).and_behind(camera_centre(view.T_cam_marker), body)
        by_table = sent_by_table(body, table, relative, facets.normals, facets.centres)
        relative = relative - sent_by_sides(templates.from_sides, facets) * table.seen[..., None]
        measured = Measured(table, relative, facets, PAPER * lit_rgb * by_table)
        observed = measured.observed(MEAN, templates, Lit(templates.lights, templates.shadows))
        light, around = without_texture(light, view.is_ground, float(lit_rgb.mean()))
        return Seen(
            view=view,
            body=body,
            picture=picture,
            light=light,
            around=around,
            lit_rgb=lit_rgb,
            is_table=observed.weight.reshape(SIDE, SIDE) > 0,
            room=Room.of(view, body),
            templates=templates,
            measured=measured,
            observed=observed,
            pose_shape_errors=errors,
        )

    def in_light_of(self, lights: Float, darkenings: Float) -> "Seen":
        """The same with the lit table at the body's foot as the measure, which in a lamp's light is as bright nowhere.

        lights: (l, 4) all that are known, darkenings: (l,) part of the table's light that each gives at the foot.
        """
        lit, templates = self.lit(lights), self.templates
        if lit.falls is None:
            return self
        expected = 1 + np.tensordot(darkenings, lit.falls - 1, 1)
        open_table = self.is_table & (lit.shadows.whole().max(axis=0) == 0)
        if np.count_nonzero(open_table) < LEAST_CELLS:
            return self
        at_foot = np.median(self.measured.relative[open_table] / expected[open_table, None], axis=0)
        measured = replace(self.measured, relative=(self.measured.relative / at_foot).astype(np.float32))
        observed = measured.observed(MEAN, templates, Lit(templates.lights, templates.shadows))
        return replace(self, lit_rgb=self.lit_rgb * at_foot, measured=measured, observed=observed)

    @property
    def beside_body(self) -> float:
        """The brightest of the table near the body over the light of the open table, also of that beyond the map.

        Where most of the map is shaded, the rest of the picture shows what light the table would have.
        """
        middle, reach = SIDE // 2, round(BESIDE_HEIGHTS * CELLS_A_HEIGHT)
        near = np.s_[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1]
        values = self.measured.relative[near][self.measured.table.seen[near]]
        ground = self.light[self.view.is_ground]
        if not len(values) or not len(ground):
            return 1.0
        open_light = max(1.0, upper_quantile(ground, OPEN_TABLE) / float(self.lit_rgb.mean()))
        return float(np.percentile(values.mean(axis=1), 90)) / open_light

    def lit(self, lights: Float) -> Lit:
        """The body's shadows in lights (m, 4)."""
        falls = None
        if lights[:, 3].any():
            along, (x, y, _) = places(self.body), self.body.foot_marker
            columns, rows = (each.astype(np.float32) for each in (along + x, along[:, None] + y))
            falls = np.asarray(fall_off(lights[:, None, None].astype(np.float32), columns, rows), dtype=np.float32)
        unit = lights / np.linalg.norm(lights[:, :3], axis=1, keepdims=True)
        return Lit(unit, shadows_of(self.body, lights), falls)

    @cached_by_array
    def beside(self, known: Float) -> MarginalLikelihood:
        """What the picture says of further lights, beside `known` ones (l, 4)."""
        lit, observed = self.lit(known), self.observed
        if len(known):
            everywhere = Lit(self.templates.lights, self.templates.shadows)
            observed = self.measured.observed(MEAN, self.templates, everywhere, _cells_away_from_edges(lit))
        return MarginalLikelihood(observed, lit)

    @cached_by_array
    def rims(self, known: Float) -> RimSteps:
        """At the outlines of the shadows of all lights that are looked for, beside `known` ones (l, 4)."""
        darkenings = self.beside(known).everywhere.darkenings
        sky = 1 - darkenings.sum(axis=1)
        beside, is_table = self._at_outlines
        is_away = self._away_from_edges(is_table, known)
        return beside.seen(is_away, darkenings[:, -1], sky, DEEP)

    @cached_property
    def _at_outlines(self) -> tuple[Beside, Mask]:
        """The picture beside the outlines of all shadows, and (h, w) what of it is bare table away from the body."""
        around = self.around / np.float32(self.lit_rgb.mean())
        is_table = cv2.erode((self.view.is_ground & (around < BRIGHTEST)).view(np.uint8), BESIDE_BODY)
        beside = self.templates.rims.beside(around, pixel_from_cell(self.view, self.body))
        return beside, is_table.view(bool)

    def _away_from_edges(self, is_table: Mask, known: Float) -> Mask:
        """(h, w) what of the table lies away from the edges of the shadows in `known` lights (l, 4)."""
        is_away = is_table.view(np.uint8).copy()
        for one in known:
            edges = self.shadow_edges(one)
            if edges is not None:
                outline = np.round(edges.corners_px.clip(-FARTHEST_PX, FARTHEST_PX)).astype(np.int32)
                cv2.polylines(is_away, [outline], True, 0, EDGE_BROAD_PX)
        return is_away.view(bool)

    @cached_property
    def edge_image(self) -> EdgeImage:
        """In which edges are seen wherever the table is, as long as no light is known."""
        return EdgeImage(self.body, self.view, self.light, self.room)

    @cached_by_array
    def shadow_edges(self, light: Float) -> ShadowEdges | None:
        """The outline of the body's shadow in a light (4,); None where it has none in the picture."""
        return shadow_edges(self.body, light, self.view)

    @cached_by_array
    def darkenings_rgb(self, lights: Float) -> Float:
        """(l, 3) part of the table's light, R, G, B, that each of lights (l, 4) gives, by the map and the sides."""
        known, nothing = self.lit(lights), self.lit(lights[:0])
        channels = (self.measured.observed(channel, self.templates, nothing) for channel in np.eye(3))
        return np.stack([MarginalLikelihood(channel, known).darkenings for channel in channels], axis=1)


def _cells_away_from_edges(lit: Lit) -> Mask:
    """(n, n) cells that no edge of these lights' shadows comes near, by the cells beside them.

    A folded body's shadow lies a part of a cell from where it is predicted, which would be another light's.
    """
    away = np.ones((SIDE, SIDE), bool)
    for shadow in lit.shadows.whole():
        most, least = (change(shadow, BESIDE_CELL) for change in (cv2.dilate, cv2.erode))
        away &= most - least < LEAST_EDGE
    return away
