"""A recorded clip as a source, decoded by FFmpeg through PyAV.

PyAV and not OpenCV: it tells each frame's exact time and whether it is damaged, and a damaged packet is not the end.
Both decode alike; OpenCV saves one copy, 0.1 to 0.4 ms a frame at 640x480.
"""

from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
from av.container import InputContainer
from av.video.frame import VideoFrame
from av.video.reformatter import Colorspace
from av.video.stream import VideoStream

from ashe_live.capture.sources import Source, check_readable
from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame
from ashe_live.errors import UserError

FALLBACK_FPS = 30.0
# A second decoding thread is taken from the renderer, so only frames too large for one get it.
ONE_THREAD_PIXELS = 1_000_000
# FFmpeg's number for "the clip does not say".
UNSPECIFIED_MATRIX = 2
HD_HEIGHT_PX = 720
# By how much the duration that a whole clip states may exceed its frames.
TOLERATED_GAP_FRAMES = 2


class ClipSource(Source):
    """Every readable frame of a clip, upright as the phone held it, at its own time."""

    is_live = False
    is_photo = False

    def __init__(self, path: str | Path) -> None:
        """Opens the clip and decodes its first frame. Raises UserError when there is none."""
        self._path = Path(path)
        check_readable(self._path)
        self.name = self._path.name
        self._container: InputContainer | None = None
        self._pictures: Iterator[VideoFrame] = iter(())
        self._next: VideoFrame | None = None
        self.rewind()

    def rewind(self) -> None:
        # Opened anew: seeking to the start is inexact in some containers and impossible in others.
        self.close()
        self.note: str | None = None
        self._index = 0
        self._damaged = 0
        try:
            self._container = av.open(str(self._path), metadata_errors="replace")
            self._stream = self._container.streams.video[0]
            if self._stream.codec_context is None:  # whatever the stub says: of a codec that FFmpeg does not know
                raise IndexError
        except (av.error.FFmpegError, OSError, IndexError):
            self.close()
            raise UserError(f"{self._path} is not a clip that can be read", "convert it to MP4 (H.264)") from None
        self.fps = float(self._stream.average_rate or self._stream.guessed_rate or FALLBACK_FPS)
        codec = self._stream.codec_context
        codec.thread_count = 1 if codec.width * codec.height <= ONE_THREAD_PIXELS else 2
        codec.thread_type = "FRAME"
        self._pictures = self._decode(self._container, self._stream)
        self._next = next(self._pictures, None)
        if self._next is None:
            self.close()
            raise UserError(f"{self._path} has no readable picture in it", "copy or record it again")
        self._decoded_size = (self._next.width, self._next.height)
        self._start_pts = self._next.pts
        self.size = self._decoded_size[::-1] if _quarter_turns(self._next) % 2 else self._decoded_size

    def read(self) -> Frame | None:
        picture, self._next = self._next or next(self._pictures, None), None
        if picture is None:
            self._note_what_is_missing()
            return None
        frame = Frame(self._upright_bgr(picture), self._index, self._time_s(picture))
        self._index += 1
        self._end_pts = (picture.pts or 0) + (picture.duration or 0)
        return frame

    def close(self) -> None:
        self._pictures, self._next = iter(()), None
        if self._container is not None:
            self._container.close()
        self._container = None

    def _decode(self, container: InputContainer, stream: VideoStream) -> Iterator[VideoFrame]:
        packets = container.demux(stream)
        while True:
            try:
                # The packet after the last one is empty and fetches what the decoder still holds.
                packet = next(packets, None)
                pictures = packet.decode() if packet is not None else None
            except EOFError:
                return
            except av.error.FFmpegError:
                self._damaged += 1
                continue
            if pictures is None:
                return
            for picture in pictures:
                assert isinstance(picture, VideoFrame)
                if picture.is_corrupt:
                    self._damaged += 1
                else:
                    yield picture

    def _time_s(self, picture: VideoFrame) -> float:
        if picture.pts is None or self._start_pts is None or picture.time_base is None:
            return self._index / self.fps
        return float((picture.pts - self._start_pts) * picture.time_base)

    def _upright_bgr(self, picture: VideoFrame) -> Image:
        """(h, w, 3) uint8 of the source's size."""
        matrix = None
        if picture.colorspace == UNSPECIFIED_MATRIX:
            # What players assume.
            matrix = Colorspace.ITU709 if picture.height >= HD_HEIGHT_PX else Colorspace.ITU601
        width, height = self._decoded_size
        image = picture.to_ndarray(format="bgr24", width=width, height=height, src_colorspace=matrix, threads=1)
        return np.ascontiguousarray(np.rot90(image, _quarter_turns(picture)))

    def _note_what_is_missing(self) -> None:
        if self._damaged or self._ends_early():
            self.note = f"{self.name} is truncated or damaged: only {self._index} frames could be read"

    def _ends_early(self) -> bool:
        """A clip cut between two packets is no error to FFmpeg, but its index promises more than came."""
        if self._container is None or not self._stream.duration or not self._stream.time_base:
            return False
        missing = self._stream.duration - (self._end_pts - (self._start_pts or 0))
        return float(missing * self._stream.time_base) > TOLERATED_GAP_FRAMES / self.fps


def _quarter_turns(picture: VideoFrame) -> int:
    """Anticlockwise, as rot90 counts them; a damaged file may ask for any angle."""
    return round(picture.rotation / 90)
