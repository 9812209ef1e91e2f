"""A picture of a known body, prepared once for all that looks at it, and what it says of lights as a whole."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.evidence import Evidence, Lit
from ashe_live.light.known_body.facets import Facets, facets_of
from ashe_live.light.known_body.outline.room import Room
from ashe_live.light.known_body.shading import PAPER, Sides, fall_off
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.table import (
    BRIGHTEST,
    CELLS_A_HEIGHT,
    LEAST_CELLS,
    SIDE,
    Table,
    linear_picture,
    places,
    relative_light,
    sent_by_table,
    table_around,
)
from ashe_live.light.known_body.templates import templates_of
from ashe_live.light.pixels.view import View

BESIDE_HEIGHTS = 1.2  # how far from the body's foot the table counts as beside it


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A picture of a known body, prepared once for all that looks at it."""

    view: View
    body: Proxy
    picture: Float32  # (h, w, 3) linear light, B, G, R
    light: Float32  # (h, w) its mean over the channels
    table: Table
    relative: Float32  # (n, n, 3) R, G, B: the table's light over the lit table's
    lit_rgb: Float  # (3,) linear light of the lit table, R, G, B; where lamps are known, at the body's foot
    is_table: Mask  # (n, n) cells that are seen and no brighter than a table in the light of suns
    room: Room
    facets: Facets
    from_table: Float  # (k, 3) R, G, B: what the table sends to each facet, in the picture's linear light

    @staticmethod
    def of(view: View, body: Proxy) -> "Seen | None":
        """None where next to nothing of the table is in view."""
        picture = linear_picture(view)
        table = table_around(view, body, picture)
        if table is None:
            return None
        light = np.asarray(cv2.transform(picture, np.full((1, 3), 1 / 3)), dtype=np.float32)
        relative = relative_light(table)
        is_table = table.seen & (relative.mean(axis=2) < BRIGHTEST)
        seen = table.light_rgb[table.seen] / np.maximum(relative[table.seen], 1e-6)
        lit_rgb = np.asarray(np.median(seen, axis=0), dtype=np.float64)
        facets = facets_of(view, body, picture)
        sent = sent_by_table(body, table, relative, facets.normals, facets.centres)
        room, from_table = Room.of(view, body), PAPER * lit_rgb * sent
        return Seen(view, body, picture, light, table, relative, lit_rgb, is_table, room, facets, from_table)

    def in_light_of(self, lights: Float, darkenings: Float) -> "Seen":
        """The same with the lit table at the body's foot as the measure, which in a lamp's light is as bright nowhere.

        lights: (l, 4) all that are known, darkenings: (l,) part of the table's light that each gives at the foot.
        """
        lit = self.lit(lights)
        if lit.falls is None:
            return self
        expected = 1 + np.tensordot(darkenings, lit.falls - 1, 1)
        open_table = self.is_table & (lit.shadows.whole().max(axis=0) == 0)
        if np.count_nonzero(open_table) < LEAST_CELLS:
            return self
        at_foot = np.median(self.relative[open_table] / expected[open_table, None], axis=0)
        relative = (self.relative / at_foot).astype(np.float32)
        return replace(self, relative=relative, lit_rgb=self.lit_rgb * at_foot)

    @property
    def beside_body(self) -> float:
        """The brightest of the table near the body over the open table's light."""
        middle, reach = SIDE // 2, round(BESIDE_HEIGHTS * CELLS_A_HEIGHT)
        near = np.s_[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1]
        values = self.relative[near][self.table.seen[near]]
        return float(np.percentile(values.mean(axis=1), 90)) if len(values) else 1.0

    def lit(self, lights: Float) -> Lit:
        """The body's shadows in lights (m, 4)."""
        falls = None
        if lights[:, 3].any():
            along, (x, y, _) = places(self.body), self.body.foot_marker
            falls = np.array([fall_off(light, along + x, along[:, None] + y) for light in lights], np.float32)
        unit = lights / np.linalg.norm(lights[:, :3], axis=1, keepdims=True)
        return Lit(unit, shadows_of(self.body, lights), falls)

    def beside(self, known: Float, everywhere: Lit) -> Evidence:
        """What the picture says of further lights, beside `known` ones (l, 4)."""
        return self._evidence(self.lit(known), everywhere, np.full(3, 1 / 3))

    def darkenings_rgb(self, lights: Float) -> Float:
        """(l, 3) part of the table's light, R, G, B, that each of lights (l, 4) gives, by the map and the sides."""
        known, nothing = self.lit(lights), self.lit(lights[:0])
        return np.stack([self._evidence(known, nothing, channel).darkenings for channel in np.eye(3)], axis=1)

    def _evidence(self, known: Lit, everywhere: Lit, channels: Float) -> Evidence:
        """channels: (3,) weights of R, G, B."""
        values = self.relative @ channels.astype(np.float32)
        sides = Sides.of(self.facets, self.from_table, channels)
        weight = (self.table.seen & (values < BRIGHTEST)).astype(np.float32)
        hidden_sky = templates_of(self.body).hidden_sky
        return Evidence(values, weight, hidden_sky, sides, known, everywhere)
