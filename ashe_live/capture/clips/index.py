"""Where the frames of a clip are, read from its packets without decoding them."""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from typing import BinaryIO, Self

import av

from ashe_live.capture.container import Searched, has_decoding_times_alone, opened_container, stated_ratio, video_in

# Rounding error of a time that was computed from a frame's; no two frames are that close.
ROUNDING_S = 1e-6
# From the first frame to any other, eleven days: beyond it, a time is damage.
LONGEST_S = 1e6


@dataclass(frozen=True, slots=True)
class ClipIndex:
    """The frames in the order in which they are shown, and those at which decoding can begin."""

    pts: tuple[int, ...]  # of each frame, ascending
    keyframes: tuple[int, ...]  # indices, ascending, the first is 0
    time_base: Fraction  # seconds

    @classmethod
    def read(cls, file: BinaryIO) -> Self | None:
        """None where the packets do not tell one order of frames: streams without times, clips that were joined."""
        searched = Searched(file)
        try:
            with opened_container(searched) as container:
                stream = video_in(container)
                if stream is None or has_decoding_times_alone(container, stream):
                    return None
                packets = searched.following(container.demux(stream))
                # The last packet is empty: it only ends the decoding. Some are decoded for others and never shown. None
                # is kept, as together they are as large as the clip, or larger where it names the same bytes again.
                shown = [(each.pts, each.is_keyframe) for each in packets if each.size and not each.is_discard]
                time_base = stated_ratio(stream.time_base)
        except (av.error.FFmpegError, OSError):
            return None
        keys = {time for time, is_keyframe in shown if is_keyframe}
        decoded = [time for time, _ in shown if time is not None]
        pts = sorted(decoded)
        if len(set(pts)) < max(1, len(shown)) or pts[0] not in keys or time_base is None:
            return None
        # All that are decoded before a keyframe are shown before it, unless times begin anew there.
        if any(time in keys and time < latest for time, latest in zip(decoded, accumulate(decoded, max), strict=True)):
            return None
        if (pts[-1] - pts[0]) * time_base > LONGEST_S:
            return None
        return cls(tuple(pts), tuple(index for index, time in enumerate(pts) if time in keys), time_base)

    @property
    def duration_s(self) -> float:
        """From the first frame to the last."""
        return float((self.pts[-1] - self.pts[0]) * self.time_base)

    def frame_at(self, time_s: float) -> int:
        """The frame that is shown `time_s` after the first one: the first before it all, the last after it all."""
        pts = self.pts[0] + Fraction(time_s + ROUNDING_S) / self.time_base
        return max(0, bisect_right(self.pts, pts) - 1)

    def frame_of(self, pts: int | None) -> int | None:
        """The frame with exactly this time, if there is one."""
        at = 0 if pts is None else bisect_left(self.pts, pts)
        return at if at < len(self.pts) and self.pts[at] == pts else None

    def keyframe_before(self, frame: int) -> int:
        """The last at or before `frame`."""
        return self.keyframes[bisect_right(self.keyframes, frame) - 1]
