"""The estimated light, which stays in the room while the marker is moved in it."""

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.core.transforms import motion_between
from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.moved_marker import FixedInRoom, moved_estimate, moved_illumination, stays_on_plane
from ashe_live.viewer.estimates.easing import LightEasing


class RoomLight:
    """Where the light of the last estimate is, seen from the marker as it lies now, and on its way there."""

    def __init__(self) -> None:
        self.estimated = Illumination()  # in the marker's frame as it lay in the estimate's frame
        self._T_room_marker: Float | None = None  # as it lay there
        self._easing = LightEasing()
        self._fixed = FixedInRoom(self.estimated, None)  # what was asked for last
        self._tracked: TrackedFrame | None = None  # the last frame with a marker

    @property
    def has_seen_marker(self) -> bool:
        """Whether the marker has been in any frame of this source."""
        return self.estimated.seen_in is not None

    def see(self, tracked: TrackedFrame) -> None:
        """A new frame: polished surfaces mirror the first one that shows a marker, until the first estimate."""
        if tracked.marker is not None and not self.has_seen_marker:
            self.take(Illumination(seen_in=tracked), tracked)

    def take(self, estimated: Illumination, seen_in: TrackedFrame | None) -> None:
        """A new estimate, made in the frame `seen_in`; what is shown goes on from where it is in the room."""
        T_room_marker = None if seen_in is None else seen_in.T_room_marker
        motion = motion_between(self._T_room_marker, T_room_marker)
        if motion is not None and seen_in is not None and seen_in.marker is not None:
            self._easing.move(motion, seen_in.marker)
        self.estimated, self._T_room_marker = estimated, T_room_marker
        self._fixed = FixedInRoom(estimated, T_room_marker)

    def now(self, tracked: TrackedFrame | None) -> Illumination:
        """The estimated light in the frame of the marker as it lies in `tracked`."""
        return self._seen_from(tracked, self.estimated)

    def is_lifted(self, tracked: TrackedFrame) -> bool:
        """Whether the marker, in view in `tracked`, was lifted from the plane on which a light was found.

        On its own plane there is then nothing by which to find one.
        """
        if not self.estimated.lights:
            return False
        motion = motion_between(self._T_room_marker, tracked.T_room_marker)
        return motion is not None and not stays_on_plane(motion, tracked.pose.side_m)

    def seen_by(self, tracked: TrackedFrame | None, estimate: LightEstimate) -> LightEstimate:
        """The last estimate in the frame of the marker as it lies in `tracked`."""
        motion = None if tracked is None else motion_between(self._T_room_marker, tracked.T_room_marker)
        if motion is None or tracked is None or tracked.marker is None:
            return estimate
        return moved_estimate(estimate, motion, tracked.marker)

    def shown(self, tracked: TrackedFrame | None, now_s: float) -> Illumination:
        """As `now`, on its way from the estimate before."""
        return self._seen_from(tracked, self._easing.at(self.estimated, now_s))

    def jump(self, tracked: TrackedFrame | None) -> Illumination:
        """As `now`, which is shown at once."""
        return self._seen_from(tracked, self._easing.jump(self.estimated))

    def show_by_hand(self, tracked: TrackedFrame | None, by_hand: Illumination) -> Illumination:
        """Shows a light that was set by hand at once; the next one eases from it.

        It is given in the frame of the marker as it lies in `tracked`. Easing is done in that of the marker as it lay
        in the estimate, so that the light is moved there first.
        """
        shown = by_hand
        if tracked is not None and tracked.marker is not None:
            motion = motion_between(tracked.T_room_marker, self._T_room_marker)
            shown = by_hand if motion is None else moved_illumination(by_hand, motion, tracked.marker)
        self._easing.jump(shown)
        return by_hand

    def _seen_from(self, tracked: TrackedFrame | None, illumination: Illumination) -> Illumination:
        if tracked is not None and tracked.marker is not None:
            self._tracked = tracked
        if self._fixed.illumination is not illumination:
            self._fixed = FixedInRoom(illumination, self._T_room_marker)
        return self._fixed.seen_by(self._tracked)
