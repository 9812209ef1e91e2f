"""The marginal likelihood of lights beside a known body: of the light on its table and on its sides.

One linear model in the lights' darkenings (`observed.py`, docs/maths, "A known body").
"""

from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.observed import BESIDE_LIGHTS, CELLS_A_SAMPLE, HIDDEN, VARIED, Effects, Lit, Observed
from ashe_live.light.known_body.table import SIDE

LEAST_NOISE = 0.02  # standard deviation of relative light that every map has
RIDGE = 1e-6  # on each light's darkening, times the map's cells: lights with one shadow would be singular
# The prior of the part of the table's light that a light gives: mean and standard deviation.
DARKENING, DARKENING_SIGMA = 0.35, 0.35
MOST_DARKENING = 0.97  # by all lights together: some light always comes from elsewhere
ROUNDS = 2  # of the sides' variances, which depend on how bright the lights are


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """How well each of m lights explains a picture, beside l others that are known."""

    log_likelihood: Float  # (m,) over that of the known ones alone
    darkenings: Float  # (m, l + 1) part of the table's light that each light would give, that of the new one last


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    """Normal equations of m sets of l lights; sets come last, as all are solved at once and each is small."""

    information: Float  # (l, l, m) of the map, without what else varies
    pull: Float  # (l, m)
    reached: Float  # (l, k, m)
    spread: Float  # (l, k, m)
    sky: Float  # (l, 3, m) what of their parts of the map looks like another sky


@dataclass(frozen=True, slots=True, eq=False)
class _Best:
    """The set of lights, of several, that explains the map best."""

    left: float  # sum of squares of the map that it leaves
    number: int  # of the set
    darkenings: Float  # (l,)


class MarginalLikelihood:
    """Of a picture, or one of its colour channels, with a further light beside those that are known.

    What each light takes from the table's light is marginalised out.
    """

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
            information[..., None],
            expected.pull[:, None],
            expected.reached.T[..., None],
            expected.spread.T[..., None],
            expected.explained[:, HIDDEN:, None],
        )
        beside = self._with(observed.everywhere)
        best = min((self._best(each) for each in (beside, self._without)), key=attrgetter("left"))
        self._variance = best.left / observed.cells + LEAST_NOISE**2
        mixed = best.darkenings[: len(known.lights)] @ taken
        if len(best.darkenings) > len(known.lights):
            new = observed.everywhere.lit
            mixed = mixed + best.darkenings[-1] * (observed.hidden_sky - new.shadows.one(best.number).ravel())
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

    def _with(self, new: Effects) -> _Normal:
        """The known lights and each of the new ones."""
        known, without = self._known, self._without
        m, count = len(new.squares), len(known.squares)
        information = np.empty((count + 1, count + 1, m))
        information[:-1, :-1], information[-1, -1] = without.information, new.squares
        if count:
            information[-1, :-1] = information[:-1, -1] = self._overlaps(new) - known.varied @ new.explained.T
        pull = np.empty((count + 1, m))
        pull[:-1], pull[-1] = without.pull, new.pull
        reached, spread = np.empty((2, count + 1, len(new.reached), m))
        reached[:-1], reached[-1] = without.reached, new.reached
        spread[:-1], spread[-1] = without.spread, new.spread
        sky = np.empty((count + 1, VARIED - HIDDEN, m))
        sky[:-1], sky[-1] = without.sky, new.explained[:, HIDDEN:].T
        return _Normal(information, pull, reached, spread, sky)

    def _overlaps(self, new: Effects) -> Float:
        """(l, m) products of the new lights' parts of the map with those of the known ones."""
        if new.lit.falls is not None:
            return (self._taken @ new.lit.taken(self._observed.hidden_sky).T).astype(np.float64)
        return np.asarray((self._known.varied[:, HIDDEN] - new.lit.shadows.sums(self._columns)).T)

    def _best(self, normal: _Normal) -> _Best:
        """The set of lights that explains the map best."""
        ridge = RIDGE * self._observed.cells * np.eye(len(normal.pull))[..., None]
        darkenings, _ = _solved(normal.information + ridge, normal.pull)
        darkenings = darkenings.clip(0.0, 1.0)
        left = self._left(normal, darkenings)
        if not len(left) or left.min() > self._observed.squares:
            return _Best(self._observed.squares, 0, np.zeros(len(darkenings)))
        best = int(left.argmin())
        return _Best(float(left[best]), best, darkenings[:, best])

    def _left(self, normal: _Normal, darkenings: Float) -> Float:
        """(m,) sum of squares of the map that is left by lights of darkenings (l, m)."""
        explained = 2 * normal.pull - (normal.information * darkenings).sum(axis=1)
        return np.asarray(np.maximum(self._observed.squares - (explained * darkenings).sum(axis=0), 0.0))

    def _explained(self, normal: _Normal) -> tuple[Float, Float]:
        """(m,) log likelihood of map and sides, with each set of lights, and (l, m) their darkenings."""
        darkenings, log_determinant = self._likeliest_darkenings(normal)
        sides, prior = self._observed.sides, 1 / DARKENING_SIGMA**2
        by_sides = sides.log_likelihood(normal.reached, darkenings, sides.variance(normal.spread, darkenings))
        by_prior = -0.5 * prior * ((darkenings - DARKENING) ** 2).sum(axis=0)
        volume = 0.5 * (len(darkenings) * np.log(prior) - log_determinant)
        return self._of_map(normal, darkenings) + by_sides + by_prior + volume, darkenings

    def _likeliest_darkenings(self, normal: _Normal) -> tuple[Float, Float]:
        """(l, m) by map, sides and prior; and (m,) the log determinant of the information on them."""
        sides, prior, reached = self._observed.sides, 1 / DARKENING_SIGMA**2, normal.reached
        variance_of_map = self._cells_a_sample * self._variance
        by_map = normal.information / variance_of_map + prior * np.eye(len(normal.pull))[..., None]
        pull_of_map = normal.pull / variance_of_map + prior * DARKENING
        darkenings = np.full(normal.pull.shape, DARKENING)
        for _ in range(ROUNDS):
            variance = sides.variance(normal.spread, darkenings)
            weighted = reached * (~sides.is_clipped[:, None] / variance)
            information = by_map + (weighted[:, None] * reached).sum(axis=2)
            pull = pull_of_map + (weighted * sides.residual[:, None]).sum(axis=1)
            if sides.by_level.any():  # the level facet's light, which all sides share, is marginalised out
                by_level = sides.by_level[:, None]
                both = (weighted * by_level).sum(axis=1)
                shared = both / sides.level_information(variance)
                information -= shared[:, None] * both
                pull -= shared * (by_level / variance * sides.residual[:, None]).sum(axis=0)
            darkenings, log_determinant = _solved(information, pull)
            darkenings = darkenings.clip(0.0, MOST_DARKENING)
            darkenings /= np.maximum(darkenings.sum(axis=0) / MOST_DARKENING, 1.0)
        return darkenings, log_determinant

    def _of_map(self, normal: _Normal, darkenings: Float) -> Float:
        """(m,) log likelihood of the map with each set of lights, of darkenings (l, m).

        The more of the light the sky gives, the less is known of what the map looks like without lights: it lies
        between the one beside lights and that under a sky which gives all light.
        """
        observed, cells = self._observed, self._observed.cells
        samples = cells / self._cells_a_sample
        left = self._left(normal, darkenings)
        beside_lights = -0.5 * samples * np.log(left / cells + LEAST_NOISE**2)
        sky = observed.sky[:, None] - (normal.sky * darkenings[:, None]).sum(axis=0)
        left_by_sky = np.maximum(left - observed.taken_by_sky(sky), 0.0)
        under_sky = -0.5 * samples * np.log(left_by_sky / cells + LEAST_NOISE**2) + observed.volume
        share = ((1 - darkenings.sum(axis=0) - BESIDE_LIGHTS) / (1 - BESIDE_LIGHTS)).clip(0.0, 1.0)
        return np.asarray(beside_lights + share * (under_sky - beside_lights))


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
