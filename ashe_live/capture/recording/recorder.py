"""Records frames as H.264 in an MP4 that phones and browsers play.

While recording, the file grows in fragments under a hidden name, so that whatever happens (a full disk, an error, a
killed process) what was written so far can be played. Closing it makes a clip of it (fragments.py), and only that one
gets the final name.
"""

from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Self

import av
import numpy as np
from av.video.frame import VideoFrame

from ashe_live.capture.container import WrittenContainer
from ashe_live.capture.recording.encoding import Encoding, added_stream, converted, even_size
from ashe_live.capture.recording.fragments import IN_THE_MAKING, made_playable, published
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.new_file import NewFile, cannot_write
from ashe_live.process.signals import signals_held

TICKS_PER_S = 90_000
# Constant quality: 18 looks lossless, 23 is x264's default.
CRF = 20
PRESET = "veryfast"
PIXELS = "yuv420p"
KEYFRAME_EVERY_S = 2
MAX_FPS = 1000.0  # of a clip that states a rate; more is a damaged header


class Recorder:
    """Writes frames of one size to a new clip; a context manager, which finishes the clip also after an exception."""

    def __init__(self, path: str | Path, size: tuple[int, int], fps: float, overwrite: bool = False) -> None:
        """`size` is (width, height) in pixels of the frames to come; an odd last column or row is left out.

        `fps` is nominal: how long the last frame is shown, and how often a keyframe comes. Raises UserError when `path`
        exists (without `overwrite`), is not an .mp4, or its folder is missing or not writable, and for pictures of less
        than 2 pixels a side, which H.264 does not have; ValueError for a rate that no clip has.
        """
        self.path = Path(path)  # once closed, where the clip is: beside a file that has appeared there meanwhile
        self.frame_count = 0
        self._size = size
        if not 0 < fps < float("inf"):
            raise ValueError(f"a clip cannot have {fps} frames a second")
        self._even_size = even_size(size)
        if self.path.suffix.lower() != ".mp4":
            raise UserError(f"{self.path} is not named as an MP4 file", "let its name end in .mp4")
        fps = min(fps, MAX_FPS)
        self._last_pts = -1
        self._start_s: float | None = None  # the first frame's time
        self._written: WrittenContainer | None = None
        self._fragments = NewFile(self.path, overwrite, is_recoverable=True)
        try:
            # Nobody hears of what a signal's handler raises within FFmpeg's calls of Python.
            with signals_held():
                self._begin(fps)
        except BaseException as error:
            self._fragments.discard()
            if isinstance(error, OSError | av.error.FFmpegError):
                raise cannot_write(self.path, error) from error
            raise

    def write(self, image_bgr: Image, time_s: float) -> None:
        """Appends (h, w, 3) uint8, shown from `time_s` on, by a clock of the caller's.

        The clip begins with its first frame; one that comes before the last in time is shown right after it. Raises
        ValueError for another size or a closed recorder; UserError when the disk or the encoder fails: what came before
        is then saved and the recorder closed.
        """
        if self._written is None:
            raise ValueError(f"the recording {self.path} is closed")
        if image_bgr.shape != (self._size[1], self._size[0], 3) or image_bgr.dtype != np.uint8:
            raise ValueError(f"a frame of {image_bgr.shape} {image_bgr.dtype} in a recording of {self._size}")
        pts = self._pts(time_s)
        width, height = self._even_size
        whole = np.ascontiguousarray(image_bgr[:height, :width])
        picture = converted(VideoFrame.from_numpy_buffer(whole, "bgr24"), PIXELS)
        picture.pts = pts
        picture.time_base = Fraction(1, TICKS_PER_S)
        try:
            with signals_held():
                self._written.container.mux(self._stream.encode(picture))
                self._last_pts = pts
                self.frame_count += 1
                self._written.check()
        except (OSError, av.error.FFmpegError) as error:
            self._save_and_raise(error)

    def close(self) -> None:
        """Finishes the clip; without frames no file is left. May be called twice. Raises UserError as `write` does.

        Signals wait until that is done.
        """
        if self._written is None:
            return
        with signals_held():
            try:
                if self.frame_count:
                    self._written.container.mux(self._stream.encode(None))
                self._release()
                if self.frame_count:
                    self.path = published(self._fragments, self.frame_count)
            except (OSError, av.error.FFmpegError) as error:
                self._save_and_raise(error)
            self._fragments.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self, fps: float) -> None:
        self._written = WrittenContainer(
            self._fragments.stream, {"movflags": "frag_keyframe+empty_moov+default_base_moof", "flush_packets": "1"}
        )
        container = self._written.container
        container.metadata["comment"] = IN_THE_MAKING
        # Without B-frames: encoded in the order shown, so that no time has to be shifted.
        encoding = Encoding("libx264", PIXELS, TICKS_PER_S, {"preset": PRESET, "crf": str(CRF), "bf": "0"})
        self._stream = added_stream(container, encoding, self._even_size, fps)
        self._stream.codec_context.gop_size = max(1, round(KEYFRAME_EVERY_S * fps))
        # At once, as it is by its header that an abandoned recording is known.
        container.start_encoding()
        self._written.check()

    def _pts(self, time_s: float) -> int:
        """In ticks from the first frame, later than the last."""
        if self._start_s is None:
            self._start_s = time_s
        return max(round((time_s - self._start_s) * TICKS_PER_S), self._last_pts + 1)

    def _save_and_raise(self, error: Exception) -> None:
        """Keeps the fragments written so far under the final name, if any is whole. Raises UserError always."""
        # Closing fails for the same reason as what brought us here.
        with suppress(OSError, av.error.FFmpegError):
            self._release()
        failure = cannot_write(self.path, error)
        with suppress(OSError):
            if made_playable(self._fragments.stream):
                self.path = self._fragments.publish_or_keep()
                saved = f"{failure.message}; the first part of the recording is saved as {self.path}"
                failure = UserError(saved, failure.remedy)
        self._fragments.discard()
        raise failure from error

    def _release(self) -> None:
        written, self._written = self._written, None
        if written is not None:
            written.close()
