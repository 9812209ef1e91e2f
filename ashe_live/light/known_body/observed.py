"""Pictures of a known body as a map of the light on its table and the light of its sides; how lights change both.

Both are linear in the part of the open table's light that each light gives, its darkening, once the lights' directions
are given; the sky gives the rest. Slow gradients of the table's light, and how much of the sky the body really hides,
are marginalised (docs/maths, "A known body").
"""

import math
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.light.known_body.shadows import Shadows
from ashe_live.light.known_body.sides.shading import SLOPE, Sides
from ashe_live.light.known_body.table import SIDE

# Cells whose errors are correlated, as stains, planks, tiles and other things' shadows are wider than a cell: the
# sample size is divided by at least this; by more where what is left of a map is alike over squares of so many cells
# along each side, which are as wide as a body's short shadow.
CELLS_A_SAMPLE, ALIKE = 13.0, 9
USUAL_NOISE = 0.06  # standard deviation of relative light that most maps have
# The number of terms in which the table's light varies without any lights. The first HIDDEN are slow gradients; then
# come the sky that the body hides, and how that leans along x and along y.
VARIED, HIDDEN = 9, 6
# Standard deviations under a sky that gives all of the table's light: of what the body hides of it, over what it would
# hide of an even one (painted cubes' skies are off by half of this); and of the sky's slope.
HIDDEN_SIGMA, LEANING_SIGMA = 0.2, SLOPE
BESIDE_LIGHTS = 0.5  # factor on both for a sky beside lights, which gives about half of the light


@dataclass(frozen=True, slots=True, eq=False)
class Lit:
    """Lights and the shadows of a body in them."""

    lights: Float  # (m, 4) unit (x, y, z)
    shadows: Shadows
    falls: Float32 | None = None  # (m, n, n) what they give to each cell over what they give at the foot; None: suns

    def taken(self, hidden_sky: Float32) -> Float32:
        """(m, n * n) what each light adds to each cell in place of as much of the sky, of which a part is hidden."""
        lit = 1 - self.shadows.whole()
        lit = lit if self.falls is None else lit * self.falls
        return np.asarray(hidden_sky - 1 + lit.reshape(-1, SIDE * SIDE), dtype=np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Effects:
    """What each of m lights would do to map and sides, one at a time, the map's part without what else varies."""

    lit: Lit
    varied: Float  # (m, VARIED) products of its part of the map with what else varies
    explained: Float  # (m, VARIED) how much of it varies with what
    squares: Float  # (m,)
    pull: Float  # (m,) products with the map's light
    reached: Float  # (k, m) of the sides: as by Sides.reached
    spread: Float  # (k, m) as by Sides.spread


class Observed:
    """The map and the sides by one picture or several, or by one colour channel of them, whatever lights are known."""

    def __init__(
        self,
        values: Float32,
        weight: Float32,
        hidden_sky: Float32,
        hidden_slope: Float32,
        sides: Sides,
        everywhere: Lit,
    ) -> None:
        """values: (n, n) relative light of the table's cells, with their weights. hidden_sky, hidden_slope: as in
        Templates. everywhere: lights in all directions in which further ones are looked for.
        """
        self.sides, self.hidden_sky, self.weight = sides, hidden_sky, weight.reshape(-1)
        self.cells = float(self.weight.sum())
        # All of the sky's light is taken for granted, and lights take from it.
        base = np.concatenate([_slow(), hidden_sky[None], hidden_slope, values.reshape(1, -1) + hidden_sky])
        weighted = base * self.weight
        moments = (weighted @ base.T).astype(np.float64)
        self._of_hidden = moments[HIDDEN].copy()
        sky = slice(HIDDEN, VARIED)
        known = CELLS_A_SAMPLE * USUAL_NOISE**2 * np.diag([HIDDEN_SIGMA**-2, LEANING_SIGMA**-2, LEANING_SIGMA**-2])
        moments[sky, sky] += known / BESIDE_LIGHTS**2
        self._base = base
        self._columns = np.ascontiguousarray(weighted.T).reshape(SIDE, SIDE, -1)
        self._without_varied, light = np.linalg.inv(moments[:VARIED, :VARIED]), moments[:VARIED, VARIED]
        self._of_light = light
        # Sum of squares of what is left if no light is there.
        self.squares = float(moments[VARIED, VARIED] - light @ self._without_varied @ light)
        self.sky = np.asarray(self._without_varied[sky] @ light)
        # Where the sky gives all light its prior is so much wider.
        wider, left = known * (BESIDE_LIGHTS**-2 - 1), self._without_varied[sky, sky]
        self._by_wider_sky = np.linalg.inv(np.linalg.inv(wider) - left)
        self.volume = 3 * math.log(BESIDE_LIGHTS) - 0.5 * float(np.linalg.slogdet(np.eye(3) - wider @ left)[1])
        self.everywhere = self.expected(everywhere)

    def taken_by_sky(self, sky: Float) -> Float:
        """(m,) by how much less of the map's squares is left if the sky gives all light.

        sky: (3, m) how it differs from an even one beside lights: in what is hidden of it, and in its slope.
        """
        return np.asarray((sky * (self._by_wider_sky @ sky)).sum(axis=0))

    def alike(self, explained: Float) -> float:
        """Cells whose errors are as one, of what `explained` (n * n) and what else varies leave of the map.

        The variance of means over squares, times their cells, over that of cells: 1 of white noise, all cells of a
        square where it is one stain.
        """
        rest = self._base[VARIED] - explained
        by_varied = self._without_varied @ (self._columns.reshape(SIDE * SIDE, -1)[:, :VARIED].T @ rest)
        rest = ((rest - by_varied @ self._base[:VARIED]) * self.weight).astype(np.float32)
        variance = float(rest @ rest) / max(self.cells, 1.0)
        sums, counts = (
            cv2.boxFilter(
                each.reshape(SIDE, SIDE), cv2.CV_32F, (ALIKE, ALIKE), normalize=False, borderType=cv2.BORDER_CONSTANT
            )
            for each in (rest, self.weight)
        )
        whole = counts > ALIKE**2 / 2
        if variance <= 0 or not whole.any():
            return 1.0
        return float((sums[whole] ** 2 / counts[whole]).mean()) / variance

    def expected(self, lit: Lit) -> Effects:
        """What these lights would do."""
        if lit.falls is not None:
            taken = lit.taken(self.hidden_sky)
            mixed = (taken @ self._columns.reshape(SIDE * SIDE, -1)).astype(np.float64)
            squares = (taken * taken @ self.weight).astype(np.float64)
        else:  # nearly everywhere it is the sky's hidden light alone
            sums = lit.shadows.sums(self._columns)
            mixed = self._of_hidden - sums
            squares = mixed[:, HIDDEN] - sums[:, HIDDEN] + lit.shadows.squares(self.weight.reshape(SIDE, SIDE))
        varied = mixed[:, :VARIED]
        explained = varied @ self._without_varied
        squares -= (explained * varied).sum(axis=1)
        pull = mixed[:, VARIED] - explained @ self._of_light
        reached = self.sides.reached(lit.lights)
        spread = np.ascontiguousarray(self.sides.spread(lit.lights, reached).T)
        return Effects(lit, varied, explained, squares, pull, np.ascontiguousarray(reached.T), spread)


@cache
def _slow() -> Float32:
    """(6, n * n) a quadratic in the places."""
    y, x = (np.mgrid[:SIDE, :SIDE].reshape(2, -1) / (SIDE // 2) - 1).astype(np.float32)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
