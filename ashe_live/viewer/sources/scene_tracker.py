"""Follows a scene through the frames of a source: its marker, where that lies in the room, and its key views."""

from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.live.key_views import KeyViews
from ashe_live.tracking.marker_place import MarkerPlace
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker


class SceneTracker:
    """For use by one thread; the key views may be read by others."""

    def __init__(self, tracker: MarkerTracker, key_views: KeyViews) -> None:
        self._tracker = tracker
        self._key_views = key_views
        self._marker_place = MarkerPlace()

    def track(self, frame: Frame) -> TrackedFrame:
        """The next frame with its marker."""
        return self._marker_place.add(self._tracker.track(frame))

    def keep_view(self, tracked: TrackedFrame) -> None:
        """Keeps a frame as a view for estimates if it adds to those kept. Apart from `track`, which is waited for."""
        self._key_views.add(tracked)

    def track_with(self, preset: TrackingPreset) -> None:
        """Changes the quality from the next frame on."""
        self._tracker.preset = preset

    def follow(self, tracker: MarkerTracker) -> None:
        """Another marker, or the same by another camera, is followed from the next frame on."""
        is_same_marker = tracker.marker.spec == self._tracker.marker.spec
        self._tracker = tracker
        self._forget_scene()
        if not is_same_marker:  # a step back may lead to frames in which the one before lay elsewhere
            self._marker_place.rewind()

    def rewind(self, keeps_views: bool = False) -> None:
        """The source begins again. `keeps_views`: with the very frames that were kept, and nothing else."""
        self._tracker.reset()
        self._marker_place.rewind()
        if not keeps_views:
            self._key_views.drop()

    def jump(self) -> None:
        """The source goes on elsewhere, as after a cut."""
        self._tracker.jump()
        self._forget_scene()

    def lose(self) -> None:
        """The source was lost; what it shows when it comes back is unknown."""
        self._tracker.reset()
        self._forget_scene()

    def _forget_scene(self) -> None:
        """What has been seen cannot be compared with what comes next."""
        self._key_views.drop()
        self._marker_place.forget()
