"""What a picture of a known body says of lights: its table's light and its sides' light, in one linear model.

Light is a sum, so that both are linear in the part of the open table's light that each light gives, its darkening, once
the lights' directions are given; the sky gives the rest. Slow gradients of the table's light, and how much of the sky
the body really hides, are marginalised (docs/maths.md, "A known body").
"""

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.light.known_body.shading import Sides
from ashe_live.light.known_body.shadows import Shadows
from ashe_live.light.known_body.table import SIDE

# Cells whose errors are correlated, as stains, planks, tiles and other things' shadows are wider than a cell: the
# sample size is divided by at least this; by more where what is left of a map is alike over squares of so many cells
# along each side, which are as wide as a body's short shadow.
CELLS_A_SAMPLE, ALIKE = 13.0, 9
LEAST_NOISE, USUAL_NOISE = 0.02, 0.06  # standard deviation of relative light: what every map has, and what most have
RIDGE = 1e-6
# What else varies on a table: slow terms; the sky that the body hides; and how that leans, along x and along y.
VARIED, HIDDEN, LEANING = 9, 6, slice(7, 9)
# Before the picture is seen: the part of the table's light that a light gives, and its standard deviation.
DARKENING, DARKENING_SIGMA = 0.35, 0.35
MOST_DARKENING = 0.97  # by all lights together: some light always comes from elsewhere
# Of the sky's light that the body hides, over what it would hide of an even sky that gave all of the table's: a sky
# that gives half of it and hides a fifth more or less. Painted cubes' skies are off by half of this.
HIDDEN_SIGMA = 0.1
LEANING_SIGMA = 0.06  # of the slope of such a sky, of SLOPE for one that gives all of the table's light
ROUNDS = 2  # of the sides' variances, which depend on how bright the lights are


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """How well each of m lights explains a picture, beside l others that are known."""

    log_likelihood: Float  # (m,) over that of the known ones alone
    darkenings: Float  # (m, l + 1) part of the table's light that each light would give, that of the new one last


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
class _Expected:
    """What each of m lights would do to map and sides, one at a time, the map's part without what else varies."""

    lit: Lit
    varied: Float  # (m, VARIED) products of its part of the map with what else varies
    explained: Float  # (m, VARIED) how much of it varies with what
    squares: Float  # (m,)
    pull: Float  # (m,) products with the map's light
    reached: Float  # (k, m) of the sides: as by Sides.reached
    spread: Float  # (k, m) as by Sides.spread


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    """Normal equations of m sets of l lights; sets come last, as all are solved at once and each is small."""

    information: Float  # (l, l, m) of the map, without what else varies
    pull: Float  # (l, m)
    reached: Float  # (l, k, m)
    spread: Float  # (l, k, m)


class Observed:
    """The map and the sides of one picture, or of one of its colour channels, whatever lights are known."""

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
        moments[HIDDEN, HIDDEN] += CELLS_A_SAMPLE * (USUAL_NOISE / HIDDEN_SIGMA) ** 2
        moments[LEANING, LEANING] += CELLS_A_SAMPLE * (USUAL_NOISE / LEANING_SIGMA) ** 2 * np.eye(2)
        self._base = base
        self._columns = np.ascontiguousarray(weighted.T).reshape(SIDE, SIDE, -1)
        self._without_varied, light = np.linalg.inv(moments[:VARIED, :VARIED]), moments[:VARIED, VARIED]
        self._of_light = light
        # Sum of squares of what is left if no light is there.
        self.squares = float(moments[VARIED, VARIED] - light @ self._without_varied @ light)
        self.everywhere = self.expected(everywhere)

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

    def expected(self, lit: Lit) -> _Expected:
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
        return _Expected(lit, varied, explained, squares, pull, np.ascontiguousarray(reached.T), spread)


class Evidence:
    """What a picture, or one of its colour channels, says of lights beside those that are known."""

    everywhere: Scan  # of a further light in all directions

    def __init__(self, observed: Observed, known: Lit) -> None:
        """What the best of all directions leaves of the map is its noise, as correlated as that is."""
        self._observed = observed
        self._known = expected = observed.expected(known)
        taken = known.taken(observed.hidden_sky)
        self._taken = taken * observed.weight
        self._columns = np.ascontiguousarray(self._taken.T).reshape(SIDE, SIDE, -1)
        information = self._taken @ taken.T - expected.explained @ expected.varied.T
        self._without = _Normal(
            information[..., None], expected.pull[:, None], expected.reached.T[..., None], expected.spread.T[..., None]
        )
        beside = self._with(observed.everywhere)
        left, best, darkenings = min(
            (self._left_by_best(each) for each in (beside, self._without)), key=lambda one: one[0]
        )
        self._variance = left / observed.cells + LEAST_NOISE**2
        mixed = darkenings[: len(known.lights)] @ taken
        if len(darkenings) > len(known.lights):
            new = observed.everywhere.lit
            mixed = mixed + darkenings[-1] * (observed.hidden_sky - new.shadows.one(best).ravel())
        self._cells_a_sample = max(CELLS_A_SAMPLE, observed.alike(mixed))
        self._none, self._darkenings = self._explained(self._without)
        self.everywhere = self._scan(beside)

    def scanned(self, lights: Lit) -> Scan:
        """How well further lights explain the picture, one at a time."""
        return self._scan(self._with(self._observed.expected(lights)))

    @property
    def darkenings(self) -> Float:
        """(l,) part of the table's light that each known light gives."""
        return np.asarray(self._darkenings[:, 0])

    def _scan(self, beside: _Normal) -> Scan:
        log_likelihood, darkenings = self._explained(beside)
        return Scan(log_likelihood - self._none, darkenings.T)

    def _with(self, new: _Expected) -> _Normal:
        """The known lights and each of the new ones."""
        known, without = self._known, self._without
        m, count = len(new.squares), len(known.squares)
        information = np.empty((count + 1, count + 1, m))
        information[:-1, :-1], information[-1, -1] = without.information, new.squares
        if count:
            information[-1, :-1] = information[:-1, -1] = self._overlaps(new) - known.varied @ new.explained.T
        pull = np.empty((count + 1, m))
        pull[:-1], pull[-1] = without.pull, new.pull
        sides = np.empty((2, count + 1, len(new.reached), m))
        sides[0, :-1], sides[0, -1] = without.reached, new.reached
        sides[1, :-1], sides[1, -1] = without.spread, new.spread
        return _Normal(information, pull, *sides)

    def _overlaps(self, new: _Expected) -> Float:
        """(l, m) products of the new lights' parts of the map with those of the known ones."""
        if new.lit.falls is not None:
            return (self._taken @ new.lit.taken(self._observed.hidden_sky).T).astype(np.float64)
        return np.asarray((self._known.varied[:, HIDDEN] - new.lit.shadows.sums(self._columns)).T)

    def _left_by_best(self, normal: _Normal) -> tuple[float, int, Float]:
        """Sum of squares of the map that is left by the set of lights that explains it best; which, its darkenings."""
        ridge = RIDGE * self._observed.cells * np.eye(len(normal.pull))[..., None]
        darkenings, _ = _solved(normal.information + ridge, normal.pull)
        darkenings = darkenings.clip(0.0, 1.0)
        left = self._left(normal, darkenings)
        if not len(left) or left.min() > self._observed.squares:
            return self._observed.squares, 0, np.zeros(len(darkenings))
        best = int(left.argmin())
        return float(left[best]), best, darkenings[:, best]

    def _left(self, normal: _Normal, darkenings: Float) -> Float:
        """(m,) sum of squares of the map that is left by lights of darkenings (l, m)."""
        explained = 2 * normal.pull - (normal.information * darkenings).sum(axis=1)
        return np.asarray(np.maximum(self._observed.squares - (explained * darkenings).sum(axis=0), 0.0))

    def _explained(self, normal: _Normal) -> tuple[Float, Float]:
        """(m,) log likelihood of map and sides, with each set of lights, and (l, m) their darkenings."""
        sides, cells, prior = self._observed.sides, self._observed.cells, 1 / DARKENING_SIGMA**2
        count, reached = len(normal.pull), normal.reached
        by_map = normal.information / (self._cells_a_sample * self._variance) + prior * np.eye(count)[..., None]
        pull_of_map = normal.pull / (self._cells_a_sample * self._variance) + prior * DARKENING
        darkenings = np.full(normal.pull.shape, DARKENING)
        for _ in range(ROUNDS):
            told = reached * (~sides.is_clipped[:, None] / sides.variance(normal.spread, darkenings))
            information = by_map + (told[:, None] * reached).sum(axis=2)
            pull = pull_of_map + (told * sides.residual[:, None]).sum(axis=1)
            darkenings, log_determinant = _solved(information, pull)
            darkenings = darkenings.clip(0.0, MOST_DARKENING)
            darkenings /= np.maximum(darkenings.sum(axis=0) / MOST_DARKENING, 1.0)
        left = self._left(normal, darkenings) / cells + LEAST_NOISE**2
        by_map_left = -0.5 * cells / self._cells_a_sample * np.log(left)
        by_sides = sides.log_likelihood(reached, darkenings, sides.variance(normal.spread, darkenings))
        by_prior = -0.5 * prior * ((darkenings - DARKENING) ** 2).sum(axis=0)
        volume = 0.5 * (count * np.log(prior) - log_determinant)
        return by_map_left + by_sides + by_prior + volume, darkenings


def _solved(matrices: Float, vectors: Float) -> tuple[Float, Float]:
    """(l, m) solutions of m positive definite systems (l, l, m), (l, m), and (m,) the logs of their determinants.

    By Gaussian elimination, of all at once: each is far too small for a call of its own.
    """
    count = len(vectors)
    rows = np.concatenate([matrices, vectors[:, None]], axis=1)
    log_determinant = np.zeros(vectors.shape[1])
    for at in range(count):
        log_determinant += np.log(rows[at, at])
        rows[at, at + 1 :] /= rows[at, at]
        for other in range(count):
            if other != at:
                rows[other, at + 1 :] -= rows[other, at] * rows[at, at + 1 :]
    return rows[:, count], log_determinant


@cache
def _slow() -> Float32:
    """(6, n * n) a quadratic in the places."""
    y, x = (np.mgrid[:SIDE, :SIDE].reshape(2, -1) / (SIDE // 2) - 1).astype(np.float32)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
