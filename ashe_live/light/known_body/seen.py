"""Pictures of a known body, prepared once for all that looks at them, and what they say of lights as a whole."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, cached_by_array, upper_quantile
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.core.transforms import camera_centre
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.observed import Lit, Observed
from ashe_live.light.known_body.outline.profiles import EdgeImages
from ashe_live.light.known_body.pictures.merged import merged_facets, merged_table
from ashe_live.light.known_body.pictures.photo import Photo
from ashe_live.light.known_body.pictures.shots import shots_of
from ashe_live.light.known_body.rims import RimSteps, steps_in
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.sides.bounce import sent_by_sides
from ashe_live.light.known_body.sides.facets import Facets
from ashe_live.light.known_body.sides.shading import PAPER, Sides, fall_off
from ashe_live.light.known_body.table import (
    BRIGHTEST,
    CELLS_A_HEIGHT,
    LEAST_CELLS,
    SIDE,
    TableMap,
    places,
    relative_light,
    sent_by_table,
)
from ashe_live.light.known_body.templates import Templates, templates_of
from ashe_live.light.pixels.view import View

MEAN: Float = np.full(3, 1 / 3)  # weights of R, G, B
BESIDE_CELL = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
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
    from_table: Float  # (k, 3) what the table sends to each facet, in the first picture's linear light

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
    """Pictures of a known body in one scene, prepared once for all that looks at them; results are cached."""

    body: Proxy
    photos: tuple[Photo, ...]  # the first is the one in whose frame and exposure the answer is given
    is_table: Mask  # (n, n) cells that are seen and no brighter than a table in the light of suns
    templates: Templates  # everywhere that a light is looked for
    measured: Measured  # in the exposure of the first picture
    observed: Observed  # by the mean of the channels

    @staticmethod
    def of(
        view: View,
        body: Proxy,
        errors: PoseShapeErrors | None = None,
        others: Sequence[tuple[View, PoseShapeErrors | None]] = (),
    ) -> "Seen | None":
        """By a view and others of the same scene; None where next to nothing of the table is in the first.

        errors: how body and frame may be off in a view. Another view with too little of the table that the first shows
        is left out.
        """
        shots = shots_of([(view, errors), *others], body)
        if not shots:
            return None
        table, facets = merged_table(shots), merged_facets(shots, body)
        relative, lit_rgb = relative_light(table)
        templates = templates_of(body).and_behind(camera_centre(view.T_cam_marker), body)
        by_table = sent_by_table(body, table, relative, facets.normals, facets.centres)
        relative = relative - sent_by_sides(templates.from_sides, facets) * table.seen[..., None]
        measured = Measured(table, relative, facets, PAPER * lit_rgb * by_table)
        observed = measured.observed(MEAN, templates, Lit(templates.lights, templates.shadows))
        is_table = observed.weight.reshape(SIDE, SIDE) > 0
        photos = tuple(Photo.of(each, body, lit_rgb / each.gain) for each in shots)
        return Seen(body, photos, is_table, templates, measured, observed)

    @property
    def lit_rgb(self) -> Float:
        """(3,) linear light of the lit table, R, G, B, in the first picture; where lamps are known, at the foot."""
        return self.photos[0].lit_rgb

    def shows(self, view: View) -> bool:
        """Whether a view is among the pictures."""
        return any(each.view is view for each in self.photos)

    @cached_property
    def edge_images(self) -> EdgeImages:
        """In which edges are seen wherever the table is, as long as no light is known."""
        return EdgeImages(tuple(each.edge_image for each in self.photos))

    @cached_by_array
    def showing(self, light: Float) -> Photo:
        """The first picture that shows a light's (4,) shadow: at least half as much of its outline as any."""
        view = self.edge_images.showing(light).view
        return next(each for each in self.photos if each.view is view)

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
        photos = tuple(replace(each, lit_rgb=each.lit_rgb * at_foot) for each in self.photos)
        return replace(self, photos=photos, measured=measured, observed=observed)

    @property
    def beside_body(self) -> float:
        """The brightest of the table near the body over the light of the open table, also of that beyond the map.

        Where most of the map is shaded, the rest of the picture shows what light the table would have.
        """
        middle, reach = SIDE // 2, round(BESIDE_HEIGHTS * CELLS_A_HEIGHT)
        near = np.s_[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1]
        values = self.measured.relative[near][self.measured.table.seen[near]]
        first = self.photos[0]
        ground = first.light[first.view.is_ground]
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
        """What the pictures say of further lights, beside `known` ones (l, 4)."""
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
        pictures = [photo.beside(self.templates.rims, known) for photo in self.photos]
        return steps_in(pictures, darkenings[:, -1], sky, DEEP)

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
