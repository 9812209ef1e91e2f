"""Decides when another estimate is worthwhile: if the key views show more than those of the last estimate did."""

import math
from collections.abc import Sequence

from ashe_live.core.arrays import without
from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.comparable import is_by_same_camera
from ashe_live.light.live.key_views import RENEWED_AFTER_S, span_of

EVERY_S = 0.4  # least time between two estimates
CHECKED_EVERY_S = 1.5  # time between two checks of whether a watched scene has changed
# After FUTILE estimates in a row that were no sharper, no more are made until the views' span has grown by this factor
# and this angle.
FUTILE = 3
MUCH_WIDER, MUCH_WIDER_BY_RAD = 1.5, math.radians(2)
# The views show more if their span is larger by this factor and this angle...
WIDER, WIDER_BY_RAD = 1.25, math.radians(0.5)
# ...or if a third of them, and more than one, are new, with nearly the same span.
NEW_SHARE, AS_WIDE = 1 / 3, 0.8


class Sharpening:
    """The requests made for one scene, and whether they have gained anything."""

    def __init__(self) -> None:
        self.span_rad = 0.0  # of the views of the last request
        self._views: Sequence[TrackedFrame] = ()
        self._looked_at: Sequence[TrackedFrame] = ()
        self._tells_more = False
        self._widest_rad = 0.0
        self._futile = 0
        self._asked_s = self._estimated_s = -math.inf

    @property
    def is_settled(self) -> bool:
        """Whether the last estimates have gained nothing."""
        return self._futile >= FUTILE

    def asked(self, views: Sequence[TrackedFrame], now_s: float) -> None:
        """An estimate of a frame together with these views, of which it may be one, has been requested."""
        if self._is_by_another_camera(views):
            self._widest_rad, self._futile = 0.0, 0
        self._views, self._looked_at, self._tells_more = views, views, False
        self.span_rad, self._asked_s = span_of(views), now_s
        self._widest_rad = max(self._widest_rad, self.span_rad)

    def answered(self, is_sharper: bool) -> None:
        """The requested estimate has been made; `is_sharper`: whether it improved the answer."""
        self._estimated_s = self._asked_s
        self._futile = 0 if is_sharper else self._futile + 1

    def verified(self) -> None:
        """The known light was confirmed, which counts as a new estimate."""
        self._estimated_s = self._asked_s

    def is_due_for(self, views: Sequence[TrackedFrame], now_s: float) -> bool:
        """Whether the key views show so much more than those of the last request that another is worthwhile."""
        if now_s - self._asked_s < EVERY_S:
            return False
        if views is not self._looked_at:
            self._looked_at, self._tells_more = views, self._tell_more(views)
        return self._tells_more

    def is_due_again(self, now_s: float) -> bool:
        """Whether it is time to check a watched scene again, even though the camera stands still."""
        return now_s - self._asked_s >= (CHECKED_EVERY_S if self.is_settled else EVERY_S)

    def is_up_to_date(self, now_s: float) -> bool:
        """Whether a watched scene needs another estimate only if it has changed."""
        return self.is_settled and now_s - self._estimated_s < RENEWED_AFTER_S

    def _is_by_another_camera(self, views: Sequence[TrackedFrame]) -> bool:
        """Whether the focal length has become known since, by which all that was estimated is to be made anew."""
        return len(views) > 0 and len(self._views) > 0 and not is_by_same_camera(views[-1], self._views[-1])

    def _tell_more(self, views: Sequence[TrackedFrame]) -> bool:
        if self._is_by_another_camera(views):
            return True
        span_rad = span_of(views)
        if self.is_settled:
            return span_rad >= MUCH_WIDER * self._widest_rad + MUCH_WIDER_BY_RAD
        if span_rad >= WIDER * self.span_rad + WIDER_BY_RAD:
            return True
        new = len(without(views, self._views))
        return new >= max(2, NEW_SHARE * len(views)) and span_rad >= AS_WIDE * self.span_rad
