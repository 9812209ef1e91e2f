"""Records what is drawn over the video, with its transparency, for programs that put it over something else."""

from fractions import Fraction
from pathlib import Path
from typing import NamedTuple, Self

import av
import numpy as np
from av.video.frame import VideoFrame

from ashe_live.capture.container import WrittenContainer
from ashe_live.capture.recording.encoding import Encoding, added_stream, converted, even_size
from ashe_live.capture.recording.recorder import MAX_FPS, TICKS_PER_S
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.new_file import NewFile, cannot_write
from ashe_live.process.signals import signals_held


class Format(NamedTuple):
    """A kind of clip with transparency."""

    muxer: str  # FFmpeg's name
    encoding: Encoding


FORMATS = {
    ".mov": Format("mov", Encoding("prores_ks", "yuva444p10le", TICKS_PER_S, {"profile": "4444", "vendor": "apl0"})),
    # As good as H.264 at the recorder's own quality; of a picture at a time, as the viewer's frames come.
    # A second of WebM has no finer ticks than milliseconds.
    ".webm": Format(
        "webm",
        Encoding("libvpx-vp9", "yuva420p", 1000, {"crf": "24", "b": "0", "deadline": "realtime", "cpu-used": "6"}),
    ),
}


class TransparentRecorder:
    """Writes pictures of one size to a new clip; a context manager. If the disk or the encoder fails, no file is left.

    What else ends it before its time leaves a whole clip of what was written until then.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float, overwrite: bool = False) -> None:
        """`size` (width, height); an odd last column or row is left out. Raises UserError as Recorder does."""
        self.path = path  # once closed, where the clip is: beside a file that has appeared there meanwhile
        self.frame_count = 0
        found = FORMATS.get(path.suffix.lower())
        if found is None:
            raise UserError(
                f"{path} is no clip with transparency", "let its name end in .mov (ProRes 4444) or .webm (VP9)"
            )
        self._format = found
        self._even_size = even_size(size)
        self._last_pts = -1
        self._has_failed = False
        self._file = NewFile(path, overwrite)
        try:
            with signals_held():
                self._begin(min(fps, MAX_FPS))
        except BaseException as error:
            self._file.discard()
            if isinstance(error, OSError | av.error.FFmpegError):
                raise cannot_write(path, error) from error
            raise

    def write(self, image_bgra: Image, time_s: float) -> None:
        """Appends (h, w, 4) uint8 sRGB, straight alpha, shown from `time_s` on. Raises UserError where it cannot."""
        width, height = self._even_size
        # Whole where nothing is seen: an encoder spends nothing on what is hidden.
        seen = np.where(image_bgra[:height, :width, 3:] > 0, image_bgra[:height, :width], 0)
        picture = converted(
            VideoFrame.from_ndarray(np.ascontiguousarray(seen), format="bgra"), self._format.encoding.pixels
        )
        ticks_per_s = self._format.encoding.ticks_per_s
        self._last_pts = picture.pts = max(round(time_s * ticks_per_s), self._last_pts + 1)
        picture.time_base = Fraction(1, ticks_per_s)
        try:
            with signals_held():
                self._written.container.mux(self._stream.encode(picture))
                self._written.check()
            self.frame_count += 1
        except (OSError, av.error.FFmpegError) as error:
            self._has_failed = True  # what a full disk has refused will not be finished either
            self._file.discard()
            raise cannot_write(self.path, error) from error

    def close(self) -> None:
        """Finishes the clip; without pictures no file is left. Raises UserError where it cannot."""
        with signals_held():
            try:
                if self.frame_count:
                    self._written.container.mux(self._stream.encode(None))
                self._written.close()
                if self.frame_count:
                    self.path = self._file.publish(beside=True)
            except (OSError, av.error.FFmpegError) as error:
                raise cannot_write(self.path, error) from error
            finally:
                self._file.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if not self._has_failed:
            self.close()

    def _begin(self, fps: float) -> None:
        self._written = WrittenContainer(self._file.stream, {}, self._format.muxer)
        self._stream = added_stream(self._written.container, self._format.encoding, self._even_size, fps)
