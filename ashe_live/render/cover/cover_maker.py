"""Has covers of the marker's sheet made, one after another.

A cover is made once, and anew for another scene or light, and once the camera has come so much nearer, or moved so far
around, that the old one would show. Where pictures do not wait for it, a draft comes before the first.
"""

import math
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import same_objects
from ashe_live.core.light import Illumination
from ashe_live.core.square import side_lengths_px
from ashe_live.core.transforms import lies_elsewhere, view_direction
from ashe_live.core.types import TrackedFrame
from ashe_live.render.cover.ground_cover import GroundCover, ground_cover
from ashe_live.render.cover.hidden_by_body import TURNED_RAD

NEARER = 1.5  # the cover is made anew once the marker appears this many times as large, as it then lacks detail
TURNED_COS = np.cos(np.radians(30.0))  # and once the camera has turned by this, as the ground's relief looks different
OTHER_LIGHT_COS = math.cos(math.radians(10.0))  # answers about one light are mostly nearer to each other
LEFT_ALONE_S = 0.6  # time of the video after which the hand that has moved the sheet has let it go
RETRIED_S = 1.0  # time of the video after which another attempt follows one that failed


@dataclass(frozen=True, slots=True, eq=False)
class MadeCover:
    """A cover, and what it was made from."""

    cover: GroundCover
    tracked: TrackedFrame
    illumination: Illumination

    def is_elsewhere(self, tracked: TrackedFrame) -> bool:
        """Whether the sheet has been moved since, so that other ground is around it."""
        return lies_elsewhere(self.tracked.T_room_marker, tracked.T_room_marker, tracked.pose.side_m)

    def is_in_other_light(self, tracked: TrackedFrame, illumination: Illumination) -> bool:
        """Whether the sheet lies in another light now, which is not told from things before it."""
        return not self.is_elsewhere(tracked) and _is_other_light(illumination, self.illumination)

    def serves(self, tracked: TrackedFrame, illumination: Illumination) -> bool:
        """Whether another one made from this frame would be no better."""
        was, now = self.tracked.pose, tracked.pose
        if self.cover.is_draft or was.side_m != now.side_m:
            return False
        if self.is_elsewhere(tracked) or not _is_same_scene(illumination, self.illumination):
            return False
        is_nearer = side_lengths_px(now.corners_px).max() > NEARER * side_lengths_px(was.corners_px).max()
        least_cos = TURNED_COS if now.body is None else np.cos(TURNED_RAD)
        turned = view_direction(was.T_cam_marker) @ view_direction(now.T_cam_marker) < least_cos
        return not (is_nearer or turned)


class CoverMaker:
    """The newest cover, and the thread that makes the next."""

    def __init__(self) -> None:
        self.made: MadeCover | None = None
        self.followed: TrackedFrame | None = None  # the frame seen last
        self._thread: ThreadPoolExecutor | None = None
        self._coming: Future[GroundCover | None] | None = None
        self._asked_for: tuple[TrackedFrame, Illumination] | None = None
        self._seen_lit_by: Illumination | None = None
        self._failed: tuple[TrackedFrame, Illumination] | None = None  # what no cover could be made from
        self._moved_s = -math.inf  # time of the video at which the sheet was moved last

    @property
    def is_settled(self) -> bool:
        """Whether no cover is being made."""
        return self._coming is None

    def take(self, tracked: TrackedFrame, illumination: Illumination, waits: bool) -> None:
        """Takes a cover that is ready; `waits` for one that is being made for this scene."""
        if self.followed is not None and self.followed.T_room_marker is not tracked.T_room_marker:
            self._moved_s = tracked.frame.time_s
        self.followed = tracked
        if self._coming is None:
            return
        assert self._asked_for is not None
        if waits and _is_same_scene(illumination, self._asked_for[1]):
            wait([self._coming])  # it is there sooner than another one would be
        if self._coming.done():
            coming, self._coming = self._coming, None
            self._accept(coming.result())

    def make(self, tracked: TrackedFrame, illumination: Illumination, waits: bool, is_touched: bool) -> None:
        """Makes a cover where one is called for: another thread does, unless the picture `waits`.

        `is_touched`: something lies before the sheet that would become a part of a cover made now.
        """
        steady = self._seen_lit_by is not None and _is_same_scene(illumination, self._seen_lit_by)
        self._seen_lit_by = illumination
        # While a light eases to another one, or the sheet is moved, each frame has one of its own.
        lies_still = abs(tracked.frame.time_s - self._moved_s) >= LEFT_ALONE_S
        is_time = self.made is None or (lies_still and (steady or waits))
        if not is_time or self._failed_just_now(tracked, illumination, steady or waits):
            return
        if not self._is_due(tracked, illumination, is_touched):
            return
        if waits:
            self._coming, self._asked_for = None, (tracked, illumination)
            self._accept(ground_cover(tracked, illumination))
        elif self._coming is None:
            self._thread = self._thread or ThreadPoolExecutor(1, "ground cover")
            is_draft = self.made is None or self.made.is_elsewhere(tracked)
            self._asked_for = tracked, illumination
            self._coming = self._thread.submit(ground_cover, tracked, illumination, is_draft)

    def forget(self) -> None:
        """There is no cover until another one is made: one that is still being made is not taken."""
        self._coming = self.made = self._seen_lit_by = self._failed = None

    def release(self) -> None:
        if self._thread is not None:
            self._thread.shutdown(wait=True, cancel_futures=True)
        self._thread = None
        self.forget()

    def _accept(self, cover: GroundCover | None) -> None:
        assert self._asked_for is not None
        if cover is None:
            self._failed = self._asked_for
        else:
            self.made, self._failed = MadeCover(cover, *self._asked_for), None

    def _failed_just_now(self, tracked: TrackedFrame, illumination: Illumination, is_lasting: bool) -> bool:
        """Whether no other attempt is worth it yet. In another light it is at once, as a photo's time stands still."""
        if self._failed is None:
            return False
        then, lit = self._failed
        is_soon = 0 <= tracked.frame.time_s - then.frame.time_s < RETRIED_S
        return is_soon and not (is_lasting and not _is_same_scene(illumination, lit))

    def _is_due(self, tracked: TrackedFrame, illumination: Illumination, is_touched: bool) -> bool:
        if self.made is None:
            return True
        if is_touched and not self.made.is_in_other_light(tracked, illumination):
            return False
        return not self.made.serves(tracked, illumination)


def _is_same_scene(one: Illumination, other: Illumination) -> bool:
    """Whether one cover serves both: the same light on the same things, seen in the same frame, hence of one source."""
    if one.seen_in is not other.seen_in or one.real_object is not other.real_object:
        return False
    return same_objects(one.lights, other.lights)


def _is_other_light(one: Illumination, other: Illumination) -> bool:
    """Whether there are more or fewer lights, or one is elsewhere, by the same frame of the marker."""
    if len(one.lights) != len(other.lights):
        return True
    pairs = zip(one.lights, other.lights, strict=True)
    return any(a.to_light_marker @ b.to_light_marker < OTHER_LIGHT_COS for a, b in pairs)
