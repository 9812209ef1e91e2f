"""A picture of a known body, prepared once for all that looks at it, and what it says of lights as a whole."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.facets import Facets, facets_of
from ashe_live.light.known_body.scan import SKY_SHARES, Scan, relative_light, scanned, templates_of
from ashe_live.light.known_body.shading import shading_log_likelihood
from ashe_live.light.known_body.table import BRIGHTEST, CELLS_A_HEIGHT, SIDE, Table, linear_picture, table_around
from ashe_live.light.pixels.view import View

BESIDE_HEIGHTS = 1.2  # how far from the body's foot the table counts as beside it
BESIDE_PX = 2  # of the body, whose rim is neither table nor shadow


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A picture of a known body, prepared once for all that looks at it."""

    view: View
    body: Proxy
    picture: Float32  # (h, w, 3) linear light, B, G, R
    light: Float32  # (h, w) its mean over the channels
    clear: Mask  # (h, w) bare table, not beside the body
    table: Table
    relative: Float32  # (n, n, 3) R, G, B: the table's light over the lit table's
    brightness: Float32  # (n, n) its mean over the channels, clipped against what is no table
    facets: Facets

    @staticmethod
    def of(view: View, body: Proxy) -> "Seen | None":
        """None where next to nothing of the table is in view."""
        picture = linear_picture(view)
        table = table_around(view, body, picture)
        if table is None:
            return None
        kernel = np.ones((2 * BESIDE_PX + 1,) * 2, np.uint8)
        clear = cv2.erode(view.is_ground.astype(np.uint8), kernel) > 0
        light = np.asarray(cv2.transform(picture, np.full((1, 3), 1 / 3)), dtype=np.float32)
        relative = relative_light(table)
        brightness = np.minimum(relative.mean(axis=2), BRIGHTEST).astype(np.float32)
        facets = facets_of(view, body, picture)
        return Seen(view, body, picture, light, clear, table, relative, brightness, facets)

    @property
    def beside_body(self) -> float:
        """The brightest of the table near the body over the open table's light."""
        middle, reach = SIDE // 2, round(BESIDE_HEIGHTS * CELLS_A_HEIGHT)
        near = np.s_[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1]
        values = self.relative[near][self.table.seen[near]]
        return float(np.percentile(values.mean(axis=1), 90)) if len(values) else 1.0

    @property
    def lit_rgb(self) -> Float:
        """(3,) linear light of the lit table, R, G, B."""
        seen = self.table.light_rgb[self.table.seen] / np.maximum(self.relative[self.table.seen], 1e-6)
        return np.asarray(np.median(seen, axis=0), dtype=np.float64)

    def scan(self, shadows: Float32, also: Float32) -> Scan:
        """How well `shadows` (m, n * n) explain the table beside others (k, n * n), those of lights that are known."""
        weight = self.table.seen.astype(np.float32)
        return scanned(self.brightness, weight, shadows, templates_of(self.body).hidden_sky, also)

    def by_shading(self, lights: Float) -> Float:
        """(m, k) log likelihood of the facets' light in lights (m, 4), under each of SKY_SHARES."""
        to_lights = lights[:, :3] / np.linalg.norm(lights[:, :3], axis=1, keepdims=True)
        return shading_log_likelihood(self.facets, self.lit_rgb, to_lights, SKY_SHARES.astype(np.float64))

    @property
    def by_shading_of_sky(self) -> float:
        """The same under the sky alone, which then gives all of the light."""
        return float(shading_log_likelihood(self.facets, self.lit_rgb, np.array([(0.0, 0.0, 1.0)]), np.ones(1))[0, 0])
