"""Records what is drawn over the video, with its transparency, for programs that put it over something else."""

from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

import av
import numpy as np
from av.video.frame import VideoFrame
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc
from av.video.stream import VideoStream

from ashe_live.capture.container import WrittenContainer
from ashe_live.capture.recording.recorder import CONVERSION, TICKS_PER_S
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.new_file import NewFile, cannot_write
from ashe_live.process.signals import signals_held


class Format(NamedTuple):
    """How FFmpeg names a kind of clip with transparency."""

    muxer: str
    encoder: str
    pixels: str
    options: dict[str, str]


FORMATS = {
    ".mov": Format("mov", "prores_ks", "yuva444p10le", {"profile": "4444", "vendor": "apl0"}),
    # As good as H.264 at the recorder's own quality; of a picture at a time, as the viewer's frames come.
    ".webm": Format("webm", "libvpx-vp9", "yuva420p", {"crf": "24", "b": "0", "deadline": "realtime", "cpu-used": "6"}),
}
MILLISECONDS = 1000  # a second of WebM has no finer ticks


class TransparentRecorder:
    """Writes pictures of one size to a new clip; a context manager. What fails leaves no file."""

    def __init__(self, path: Path, size: tuple[int, int], fps: float, overwrite: bool = False) -> None:
        """`size` (width, height); an odd last column or row is left out. Raises UserError as Recorder does."""
        self.path = path  # once closed, where the clip is: beside a file that has appeared there meanwhile
        self.frame_count = 0
        if path.suffix.lower() not in FORMATS:
            raise UserError(
                f"{path} is no clip with transparency", "let its name end in .mov (ProRes 4444) or .webm (VP9)"
            )
        self._format = FORMATS[path.suffix.lower()]
        self._size = size[0] // 2 * 2, size[1] // 2 * 2
        if min(self._size) < 2:
            raise UserError(f"pictures of {size[0]}x{size[1]} cannot be recorded", "give a --size of 2x2 or more")
        self._ticks_per_s = MILLISECONDS if path.suffix.lower() == ".webm" else TICKS_PER_S
        self._last_pts = -1
        self._file = NewFile(path, overwrite)
        try:
            with signals_held():
                self._begin(fps)
        except BaseException as error:
            self._file.discard()
            if isinstance(error, OSError | av.error.FFmpegError):
                raise cannot_write(path, error) from error
            raise

    def write(self, image_bgra: Image, time_s: float) -> None:
        """Appends (h, w, 4) uint8 sRGB, straight alpha, shown from `time_s` on. Raises UserError where it cannot."""
        width, height = self._size
        # Whole where nothing is seen: an encoder spends nothing on what is hidden.
        seen = np.where(image_bgra[:height, :width, 3:] > 0, image_bgra[:height, :width], 0)
        picture = VideoFrame.from_ndarray(np.ascontiguousarray(seen), format="bgra").reformat(
            format=self._format.pixels,
            dst_colorspace=Colorspace.ITU709,
            dst_color_range=ColorRange.MPEG,
            interpolation=CONVERSION,
            threads=1,
        )
        self._last_pts = picture.pts = max(round(time_s * self._ticks_per_s), self._last_pts + 1)
        picture.time_base = Fraction(1, self._ticks_per_s)
        try:
            with signals_held():
                self._written.container.mux(self._stream.encode(picture))
                self._written.check()
            self.frame_count += 1
        except (OSError, av.error.FFmpegError) as error:
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

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if isinstance(error, UserError):  # what a full disk has refused will not be finished either
            self._file.discard()
            return
        self.close()

    def _begin(self, fps: float) -> None:
        self._written = WrittenContainer(self._file.stream, {}, self._format.muxer)
        stream = self._written.container.add_stream(
            self._format.encoder, rate=Fraction(fps).limit_denominator(1001), options=self._format.options
        )
        assert isinstance(stream, VideoStream)
        codec = stream.codec_context
        codec.width, codec.height = self._size
        codec.pix_fmt = self._format.pixels
        codec.time_base = Fraction(1, self._ticks_per_s)
        codec.thread_count = 1  # as the viewer needs the others
        codec.colorspace, codec.color_range = Colorspace.ITU709, ColorRange.MPEG
        codec.color_primaries, codec.color_trc = ColorPrimaries.BT709, ColorTrc.BT709
        self._stream = stream
