"""What the capture thread and the main thread tell each other: immutable values, never seen half changed."""

from dataclasses import dataclass

from ashe_live.light.live.key_views import KeyViews
from ashe_live.process.mailbox import LatestMailbox
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.viewer.sources.tracked_frames import AS_AT_FIRST, Following, TrackedFrames


@dataclass(frozen=True, slots=True)
class ClipPosition:
    """A frame of a clip."""

    time_s: float
    index: int | None = None  # None: the frame that is shown at `time_s`


FIRST_FRAME = ClipPosition(0.0, 0)


@dataclass(frozen=True, slots=True, eq=False)
class Jump:
    """A request to continue elsewhere. Compared by identity, because the same place may be asked for twice."""

    position: ClipPosition
    rewinds: bool = False  # to the first frame, with the tracker reset


@dataclass(frozen=True, slots=True)
class Wish:
    """All current requests to the capture thread. A new wish replaces the previous one, even if not yet carried out."""

    loop: bool
    paused: bool = False
    speed: float = 1.0  # times a clip's own pace
    jump: Jump | None = None  # the latest; carried out once
    tracking: TrackingPreset | None = None  # from the next frame on; None: the preset that the tracker was made with
    following: Following = AS_AT_FIRST  # from the next frame on


@dataclass(frozen=True, slots=True)
class State:
    """The state that the capture thread reports; only that thread replaces it."""

    shown: ClipPosition = FIRST_FRAME  # the last frame that was handed over
    at: ClipPosition = FIRST_FRAME  # the same, or the frame that a jump leads to
    obeyed: Jump | None = None  # the latest jump that was carried out
    has_ended: bool = False  # a clip has been played to its end
    status: str | None = None  # a message for the user about the source
    asked_s: float | None = None  # when the current read began, monotonic clock; None: no read is in progress


@dataclass(frozen=True, slots=True, eq=False)
class Exchange:
    """What the capture thread shares with the one that started it."""

    wishes: LatestMailbox[Wish]
    frames: TrackedFrames
    key_views: KeyViews
