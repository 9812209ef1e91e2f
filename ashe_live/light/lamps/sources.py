"""A light's place from all evidence: the borders of one or more objects with their shadows, and the fall of light."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.lamps.fall.fall_off import FallOff, Pull
from ashe_live.light.lamps.lamp_borders import lamp_borders
from ashe_live.light.lamps.place import LAMPS_NEARNESS, Place, combined, place_by_borders
from ashe_live.light.shape.directions import (
    FittedLight,
    direction_by_displacement,
    information_on_displacement,
    with_hemisphere_prior,
)
from ashe_live.light.shape.layout import lamp_parameters
from ashe_live.light.shape.light_points import cast_on_ground

MOST_SHARE, LEAST_SHARE = 0.98, 0.02  # of all light on the plane that is a light's
NEAREST = 20.0  # 1/m, nearness of a lamp 5 cm above the plane: a nearer one is taken to be there
STARTS = (0.0, 0.3, 0.7, 1.2, 2.0, 3.5, 6.0, 10.0)  # 1/m, nearnesses from which the search begins
# Standard deviations of the nearness by the fall of light, relative to it, by `ashe-live bench fit-lamps`. The first is
# added to the noise and unevenness that `FallOff` allows for, and stands for wrong labels: true ones need none. The
# second is that by all causes, for where it is not estimated from case to case.
FALL_ERROR_SHARE, WHOLE_ERROR_SHARE = 0.10, 0.19
ROUNDS, SETTLED = 12, 1e-3  # Gauss-Newton steps at most, and the size of one that ends them
# Limits of one step: of the nearness in 1/m, and as a fraction of it; of the displacement over the distance per height.
LARGEST_STEP, LARGEST_SHARE, LARGEST_SHIFT = 0.4, 0.3, 0.5
NO_PULL = Pull(np.zeros(3), np.zeros((3, 3)), 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class SeenObject:
    """An object with its shadow, and how certain the direction of its first light is."""

    explanation: Explanation
    probability: float  # that it is right
    covariance_rad2: Float  # (2, 2) of all causes, on the direction's tangent basis
    # Factor on the variance of a nearness by steps of light, or by the borders of several views: their errors are
    # correlated along borders, as those of directions are. Other sources of the nearness are weighted against that.
    overdispersion: float

    @property
    def place(self) -> Place:
        """Where the first light is, by this object's borders."""
        fitted = FittedLight(self.explanation.lights[0].light, self.covariance_rad2)
        borders = lamp_borders(self.explanation)[0]
        if self.explanation.nearness is not None or self.explanation.alignment.elsewhere:
            borders = replace(borders, nearness_sigma=math.sqrt(self.overdispersion) * borders.nearness_sigma)
        return place_by_borders(fitted, borders)

    @property
    def as_sun(self) -> FittedLight:
        """The first light, if it is at infinity, with the covariance of all causes."""
        fitted = FittedLight(self.explanation.lights[0].light, self.covariance_rad2)
        if not fitted.is_lamp:
            return fitted
        # A lamp's direction at the marker is not that in which the object sees it.
        displacement = self.place.at_infinity[:2]
        slope = direction_by_displacement(displacement)
        covariance = np.linalg.inv(information_on_displacement(fitted))
        return FittedLight(np.append(displacement, (1.0, 0.0)), slope @ covariance @ slope.T)


@dataclass(frozen=True, slots=True, eq=False)
class PlaceEvidence:
    """All evidence on where the first light of the first object is."""

    objects: Sequence[SeenObject]
    ratios: Sequence[Float]  # (3,) the shadow ratio of each light of the first object, linear RGB
    fall_off: FallOff | None
    glints: Sequence[Place] = ()  # by that light's mirror images

    @property
    def first(self) -> Explanation:
        """That of the object whose light it is."""
        return self.objects[0].explanation

    @property
    def by_borders(self) -> Place:
        """Where the light is by all objects' borders and mirror images: by all but the fall of light."""
        return combined([*(each.place for each in self.objects), *self.glints])

    def with_fall(self, by_others: Place) -> Place:
        """Where the light is by the fall of light, and by others."""
        if self.fall_off is None:
            return by_others
        return with_fall_off(by_others, self.fall_off, *_beside(self.first, self.ratios), shadow_middle(self.first))

    def pull_at(self, at: Float) -> Pull:
        """The fall of light's pull near the first light's parameters (3,); none where that is not known."""
        if self.fall_off is None:
            return NO_PULL
        others, shares = _beside(self.first, self.ratios)
        return self.fall_off.pull(np.vstack([at, others]), shares, shadow_middle(self.first))


def place_by_all(seen: PlaceEvidence) -> Place:
    """Where the light is."""
    return seen.with_fall(seen.by_borders)


def place_by_the_rest(seen: PlaceEvidence, about: Place) -> Place:
    """Where the light is if what was taken for the first object's shadow is none: by the others and the fall of light.

    about: the place if it is one.
    """
    anywhere = anywhere_about(about, seen.first.lit.body.frame.origin_marker)
    return seen.with_fall(combined([anywhere, *(each.place for each in seen.objects[1:])]))


def anywhere_about(place: Place, object_marker: Float) -> Place:
    """A light of which nothing is known: on the hemisphere that an object sees, as near as lamps are.

    place: the mean of that wide distribution. object_marker: (2,) metres, about where the object stands.
    """
    line = np.column_stack([np.eye(2), -object_marker])
    from_object = np.append(line @ place.mean, (1.0, 0.0))
    information = line.T @ with_hemisphere_prior(np.zeros((2, 2)), from_object[None]) @ line
    information[2, 2] += 1 / LAMPS_NEARNESS**2
    return Place(place.mean, np.asarray(information))


def place_seen_from_a_sun(seen: PlaceEvidence) -> Place:
    """As `place_by_all`, to first order about a light at infinity: its nearness has the variance that a sun's has.

    About a near lamp the fall of light is steep, and seems to determine a nearness that unevenness alone may have
    suggested; so whether there is a lamp at all is tested here (Rao's score test).
    """
    by_borders = seen.by_borders
    as_sun = by_borders.at_infinity
    pull = seen.pull_at(as_sun)
    gradient = by_borders.information @ (by_borders.mean - as_sun) + pull.gradient
    information = by_borders.information + pull.information
    return Place(as_sun + np.linalg.solve(information, gradient), information)


def deviance_of_sun(seen: PlaceEvidence, place: Place) -> float:
    """By how much a sun costs more than the light at `place`, if unevenness is at its worst.

    Twice the log of a likelihood ratio. Straight below a lamp its light falls by the distance's square alone, which is
    not seen about a light at infinity (`place_seen_from_a_sun`).
    """
    by_borders = seen.by_borders

    def cost_at(at: Float) -> float:
        offset = at - by_borders.mean
        return float(offset @ by_borders.information @ offset) + seen.pull_at(at).worst_cost

    return cost_at(by_borders.at_infinity) - cost_at(place.mean)


def shadow_middle(explanation: Explanation) -> Float:
    """(2,) the middle of the first light's shadow on the plane, where the shadow ratio was measured."""
    lit = explanation.lit
    middle = np.array([[*lit.body.frame.origin_marker, lit.body.middle_m]])
    cast = cast_on_ground(middle, lit.lights[0])
    return np.asarray((middle if cast is None else cast)[0, :2])


def with_fall_off(
    by_borders: Place, fall_off: FallOff, others: Float, shares: Sequence[float], reference: Float
) -> Place:
    """The borders' place moved to where the fall of light pulls it, by Gauss-Newton steps of limited length."""
    line, variance = by_borders.by_nearness, by_borders.covariance[2, 2]

    def cost_at(nearness: float) -> float:
        offset = nearness - by_borders.mean[2]
        there = np.vstack([by_borders.mean + line * offset, others])
        return fall_off.pull(there, shares, reference).cost + float(offset**2 / variance)

    start = min(STARTS, key=cost_at)
    at = by_borders.mean + line * (start - by_borders.mean[2])
    information = by_borders.information
    for number in range(ROUNDS):
        gradient, by_fall = _tempered(fall_off.pull(np.vstack([at, others]), shares, reference), line, at[2])
        information = by_fall + by_borders.information
        step = np.linalg.solve(information, gradient + by_borders.information @ (by_borders.mean - at))
        reach = max(LARGEST_STEP, LARGEST_SHARE * abs(at[2])) / max(abs(step[2]), 1e-9)
        wide = LARGEST_SHIFT * math.hypot(1, *at[:2]) / max(math.hypot(*step[:2]), 1e-9)
        at = at + min(1.0, reach, wide) * step * (1.0 if 2 * number < ROUNDS else 0.5)
        at[2] = np.clip(at[2], -NEAREST, NEAREST)
        if np.abs(step).max() < SETTLED:
            break
    return Place(at, information)


def _tempered(pull: Pull, line: Float, nearness: float) -> tuple[Float, Float]:
    """(3,) gradient and (3, 3) information of a pull, less what a further error of the nearness along `line` leaves."""
    along = pull.information @ line
    left = 1 / ((FALL_ERROR_SHARE * nearness) ** 2 + 1e-12) + float(line @ along)
    return pull.gradient - along * float(line @ pull.gradient) / left, pull.information - np.outer(along, along) / left


def _beside(explanation: Explanation, ratios: Sequence[Float]) -> tuple[Float, list[float]]:
    """(l - 1, 3) parameters of the lights beside the first; each light's share of all light on the plane."""
    others = np.array([lamp_parameters(each.light) for each in explanation.lights[1:]]).reshape(-1, 3)
    shares = np.array([share_of(ratio) for ratio in ratios])
    return others, (shares * min(MOST_SHARE / shares.sum(), 1.0)).tolist()


def share_of(ratio: Float) -> float:
    """A light's share of all light on the plane, by the shadow ratio (3,) where it is blocked."""
    return float(np.clip(1 - ratio.mean(), LEAST_SHARE, MOST_SHARE))
