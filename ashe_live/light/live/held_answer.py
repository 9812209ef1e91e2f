"""Which of several successive answers stands: a better one replaces it, a single outlier does not, a new light does.

Answers about one scene share most of their evidence, so that averaging them would not be surer than the best of them.
Evidence is combined within the estimator, from several views; this module only decides which answer is shown.
"""

import math
from collections.abc import Sequence
from itertools import permutations

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light, LightEstimate
from ashe_live.core.transforms import angle_between, motion_between, tangent_basis
from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.moved_marker import moved_estimate
from ashe_live.light.views.in_view import share_shown

CHANGED_AFTER = 3  # consecutive answers that contradict the one held, and agree among themselves, to replace it
# As many for what contradicts it in a changed scene, but may be a hand that rests there: four seconds of the viewer's.
RESTS_NO_LONGER = 10
# 99th percentile of the chi-squared distribution with two degrees of freedom.
GATE = 9.21
# Masks change abruptly from frame to frame, and with them the light, even where each fit's covariance is small.
TOLERANCE_RAD = math.radians(2.5)
# Two lights from one direction are different if their shadow ratios differ by this factor, as when a cloud comes.
OTHER_DEPTH = 1.5
UNKNOWN_SIGMA_RAD = math.radians(10)
# An answer that is less sure than this gives way to any surer one.
DOUBTFUL = 0.5
# Assumed for an estimator that states no confidence, and for an answer without a light.
UNKNOWN_CONFIDENCE, NONE_CONFIDENCE = 0.3, 0.2
# An answer counts as sharper if its sigma is smaller by this factor, or its confidence larger by this.
SHARPER, SURER = 0.95, 0.02
# A light that is followed in single frames has moved if its offset exceeds twice its sigma by this.
MOVED_RAD = math.radians(1.0)
# An answer that is about as good replaces the held one, as it is newer and the sun moves: its sigma may be larger by
# this factor than that of the sharpest answer that agreed with it, and its confidence less by this than that of the
# surest. Both vary by as much from view to view.
AS_SHARP, AS_SURE = 1.1, 0.06
LEAST_SHOWN = 0.5  # of what an answer's frame showed of object and shadow: a frame with less says nothing of the light


class HeldAnswer:
    """The answer for one scene. Every estimate is offered to it, in the order of time."""

    def __init__(self, seen: TrackedFrame | None = None) -> None:
        """`seen`: the frame of the first answer, by which all are until `move_to` names another one."""
        self.estimate: LightEstimate | None = None
        self.is_news = False  # whether the last estimate offered was taken as a new light, or as the first answer
        self._seen = seen  # the frame whose marker it is by
        self._share_shown = 1.0  # of object and shadow, in the frame that the answer was made of
        # The answer as it was made, and where the marker lay then: by a sheet that is lifted, the real object is lost.
        self._as_made: tuple[LightEstimate, Float | None] | None = None
        self._dissent: list[LightEstimate] = []
        self._surest, self._sharpest = 0.0, math.inf  # of all answers that agreed with the held one

    @property
    def _T_room_marker(self) -> Float | None:
        return None if self._seen is None else self._seen.T_room_marker

    @property
    def is_disputed(self) -> bool:
        """Whether the latest answers contradict the held one."""
        return bool(self._dissent)

    def move_to(self, seen: TrackedFrame) -> None:
        """Takes the frame of the marker as it lies in `seen`, by which the next answer is: its light stays in the room.

        Moving the marker changes nothing else: the answer stays as sure as it was.
        """
        motion = motion_between(self._T_room_marker, seen.T_room_marker)
        self._seen = seen
        if motion is not None and self._as_made is not None and seen.marker is not None:
            made, made_at = self._as_made
            from_there = motion_between(made_at, seen.T_room_marker)
            self.estimate = made if from_there is None else moved_estimate(made, from_there, seen.marker)
            self._dissent = [moved_estimate(other, motion, seen.marker) for other in self._dissent]

    @property
    def is_shown(self) -> bool:
        """Whether the frame that the answer has been moved to shows what its light was found by, or half of that; True
        without a light.
        """
        if self.estimate is None or self._seen is None or self._seen.marker is None:
            return True
        return share_shown(self.estimate, self._seen) >= LEAST_SHOWN * self._share_shown

    def offer(self, new: LightEstimate, is_of_changed_scene: bool = False, has_lost_shadows: bool = False) -> bool:
        """Takes `new` as the answer, or not; returns whether it is sharper than the answer known before.

        `is_of_changed_scene`: whether the views show that the held answer belongs to another scene. What has changed
        may be a hand that rests there. A light is believed there at once, unless it is doubtful and contradicts one
        that was not. No light is believed at once if `has_lost_shadows`: the held answer's shadows are gone.
        """
        held = self.estimate
        self.is_news = False
        if held is None:
            return self._take(new, is_news=True)
        is_doubtful = _confidence(new) < DOUBTFUL <= _confidence(held) and not agree(held, new)
        is_clear = (new.lights or not held.lights) and not is_doubtful
        if is_of_changed_scene and (is_clear or has_lost_shadows):
            return self._take(new, is_news=True)
        if agree(held, new):
            return self._offer_agreeing(new, held)
        return self._offer_contradicting(new, held, is_of_changed_scene)

    def _offer_agreeing(self, new: LightEstimate, held: LightEstimate) -> bool:
        """As `offer`, of an answer that agrees with the held one: taken if it is about as good, as it is newer."""
        self._dissent.clear()
        is_sure = _confidence(new) >= self._surest - AS_SURE
        is_surer = _confidence(new) > self._surest + SURER
        is_sharp = _sigma(new) <= AS_SHARP * self._sharpest
        self._surest = max(self._surest, _confidence(new))
        if is_sure:
            self._sharpest = min(self._sharpest, _sigma(new))
        if not (is_sure and is_sharp):
            return False
        self._take(new, is_news=False)
        return is_surer or _sigma(new) < SHARPER * _sigma(held)

    def _offer_contradicting(self, new: LightEstimate, held: LightEstimate, is_of_changed_scene: bool) -> bool:
        """As `offer`, of one that contradicts the held one: taken once enough of these in a row agree among themselves.

        Where the scene has not changed, also at once, if it outweighs the held answer.
        """
        self._dissent = [*(other for other in self._dissent if agree(other, new)), new]
        enough = RESTS_NO_LONGER if is_of_changed_scene else CHANGED_AFTER
        outweighs = not is_of_changed_scene and _outweighs(new, held)
        if len(self._dissent) < enough and not outweighs:
            return False
        return self._take(new, is_news=True)

    def follow(self, seen: LightEstimate) -> bool:
        """Replaces the held light by `seen`, the same light in a later frame, if it has moved; returns whether it has.

        As a single frame is less precise than the views that the light was estimated from, it must have moved by more
        than the uncertainty of both.
        """
        self._dissent.clear()
        self.is_news = self.estimate is not None and _moved_rad(self.estimate, seen) > MOVED_RAD
        if self.is_news:
            self._hold(seen)
        return self.is_news

    def _take(self, new: LightEstimate, is_news: bool) -> bool:
        self._hold(new)
        self.is_news, self._dissent = is_news, []
        if is_news:
            self._surest, self._sharpest = _confidence(new), _sigma(new)
        return True

    def _hold(self, new: LightEstimate) -> None:
        self.estimate, self._as_made = new, (new, self._T_room_marker)
        seen = self._seen
        self._share_shown = 1.0 if seen is None or seen.marker is None else share_shown(new, seen)


def agree(a: LightEstimate, b: LightEstimate) -> bool:
    """Whether both may be of the same light or lights, by their number, Mahalanobis distance and shadow ratios."""
    return len(a.lights) == len(b.lights) and any(_same_lights(a.lights, order) for order in permutations(b.lights))


def _moved_rad(before: LightEstimate, now: LightEstimate) -> float:
    """The largest angle that a light has moved by, beyond twice its sigma; 0 or less for none."""
    return max(
        angle_between(a.to_light_marker, b.to_light_marker) - 2 * (a.sigma_rad or 0.0)
        for a, b in zip(before.lights, now.lights, strict=True)
    )


def _outweighs(new: LightEstimate, held: LightEstimate) -> bool:
    """Whether `new` alone replaces `held`: it is surer, and `held` was doubtful or rests on fewer views."""
    rests_on_more = len(new.views) > len(held.views) and (new.span_rad or 0.0) > (held.span_rad or 0.0)
    return (_confidence(held) < DOUBTFUL or rests_on_more) and _confidence(new) > _confidence(held)


def _same_lights(a: Sequence[Light], b: Sequence[Light]) -> bool:
    return all(_same_light(one, other) for one, other in zip(a, b, strict=True))


def _same_light(a: Light, b: Light) -> bool:
    if a.shadow_rgb_ratio is not None and b.shadow_rgb_ratio is not None:
        factor = (float(a.shadow_rgb_ratio.mean()) + 1e-3) / (float(b.shadow_rgb_ratio.mean()) + 1e-3)
        if not 1 / OTHER_DEPTH <= factor <= OTHER_DEPTH:
            return False
    if a.to_light_marker @ b.to_light_marker <= 0:
        return False
    basis = tangent_basis(a.to_light_marker + b.to_light_marker)
    offset = basis @ (a.to_light_marker - b.to_light_marker)
    spread = basis @ (_covariance(a) + _covariance(b)) @ basis.T + TOLERANCE_RAD**2 * np.eye(2)
    return float(offset @ np.linalg.solve(spread, offset)) <= GATE


def _covariance(light: Light) -> Float:
    """(3, 3) rad^2 in the marker frame, 0 along the direction: regular at the zenith, unlike azimuth and elevation."""
    basis = tangent_basis(light.to_light_marker)
    covariance = UNKNOWN_SIGMA_RAD**2 * np.eye(2) if light.covariance_rad2 is None else light.covariance_rad2
    return np.asarray(basis.T @ covariance @ basis)


def _sigma(estimate: LightEstimate) -> float:
    sigma = None if estimate.light is None else estimate.light.sigma_rad
    return UNKNOWN_SIGMA_RAD if sigma is None else sigma


def _confidence(estimate: LightEstimate) -> float:
    if estimate.light is None:
        return NONE_CONFIDENCE
    return UNKNOWN_CONFIDENCE if estimate.light.confidence is None else estimate.light.confidence
