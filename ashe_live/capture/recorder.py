"""Records frames as H.264 in an MP4 that phones and browsers play.

While recording, the file grows in fragments under a hidden name, so that whatever happens (a full disk, an error) what
was written so far can be played. Closing copies the packets, without encoding them again, into an MP4 whose index comes
first, and only that one gets the final name.
"""

import struct
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Self

import av
import numpy as np
from av.container import OutputContainer
from av.video.frame import VideoFrame
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc, Interpolation
from av.video.stream import VideoStream

from ashe_live.core.arrays import Image
from ashe_live.core.output_files import cannot_write, check_output, partial_name
from ashe_live.errors import UserError

TICKS_PER_S = 90_000
# Constant quality: 18 looks lossless, 23 is x264's default.
CRF = 20
PRESET = "veryfast"
KEYFRAME_EVERY_S = 2
BOX_HEADER = struct.Struct(">I4s")  # of what MP4 files consist of: length in bytes with this header, kind
# The plain conversion darkens every colour by 1.5 levels; rounding rightly costs 0.4 ms at 640x480.
CONVERSION = Interpolation.BILINEAR | Interpolation.ACCURATE_RND


class Recorder:
    """Writes frames of one size to a new clip; a context manager, which finishes the clip also after an exception."""

    def __init__(self, path: str | Path, size: tuple[int, int], fps: float, overwrite: bool = False) -> None:
        """`size` is (width, height) in pixels of the frames to come; an odd last column or row is left out.

        `fps` is nominal: it paces frames without a time. Raises UserError when `path` exists (without `overwrite`),
        is not an .mp4, or its folder is missing or not writable; ValueError for a size or rate that no clip has.
        """
        self.path = Path(path)
        self.frame_count = 0
        self._size = size
        self._even_size = (size[0] // 2 * 2, size[1] // 2 * 2)
        if min(self._even_size) < 2 or not fps > 0:
            raise ValueError(f"a clip cannot have frames of {size} at {fps} a second")
        if self.path.suffix.lower() != ".mp4":
            raise UserError(f"{self.path} is not named as an MP4 file", "let its name end in .mp4")
        check_output(self.path, overwrite)
        self._partial = partial_name(self.path)
        self._ticks_per_frame = max(1, round(TICKS_PER_S / fps))
        self._last_pts = -self._ticks_per_frame
        self._start_s: float | None = None
        self._container: OutputContainer | None = None
        try:
            self._partial.write_bytes(b"")
            self._container = av.open(
                str(self._partial),
                "w",
                options={"movflags": "frag_keyframe+empty_moov+default_base_moof", "flush_packets": "1"},
            )
            self._stream = self._add_h264(self._container, fps)
        except (OSError, av.error.FFmpegError) as error:
            self._partial.unlink(missing_ok=True)
            raise cannot_write(self.path, error) from error

    def write(self, image_bgr: Image, time_s: float | None = None) -> None:
        """Appends (h, w, 3) uint8, shown from `time_s` on a clock of the caller's; None: one frame period later.

        The clip begins with its first frame. Raises ValueError for another size, a time before the last frame's or a
        closed recorder; UserError when the disk or the encoder fails: what came before is then saved and the recorder
        closed.
        """
        if self._container is None:
            raise ValueError(f"the recording {self.path} is closed")
        if image_bgr.shape != (self._size[1], self._size[0], 3) or image_bgr.dtype != np.uint8:
            raise ValueError(f"a frame of {image_bgr.shape} {image_bgr.dtype} in a recording of {self._size}")
        pts = self._pts(time_s)
        width, height = self._even_size
        picture = VideoFrame.from_numpy_buffer(np.ascontiguousarray(image_bgr[:height, :width]), "bgr24").reformat(
            format="yuv420p",
            dst_colorspace=Colorspace.ITU709,
            dst_color_range=ColorRange.MPEG,
            interpolation=CONVERSION,
            threads=1,
        )
        picture.pts, picture.duration = pts, self._ticks_per_frame
        picture.time_base = Fraction(1, TICKS_PER_S)
        try:
            self._container.mux(self._stream.encode(picture))
        except (OSError, av.error.FFmpegError) as error:
            self._save_and_raise(error)
        self._last_pts = pts
        self.frame_count += 1

    def close(self) -> None:
        """Finishes the clip; without frames no file is left. May be called twice. Raises UserError as `write` does."""
        if self._container is None:
            return
        try:
            if self.frame_count:
                self._container.mux(self._stream.encode(None))
            self._release()
            if self.frame_count:
                self._index_first()
        except (OSError, av.error.FFmpegError) as error:
            self._save_and_raise(error)
        self._partial.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _add_h264(self, container: OutputContainer, fps: float) -> VideoStream:
        # Without B-frames: encoded in the order shown, so that no time has to be shifted.
        options = {"preset": PRESET, "crf": str(CRF), "bf": "0"}
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1001), options=options)
        codec = stream.codec_context
        codec.width, codec.height = self._even_size
        codec.pix_fmt = "yuv420p"
        codec.time_base = Fraction(1, TICKS_PER_S)
        codec.gop_size = max(1, round(KEYFRAME_EVERY_S * fps))
        # One thread, as the viewer needs the others.
        codec.thread_count = 1
        codec.colorspace, codec.color_range = Colorspace.ITU709, ColorRange.MPEG
        codec.color_primaries, codec.color_trc = ColorPrimaries.BT709, ColorTrc.BT709
        return stream

    def _pts(self, time_s: float | None) -> int:
        """In ticks from the first frame, later than the last."""
        if time_s is None:
            return self._last_pts + self._ticks_per_frame
        if self._start_s is None:
            self._start_s = time_s - max(0, self._last_pts + self._ticks_per_frame) / TICKS_PER_S
        pts = round((time_s - self._start_s) * TICKS_PER_S)
        if pts < self._last_pts:
            raise ValueError(f"a frame at {time_s} s comes before the last one")
        return max(pts, self._last_pts + 1)

    def _index_first(self) -> None:
        """Copies the fragments' packets into an MP4 with the index in front, and gives that the final name.

        Where there is no room for a second copy the fragments, which can be played too, get it.
        """
        finished = self._partial.with_name(f".{self.path.stem}.finished.mp4")
        try:
            with (
                av.open(str(self._partial)) as fragments,
                av.open(str(finished), "w", options={"movflags": "faststart"}) as clip,
            ):
                template = fragments.streams.video[0]
                stream = clip.add_stream_from_template(template)
                for packet in fragments.demux(template):
                    # The last packet is empty: there is no decoder here that it could flush.
                    if packet.dts is not None:
                        packet.stream = stream
                        clip.mux(packet)
            finished.replace(self.path)
        except (OSError, av.error.FFmpegError):
            self._partial.replace(self.path)
        finally:
            finished.unlink(missing_ok=True)

    def _save_and_raise(self, error: Exception) -> None:
        """Keeps the fragments written so far under the final name, if any is whole. Raises UserError always."""
        # Closing fails for the same reason as what brought us here.
        with suppress(OSError, av.error.FFmpegError):
            self._release()
        failure = cannot_write(self.path, error)
        if salvaged(self._partial):
            self._partial.replace(self.path)
            failure = UserError(f"{failure.message}; the first part of the recording is saved", failure.remedy)
        self._partial.unlink(missing_ok=True)
        raise failure from error

    def _release(self) -> None:
        container, self._container = self._container, None
        if container is not None:
            container.close()


def salvaged(path: Path) -> bool:
    """Whether it is a clip, or the beginning of one that broke off, of which at least one picture can be decoded.

    A fragment's header that is not whole is cut off: readers refuse all that comes before it as well.
    """
    try:
        _cut_off_broken_header(path)
        with av.open(str(path)) as clip:
            return next(clip.decode(video=0), None) is not None
    except (OSError, av.error.FFmpegError, IndexError):
        return False


def _cut_off_broken_header(path: Path) -> None:
    """Whatever ends beyond the file, unless it is a fragment's pictures: the whole ones of those can be played."""
    size, end = path.stat().st_size, 0
    with path.open("r+b") as file:
        while end < size:
            file.seek(end)
            header = file.read(BOX_HEADER.size)
            length, kind = BOX_HEADER.unpack(header) if len(header) == BOX_HEADER.size else (0, b"")
            if length < BOX_HEADER.size or end + length > size:
                if kind != b"mdat":
                    file.truncate(end)
                return
            end += length
