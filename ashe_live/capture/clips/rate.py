"""How many frames a second a clip has: what it states or, where it states none, what the times of its first frames say.

Browsers record WebM without a rate, in milliseconds, for which FFmpeg guesses 1000 frames a second; and of raw DV it
gives the unit of its times as the rate. An MP4 or MOV states none: FFmpeg divides its frames by its length, and phones
give fewer frames a second in dim light, screen recorders none while nothing moves.
"""

from itertools import islice, pairwise
from pathlib import Path
from statistics import fmean, median

import av
import numpy as np
from av.video.stream import VideoStream

from ashe_live.capture.container import Searched, opened_container, video_in
from ashe_live.files.reading import opened

FALLBACK_FPS = 30.0
BARE = ("h264", "hevc")  # streams without a container: FFmpeg gives all of them 25, whatever they say
MOST_BELIEVED_FPS = 480.0  # more is measured: cameras for it are rare
FIRST_FRAMES = 100  # by which a rate is measured
LISTED_FRAMES = 20_000  # of an MP4's list that are looked at, eleven minutes of 30 frames a second
RUN_FRAMES = 25  # about a second: single frames may come early or late
FASTEST_SHARE = 0.1  # of the runs: what fewer of them have is a hiccup that is made up for
SAME_RATE = 1.01  # times the mean: an encoder's rounding
PAUSE = 1.5  # of the median: a longer time between two frames is a pause, of a screen on which nothing moves


def frames_a_second(path: Path, stream: VideoStream) -> float:
    """Nominal, of the stream of pictures of the clip at `path`."""
    is_bare = stream.container.format.name in BARE
    stated = float((is_bare and stream.codec_context.framerate) or stream.average_rate or 0)
    if 0 < stated <= MOST_BELIEVED_FPS:
        fastest = _fastest(stream)
        return fastest if stated * SAME_RATE < fastest <= MOST_BELIEVED_FPS else stated
    guessed = float(stream.guessed_rate or 0)
    return _measured(path) or (guessed if 0 < guessed <= MOST_BELIEVED_FPS else FALLBACK_FPS)


def _fastest(stream: VideoStream) -> float:
    """Where frames come fastest, by the list of their times that the container has; 0 where it has none.

    No frame is left out by that rate, and where they come more slowly each lasts for several of its periods.
    """
    listed = [each.timestamp for each in islice(stream.index_entries, LISTED_FRAMES) if not each.is_discard]
    frames = min(RUN_FRAMES, len(listed) - 1)
    if frames < 1 or not stream.time_base:
        return 0.0
    times = np.sort(listed)
    run_s = float(np.quantile(times[frames:] - times[:-frames], FASTEST_SHARE) * stream.time_base)
    return frames / run_s if run_s > 0 else 0.0


def _measured(path: Path) -> float | None:
    """By the times of the first frames; None where fewer than two have different ones."""
    with opened(path) as file:
        searched = Searched(file)
        try:
            with opened_container(searched) as container:
                stream = video_in(container)
                if stream is None or not stream.time_base:
                    return None
                packets = islice(searched.following(container.demux(stream)), FIRST_FRAMES)
                times_s = sorted({float(each.pts * stream.time_base) for each in packets if each.pts is not None})
        except (av.error.FFmpegError, OSError):
            return None
    between_s = [after - before for before, after in pairwise(times_s)]
    if not between_s:
        return None
    longest_s = PAUSE * median(between_s)
    return 1 / fmean(each for each in between_s if each <= longest_s)
