"""What a picture of a known body says of lights: its table's light and its sides' light, in one linear model.

Light is a sum, so that both are linear in the part of the open table's light that each light gives, its darkening, once
the lights' directions are given; the sky gives the rest. Slow gradients of the table's light, and how much of the sky
the body really hides, are marginalised (docs/maths.md, "A known body").
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.light.known_body.shading import Sides
from ashe_live.light.known_body.shadows import Shadows
from ashe_live.light.known_body.table import SIDE

# Cells whose errors are correlated, as stains and prints on a table are wider than a cell: the sample size is divided
# by this.
CELLS_A_SAMPLE = 13.0
LEAST_NOISE, USUAL_NOISE = 0.02, 0.06  # standard deviation of relative light: what every map has, and what most have
RIDGE = 1e-6
VARIED = 7  # what else varies on a table: slow terms, and the sky that the body hides
# Before the picture is seen: the part of the table's light that a light gives, and its standard deviation.
DARKENING, DARKENING_SIGMA = 0.35, 0.35
MOST_DARKENING = 0.97  # by all lights together: some light always comes from elsewhere
# Of the sky's light that the body hides, over what it would hide of an even sky that gave all of the table's: a sky
# that gives half of it and hides a fifth more or less. Painted cubes' skies are off by half of this.
HIDDEN_SIGMA = 0.1
ROUNDS = 2  # of the sides' variances, which depend on how bright the lights are


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """How well each of m lights explains a picture, beside l others that are known."""

    log_likelihood: Float  # (m,) over that of the known ones alone
    darkenings: Float  # (m, l + 1) part of the table's light that each light would give, that of the new one last


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    """Normal equations of the map for m sets of lights, without what else varies."""

    lights: Float  # (m, l, 4) unit (x, y, z)
    information: Float  # (m, l, l)
    pull: Float  # (m, l)
    squares: float  # sum of what is left if no light is there


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


class Evidence:
    """The map and the sides of one picture, or of one of its colour channels, beside lights that are known."""

    everywhere: Scan  # of a further light in all directions

    def __init__(
        self, values: Float32, weight: Float32, hidden_sky: Float32, sides: Sides, known: Lit, everywhere: Lit
    ) -> None:
        """values: (n, n) relative light of the table's cells, with their weights. hidden_sky: as in Templates.
        everywhere: lights in all directions. What the best of these leaves of the map is its noise.
        """
        self._sides, self._known_lights = sides, known.lights
        weight = weight.reshape(-1)
        self._cells = float(weight.sum())
        # All of the sky's light is taken for granted, and lights take from it.
        self._hidden_sky = hidden_sky
        base = np.concatenate([_slow(), hidden_sky[None], known.taken(hidden_sky), values.reshape(1, -1) + hidden_sky])
        weighted = base * weight
        moments = (weighted @ base.T).astype(np.float64)
        self._of_hidden = moments[VARIED - 1].copy()
        moments[:VARIED, :VARIED] += RIDGE * np.trace(moments[:VARIED, :VARIED]) * np.eye(VARIED)
        moments[VARIED - 1, VARIED - 1] += CELLS_A_SAMPLE * (USUAL_NOISE / HIDDEN_SIGMA) ** 2
        self._columns = np.concatenate([weighted, weight[None]]).T.reshape(SIDE, SIDE, -1)
        self._without_varied = np.linalg.inv(moments[:VARIED, :VARIED])
        self._varied = self._without_varied @ moments[:VARIED, VARIED:]
        rest = moments[VARIED:, VARIED:] - moments[VARIED:, :VARIED] @ self._varied
        self._known = _Normal(known.lights[None], rest[None, :-1, :-1], rest[None, :-1, -1], float(rest[-1, -1]))
        beside = self._with(everywhere)
        self._variance = min(self._left_by_best(beside), self._left_by_best(self._known)) / self._cells + LEAST_NOISE**2
        self._none, self._darkenings = self._explained(self._known)
        self.everywhere = self._scan(beside)

    def scanned(self, lights: Lit) -> Scan:
        """How well further lights explain the picture, one at a time."""
        return self._scan(self._with(lights))

    @property
    def darkenings(self) -> Float:
        """(l,) part of the table's light that each known light gives."""
        return np.asarray(self._darkenings[0])

    def _scan(self, beside: _Normal) -> Scan:
        log_likelihood, darkenings = self._explained(beside)
        return Scan(log_likelihood - self._none, darkenings)

    def _with(self, new: Lit) -> _Normal:
        """The known lights and each of the new ones."""
        m, count = new.shadows.count, len(self._known_lights) + 1
        mixed, squares = self._products(new)
        varied, crossed = mixed[:, :VARIED], mixed[:, VARIED:] - mixed[:, :VARIED] @ self._varied
        information = np.empty((m, count, count))
        information[:, :-1, :-1] = self._known.information
        information[:, -1, :-1] = information[:, :-1, -1] = crossed[:, :-1]
        information[:, -1, -1] = squares - ((varied @ self._without_varied) * varied).sum(axis=1)
        pull = np.column_stack([np.broadcast_to(self._known.pull, (m, count - 1)), crossed[:, -1]])
        known = np.broadcast_to(self._known_lights, (m, count - 1, 4))
        all_lights = np.concatenate([known, new.lights[:, None]], axis=1)
        return _Normal(all_lights, information, pull, self._known.squares)

    def _products(self, new: Lit) -> tuple[Float, Float]:
        """(m, .) of what each new light adds with all that is known and the map, and (m,) with itself."""
        if new.falls is not None:
            taken, columns = new.taken(self._hidden_sky), self._columns.reshape(SIDE * SIDE, -1)
            return (taken @ columns[:, :-1]).astype(np.float64), (taken * taken @ columns[:, -1]).astype(np.float64)
        # Nearly everywhere it is the sky's hidden light alone.
        sums = new.shadows.sums(self._columns)
        mixed = self._of_hidden - sums[:, :-1]
        return mixed, mixed[:, VARIED - 1] - sums[:, VARIED - 1] + sums[:, -1] * new.shadows.filled

    def _left_by_best(self, normal: _Normal) -> float:
        """Sum of squares of the map that is left by the set of lights that explains it best."""
        told = normal.information + RIDGE * self._cells * np.eye(normal.pull.shape[1])
        best = _solved(told, normal.pull).clip(0.0, 1.0)
        return float(self._left(normal, best).min(initial=normal.squares))

    def _left(self, normal: _Normal, darkenings: Float) -> Float:
        """(m,) sum of squares of the map that is left by lights of darkenings (m, l)."""
        explained = 2 * normal.pull - np.einsum("mij,mj->mi", normal.information, darkenings)
        return np.asarray(np.maximum(normal.squares - (explained * darkenings).sum(axis=1), 0.0))

    def _explained(self, normal: _Normal) -> tuple[Float, Float]:
        """(m,) log likelihood of map and sides, with each set of lights, and (m, l) their darkenings."""
        sides, prior = self._sides, 1 / DARKENING_SIGMA**2
        count = normal.pull.shape[1]
        reached = sides.reached(normal.lights)
        darkenings = np.full(normal.pull.shape, DARKENING)
        for _ in range(ROUNDS):
            spread = sides.variance(normal.lights, reached, darkenings)
            told = reached / spread[:, None] * ~sides.is_clipped
            information = normal.information / (CELLS_A_SAMPLE * self._variance)
            information = information + told @ np.swapaxes(reached, 1, 2) + prior * np.eye(count)
            pull = normal.pull / (CELLS_A_SAMPLE * self._variance) + told @ sides.residual + prior * DARKENING
            darkenings = _solved(information, pull).clip(0.0, MOST_DARKENING)
            darkenings /= np.maximum(darkenings.sum(axis=1, keepdims=True) / MOST_DARKENING, 1.0)
        left = self._left(normal, darkenings) / self._cells + LEAST_NOISE**2
        by_map = -0.5 * self._cells / CELLS_A_SAMPLE * np.log(left)
        by_sides = sides.log_likelihood(reached, darkenings, sides.variance(normal.lights, reached, darkenings))
        by_prior = -0.5 * prior * ((darkenings - DARKENING) ** 2).sum(axis=1)
        volume = 0.5 * (count * np.log(prior) - np.linalg.slogdet(information)[1])
        return by_map + by_sides + by_prior + volume, darkenings


def _solved(matrices: Float, vectors: Float) -> Float:
    """(m, l) solutions of m linear systems (m, l, l), (m, l); those of one unknown without a factorisation each."""
    if vectors.shape[1] == 1:
        return np.asarray(vectors / matrices[:, 0])
    return np.asarray(np.linalg.solve(matrices, vectors[..., None])[..., 0])


@cache
def _slow() -> Float32:
    """(6, n * n) a quadratic in the places."""
    y, x = (np.mgrid[:SIDE, :SIDE].reshape(2, -1) / (SIDE // 2) - 1).astype(np.float32)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
