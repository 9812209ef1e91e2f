"""A tracker that learns its camera's focal length from the marker that it follows."""

import dataclasses
import math
from collections.abc import Callable

from ashe_live.core.camera import FOCAL_SIGMA, Camera, Size
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.tracking.families.layout import Layout
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.focal.focal import FOUND_SIGMA, KNOWN_SIGMA, MUCH_SURER, FocalEstimate, FocalEstimator
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.tracking.focal.focal_view import focal_of_view
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker

# Views that are asked one by one for the focal length, as for a photo; then it takes several at once.
VIEWS_ASKED = 3
# A photo that was cut out of a larger one states that one's angle of view, and a lens may have been zoomed since its
# focal length was remembered. Neither is believed where the marker's perspective tells a focal length that is so many
# standard deviations of both from it.
DOUBTED = 4.0
# What is remembered is borne out by an estimate of this run that is so sure, and agrees: by a fifth no lens was zoomed.
BORNE_OUT_SIGMA = 0.04
CUT = "the focal length in its EXIF data does not fit the marker, as when a photo was cut: it is not used"


class FocalTracker(MarkerTracker):
    """Starts with an assumed camera, or a remembered one; changes it seldom: each change moves the model a little."""

    def __init__(
        self,
        marker: Marker | Layout,
        assumed: Callable[[Size], Camera],
        side_m: float,
        preset: TrackingPreset,
        memory: FocalMemory | None = None,
    ) -> None:
        """As MarkerTracker; `memory` is where this camera's focal length is recalled from and kept."""
        super().__init__(marker, self._known_or_assumed, side_m, preset)
        self._assumed = assumed
        self._memory = memory
        self._known: FocalEstimate | None = None
        self._is_remembered = False  # whether it is of an earlier run, and has not been borne out by this one
        self._stated: Camera | None = None
        self._views_asked = 0
        self._estimator: FocalEstimator | None = None

    def track(self, frame: Frame) -> TrackedFrame:
        """As MarkerTracker.track; a focal length learned from this frame serves from the next one on."""
        tracked = super().track(frame)
        is_measured = tracked.marker is not None and not tracked.marker.bridged
        if is_measured and tracked.camera is self._stated and self._is_contradicted(tracked.camera):
            self._stated = None
            self.use_camera(self._known_or_assumed(frame.size))
            tracked = dataclasses.replace(super().track(frame), note=CUT)
        if is_measured and tracked.camera.source == "assumed" and self._views_asked < VIEWS_ASKED:
            self._views_asked += 1
            tracked = self._with_focal_of_view(tracked)
        if not self.is_sure:
            self._learn_from(tracked)
        return tracked

    @property
    def is_sure(self) -> bool:
        """Whether the focal length is known so well that nothing more is learned."""
        return self._known is not None and not self._is_remembered and self._known.relative_sigma <= FOUND_SIGMA

    def use_stated(self, camera: Camera) -> None:
        """The focal length that pictures state is used until the marker contradicts it, or gives a surer one."""
        self._stated = camera

    def _with_focal_of_view(self, tracked: TrackedFrame) -> TrackedFrame:
        """`tracked`, or the frame tracked anew if the marker's perspective gives a surer focal length than assumed."""
        found = focal_of_view(self._sightings, tracked.camera, self.side_m)
        if found is None or found.relative_sigma > MUCH_SURER * FOCAL_SIGMA["assumed"]:
            return tracked
        self._known = found
        self.use_camera(found.camera())
        return dataclasses.replace(super().track(tracked.frame), note=tracked.note)

    def _is_contradicted(self, stated: Camera) -> bool:
        """Whether the marker's perspective, with as vague a prior as for any camera, implies another focal length.

        The prior is around the stated one, or around the usual one where the perspective says much more than that: far
        from the truth, what is stated leaves no way there.
        """
        focal_px = float(stated.K[0, 0])
        around_it = Camera.from_focal(stated.size, focal_px, "assumed")
        for prior, least_sure in ((around_it, math.inf), (Camera.assumed(stated.size), MUCH_SURER)):
            found = focal_of_view(self._sightings, prior, self.side_m)
            if found is None or found.relative_sigma > least_sure * FOCAL_SIGMA["assumed"]:
                continue
            if _contradicts(found, focal_px, FOCAL_SIGMA["exif"]):
                return True
        return False

    def _known_or_assumed(self, size: Size) -> Camera:
        """For frames of another size than before: nothing has been learned from them."""
        self._known = None if self._memory is None else self._memory.recall(size)
        self._is_remembered = self._known is not None
        self._estimator, self._views_asked = FocalEstimator(size), 0
        if self._known is not None:
            return self._known.camera()
        return self._assumed(size) if self._stated is None or self._stated.size != size else self._stated

    def _is_better(self, new: FocalEstimate, camera: Camera) -> bool:
        """Whether what several views say is worth a change of `camera`; one view takes bent paper for perspective."""
        share = 1.0 if self._known is not None and self._known.views == 1 else MUCH_SURER
        most = share * camera.focal_sigma_px / float(camera.K[0, 0])
        return new.relative_sigma <= (min(most, KNOWN_SIGMA) if camera.source == "assumed" else most)

    def _learn_from(self, tracked: TrackedFrame) -> None:
        assert self._estimator is not None
        new = self._estimator.add(tracked)
        if new is None or not (self._replaces_remembered(new) or self._is_better(new, tracked.camera)):
            return
        self._known = new
        self.use_camera(new.camera())
        if self._memory is not None:
            self._memory.keep(new)

    def _replaces_remembered(self, new: FocalEstimate) -> bool:
        """Compares an estimate of this run with what is remembered, until it bears that out or contradicts it.

        Returns whether it does the latter, as when the lens was zoomed since; then what was remembered is forgotten.
        """
        if not self._is_remembered or self._known is None or self._memory is None:
            return False
        known, is_sure = self._known, new.relative_sigma <= KNOWN_SIGMA
        is_wrong = is_sure and _contradicts(new, known.focal_px, known.relative_sigma)
        if is_wrong:
            self._memory.forget(new.size)
        self._is_remembered = not is_wrong and new.relative_sigma > BORNE_OUT_SIGMA
        return is_wrong


def _contradicts(found: FocalEstimate, focal_px: float, relative_sigma: float) -> bool:
    """Whether an estimate says that a focal length with this uncertainty is wrong."""
    away = abs(math.log(found.focal_px / focal_px))
    return away > DOUBTED * math.hypot(found.relative_sigma, relative_sigma)
