"""A recorded clip as a source that can seek and step back."""

from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import av.error
import numpy as np
from av.video.frame import VideoFrame
from av.video.reformatter import Colorspace

from ashe_live.capture.clips.index import ClipIndex
from ashe_live.capture.clips.pictures import ClipPictures, Picture
from ashe_live.capture.clips.refusals import unknown_colours
from ashe_live.capture.sources import Source
from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame
from ashe_live.files.reading import opened

# FFmpeg's number for "the clip does not say".
UNSPECIFIED_MATRIX = 2
HD_HEIGHT_PX = 720
# Decoded pictures are kept up to this size, so that stepping back is as fast as stepping on: 46 of 1280x720.
KEPT_BYTES = 64_000_000
# Of a browser's clip ten minutes, whose frames are listed in half a second.
QUICKLY_READ_BYTES = 200_000_000
BYTES_PER_PIXEL = 1.5  # of decoded pictures in 4:2:0, as most cameras encode


class ClipSource(Source):
    """Every readable frame of a clip, upright as the phone held it, at its own time."""

    is_live = False
    is_photo = False

    def __init__(self, path: str | Path) -> None:
        """Opens the clip and decodes its first frame. Raises UserError when there is none, or not in known colours."""
        self.path = Path(path)
        self.name = self.path.name
        self._pictures: ClipPictures | None = None
        self._index: ClipIndex | None = None
        self._has_looked_for_index = False
        self._latest_s: float | None = None  # of the pictures that were read since it was opened
        self._has_reached_end = False
        self._is_irregular = False  # damaged, or out of order, in any part that was read since it was opened
        self._behind: deque[Picture] = deque()  # pictures that were read or passed, the latest last
        self._ahead: deque[Picture] = deque()  # pictures that are read next, before any other is decoded
        self.rewind()
        self._upright_bgr(self._ahead[0].video)
        # Without a length there is no time bar: browsers write none, and no recorder that was killed.
        if self.duration_s is None and self.path.stat().st_size <= QUICKLY_READ_BYTES:
            self._trusted_index()

    def rewind(self) -> None:
        # Opened anew: seeking to the start is inexact in some containers and impossible in others.
        self.close()
        self.note: str | None = None
        self._pictures = ClipPictures(self.path)
        self._to_srgb = self._pictures.to_srgb
        first = self._pictures.first
        self._ahead.append(first)
        self._decoded_size = self._pictures.size
        self._mirrored, self._quarter_turns = _as_shown(first.video)
        self.size = self._decoded_size[::-1] if self._quarter_turns % 2 else self._decoded_size
        self.fps = self._pictures.fps
        self.duration_s = self._pictures.stated_duration_s() if self._index is None else self._index.duration_s
        self._lengthen()
        self._kept = max(2, int(KEPT_BYTES / (BYTES_PER_PIXEL * first.video.width * first.video.height)))

    def read(self) -> Frame | None:
        picture = self._next()
        if picture is None:
            self._note_what_is_missing()
            return None
        return Frame(self._upright_bgr(picture.video), picture.index, picture.time_s)

    def seek(self, time_s: float) -> None:
        """The next frame read is the one shown at `time_s`: the first before all, the last after all.

        Decoding begins at the keyframe before it, or at the start where the clip does not tell its frames' times.
        """
        index = self._trusted_index()
        if index is not None:
            self.seek_frame(index.frame_at(time_s))
            # Where that one is damaged, as the last of a clip that was cut, the next one is, or none.
            if self._decoded_next() is not None and self._trusted_index() is not None:
                return
        while self._behind and self._behind[-1].time_s > time_s:
            self._ahead.appendleft(self._behind.pop())
        if not self._behind:
            self.rewind()
        while (picture := self._next()) is not None and picture.time_s <= time_s:
            pass
        if self._behind:  # the last one that is not too late, or the first
            self._back_to(self._behind[-1 if picture is None else max(-2, -len(self._behind))].index)

    def seek_frame(self, index: int) -> None:
        """The next frame read is number `index`, or the end when there is none.

        Frames have the numbers that they have when all are read; after damage that was jumped over, larger ones.
        """
        index, clip_index = max(0, index), self._trusted_index()
        keyframe = 0 if clip_index is None else clip_index.keyframe_before(index)
        self._back_to(index)
        if keyframe <= self._upcoming <= index:
            self._pass_until(index)
            return
        self._jump(keyframe)
        passed = self._pass_until(index)
        if clip_index is not None and passed is not None and clip_index.frame_of(passed.video.pts) != passed.index:
            self.rewind()
            self._pass_until(index)

    def pass_over(self, is_shown: Callable[[float], bool]) -> bool:
        """As Seekable says: a picture of 4K takes 25 ms more than to decode it, and one of HDR 125 ms."""
        picture = self._decoded_next()
        if picture is None or is_shown(picture.time_s):
            return False
        self._next()
        if self._decoded_next() is not None:
            return True
        self._back_to(picture.index)
        return False

    def close(self) -> None:
        self._behind.clear()
        self._ahead.clear()
        if self._pictures is not None:
            self._is_irregular |= self._pictures.contradicts_index
            self._pictures.close()
        self._pictures = None

    @property
    def _upcoming(self) -> int:
        """The index of what is read next."""
        if self._ahead:
            return self._ahead[0].index
        return 0 if self._pictures is None else self._pictures.decoded

    def _decoded_next(self) -> Picture | None:
        """What is read next; None at the end."""
        if not self._ahead and self._pictures is not None:
            if (picture := self._pictures.next()) is not None:
                self._ahead.append(picture)
                self._latest_s = max(picture.time_s, self._latest_s or 0.0)
            self._has_reached_end |= picture is None
            self._lengthen()
        return self._ahead[0] if self._ahead else None

    def _lengthen(self) -> None:
        """Of clips that were joined only the first's length is stated, and none of a stream without times."""
        stated_s, latest_s = self.duration_s, self._latest_s
        if latest_s is not None and (self._has_reached_end if stated_s is None else latest_s > stated_s):
            self.duration_s = latest_s

    def _next(self) -> Picture | None:
        """Passes on to the next picture."""
        picture = self._decoded_next()
        if picture is not None:
            self._ahead.popleft()
            self._behind.append(picture)
            if len(self._behind) > self._kept:
                self._behind.popleft()
        return picture

    def _pass_until(self, index: int) -> Picture | None:
        """Returns the last picture passed; `index` comes next."""
        passed = None
        while self._upcoming < index and (picture := self._next()) is not None:
            passed = picture
        return passed

    def _back_to(self, index: int) -> None:
        """Steps back over the pictures that are kept, to `index` or as near as they reach."""
        while self._behind and self._behind[-1].index >= index:
            self._ahead.appendleft(self._behind.pop())

    def _jump(self, keyframe: int) -> None:
        """To a frame at which decoding can begin, or to the start where the clip cannot."""
        self._behind.clear()
        self._ahead.clear()
        landed = None
        if keyframe > 0 and self._index is not None and self._pictures is not None:
            landed = self._pictures.jump(self._index, keyframe)
        if landed is None:
            self.rewind()
        else:
            self._ahead.append(landed)

    def _trusted_index(self) -> ClipIndex | None:
        """Read when it is first needed; None where counting from the start is the only way."""
        if not self._has_looked_for_index:
            self._has_looked_for_index = True
            with opened(self.path) as file:
                index = ClipIndex.read(file)
            if index is not None and self._pictures is not None and index.pts[0] == self._pictures.start_pts:
                self._index, self.duration_s = index, index.duration_s
        is_irregular = self._is_irregular or (self._pictures is not None and self._pictures.contradicts_index)
        return None if is_irregular else self._index

    def _upright_bgr(self, picture: VideoFrame) -> Image:
        """(h, w, 3) uint8 of the source's size. Raises UserError where FFmpeg does not know how it stores colours."""
        matrix = None
        if picture.colorspace == UNSPECIFIED_MATRIX:
            # What players assume.
            matrix = Colorspace.ITU709 if picture.height >= HD_HEIGHT_PX else Colorspace.ITU601
        width, height = self._decoded_size
        try:
            image = picture.to_ndarray(format="bgr24", width=width, height=height, src_colorspace=matrix, threads=1)
        except (av.error.OSError, av.error.ArgumentError):
            self.close()
            raise unknown_colours(self.path) from None
        if self._to_srgb is not None:
            image = self._to_srgb(np.asarray(image, dtype=np.uint8))
        if self._mirrored:
            image = image[:, ::-1]
        return np.ascontiguousarray(np.rot90(image, self._quarter_turns))

    def _note_what_is_missing(self) -> None:
        pictures = self._pictures
        if pictures is not None and pictures.has_other_shapes:
            self.note = (
                f"{self.name} changes the shape of its pictures: only the {pictures.decoded} of the first are shown"
            )
        elif pictures is not None and (pictures.damaged or pictures.ends_early()):
            self.note = f"{self.name} is truncated or damaged: only {pictures.decoded} frames could be read"


def _as_shown(picture: VideoFrame) -> tuple[bool, int]:
    """Whether it is to be mirrored left to right, and its quarter turns after that, anticlockwise as rot90 counts them.

    By its display matrix (ISO/IEC 14496-12, 6.2.2); a damaged file may ask for any angle.
    """
    mirrored = False
    matrix: Any = picture.side_data.get("DISPLAYMATRIX")  # whatever the stub says of its type
    if matrix is not None:
        a, b, _, c, d = np.frombuffer(matrix, np.int32)[:5].astype(float)
        mirrored = bool(a * d < b * c)
    # FFmpeg's angle is that of the first column, which mirroring turns round.
    return mirrored, round((picture.rotation + 180 * mirrored) / 90)
