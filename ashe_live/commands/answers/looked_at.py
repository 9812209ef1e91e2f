"""Chooses the frame of a photo or clip that is estimated, and other views of its scene."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

from ashe_live.capture.sources import Seekable, Source
from ashe_live.core.transforms import view_direction
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.live.key_views import KeyViews, kept_size, scaled
from ashe_live.light.live.same_scene import first_of_most
from ashe_live.tracking.families.seen_instead import extreme_exposure
from ashe_live.tracking.focal_tracker import FocalTracker
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.tracking.tracker import MarkerTracker

# How much of a clip by an unknown camera is watched for its focal length before the frame is chosen.
LEARNING_S = 10.0
# How long a clip is watched for other views after the frame that is answered for, unless the user sets its end.
WATCHED_S = 10.0


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which frames of a source may be looked at."""

    views: int  # the most views, including the frame that is answered for
    estimate_at: int | None = None  # the index of that frame; None: the first one with a steady marker
    first: int = 0
    last: int | None = None


@dataclass(frozen=True, slots=True)
class LookedAt:
    """The frame that is answered for, and the other views, with markers."""

    frozen: TrackedFrame
    others: tuple[TrackedFrame, ...] = ()


def look_at(source: Source, tracker: MarkerTracker, wanted: Wanted) -> LookedAt:
    """The frame that `wanted` names, or the first one with a steady marker, with a marker at all, or else the last.

    That is the last one in which something can be seen, if there is any.
    Raises UserError when the source has no such frame.
    """
    if isinstance(tracker, FocalTracker):
        _learn_focal_length(source, tracker)
    if wanted.first and isinstance(source, Seekable):
        source.seek_frame(wanted.first)
    seen = _SeenFrames(wanted, source.is_photo)
    while not seen.are_enough and (frame := source.read()) is not None:
        if frame.index >= wanted.first:
            seen.add(tracker.track(frame))
    if seen.last is None:
        _refuse_first(source, wanted)
    if wanted.estimate_at is not None and seen.chosen is None:
        of_it = f"choose one from {wanted.first} to {seen.last.frame.index} for --estimate-at"
        raise UserError(
            f"there is no frame {wanted.estimate_at} in it",
            "it is a photo: leave --estimate-at out" if source.is_photo else of_it,
        )
    frozen = seen.chosen or seen.first_with_marker or seen.last_exposed or seen.last
    if frozen.camera is not seen.last.camera and frozen.marker is not None:
        # The focal length has been learned meanwhile, and poses of the views are measured with it.
        tracker.reset()
        frozen = tracker.track(frozen.frame)
    others = _spread(frozen, seen.key_views.views, wanted.views - 1)
    usual = first_of_most([frozen, *others])
    if wanted.estimate_at is None and usual is not frozen:
        source.rewind()
        tracker.reset()
        return look_at(source, tracker, replace(wanted, estimate_at=usual.frame.index))
    return LookedAt(frozen, others)


def renumbered(tracked: TrackedFrame, index: int, is_kept_large: bool) -> TrackedFrame:
    """The frame with this index, as a view of several files; scaled to the size of key views unless it stays large."""
    kept = tracked if is_kept_large else scaled(tracked, kept_size(tracked.frame.size))
    return replace(kept, frame=Frame(kept.frame.image_bgr, index, kept.frame.time_s))


class _SeenFrames:
    """What of a source's frames, shown one after another, an estimate may be made of."""

    def __init__(self, wanted: Wanted, is_photo: bool) -> None:
        self._wanted, self._is_photo = wanted, is_photo
        self._steadiness = Steadiness.of(is_photo)
        self.key_views = KeyViews(max(2, wanted.views))
        self.chosen: TrackedFrame | None = None  # the frame that is named, or else the first with a steady marker
        self.first_with_marker: TrackedFrame | None = None
        self.last: TrackedFrame | None = None
        self.last_exposed: TrackedFrame | None = None  # the last that is neither black nor white, as a fade's end is

    def add(self, tracked: TrackedFrame) -> None:
        self.last = tracked
        self.key_views.add(tracked)
        if self.chosen is None:
            is_steady, at = self._steadiness.add(tracked), self._wanted.estimate_at
            if is_steady if at is None else tracked.frame.index == at:
                self.chosen = tracked
        if self.first_with_marker is None and tracked.marker is not None:
            self.first_with_marker = tracked
        if tracked.marker is None and extreme_exposure(tracked.frame.image_bgr) is None:
            self.last_exposed = tracked

    @property
    def are_enough(self) -> bool:
        """Whether no later frame is of use."""
        if self.last is None:
            return False
        if self._wanted.last is not None and self.last.frame.index >= self._wanted.last:
            return True
        if self.chosen is None:
            return False
        watched_s = self.last.frame.time_s - self.chosen.frame.time_s
        is_watched = self._wanted.last is None and watched_s >= WATCHED_S
        return self._wanted.views == 1 or self._is_photo or is_watched


def _refuse_first(source: Source, wanted: Wanted) -> NoReturn:
    if not wanted.first:
        raise UserError("there is no readable picture in it", "copy or record it again")
    source.rewind()
    of_it = f"begin --frames between 0 and {sum(1 for _ in source) - 1}"
    raise UserError(
        f"there is no frame {wanted.first} in it",
        "it is a photo: leave --frames out" if source.is_photo else of_it,
    )


def _spread(frozen: TrackedFrame, views: Sequence[TrackedFrame], most: int) -> tuple[TrackedFrame, ...]:
    """At most `most` of the other views: those whose directions are nearest to the frozen frame's are left out."""
    if frozen.marker is None:
        return ()
    here = view_direction(frozen.marker.T_cam_marker)
    others = [
        (float(view_direction(view.marker.T_cam_marker) @ here), view)
        for view in views
        if view.frame.index != frozen.frame.index and view.marker is not None
    ]
    farthest = sorted(others, key=lambda pair: pair[0])[:most]
    return tuple(sorted((view for _, view in farthest), key=lambda view: view.frame.index))


def _learn_focal_length(source: Source, tracker: FocalTracker) -> None:
    """Watches a clip's beginning for as long as that may improve the focal length, then rewinds."""
    if source.is_photo:
        return
    while not tracker.is_sure and (frame := source.read()) is not None and frame.time_s <= LEARNING_S:
        tracker.track(frame)
    source.rewind()
    tracker.reset()
