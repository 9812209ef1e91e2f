"""A clip's pictures as FFmpeg decodes them through PyAV, numbered and timed.

PyAV and not OpenCV: it tells each frame's exact time and whether it is damaged, and a damaged packet is not the end.
Both decode alike; OpenCV saves one copy, 0.1 to 0.4 ms a frame at 640x480.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import av
from av.container import InputContainer
from av.video.frame import VideoFrame
from av.video.stream import VideoStream

from ashe_live.capture.clips.deinterlacing import progressive
from ashe_live.capture.clips.index import LONGEST_S, ClipIndex
from ashe_live.capture.clips.rate import frames_a_second
from ashe_live.capture.clips.refusals import begins_as_mp4, cut_short, no_clip, sound_alone, without_picture
from ashe_live.capture.clips.square_pixels import with_square_pixels
from ashe_live.capture.clips.wide_gamut import srgb_converter
from ashe_live.capture.container import (
    Searched,
    has_decoding_times_alone,
    opened_container,
    stated_end_s,
    stated_length,
    stated_ratio,
    video_in,
)
from ashe_live.capture.sources import refuse_too_large
from ashe_live.errors import UserError
from ashe_live.files.jpeg import why_endless
from ashe_live.files.reading import opened

# A second decoding thread is taken from the renderer, so only frames too large for one get it.
ONE_THREAD_PIXELS = 1_000_000
# How often a picture is jumped to, from an earlier keyframe each time, before the clip is read from its start.
JUMPS = 3
# The duration that an undamaged clip states may exceed its frames by this many.
TOLERATED_GAP_FRAMES = 2
# Whose decoders begin with any picture, as a change of plain grey: MPEG-4 part 2 and its kin, as old cameras' AVI.
OUT_OF_GREY = ("mpeg4", "msmpeg4v1", "msmpeg4v2", "msmpeg4v3", "h263", "h263p", "flv", "wmv1", "wmv2")
SAME_SHAPE = 0.02  # of pictures' sides' ratio: nearer is an encoder's rounding to whole blocks

# The end of a picture's data, and the trailer: GIF89a, 16 and 27.
GIF_END = b"\x00\x3b"


@dataclass(frozen=True, slots=True)
class Picture:
    """One that could be decoded."""

    video: VideoFrame
    index: int  # of those that could be decoded
    time_s: float  # since the clip's first one


class ClipPictures:
    """Every readable picture of a clip, in the order in which they are shown."""

    def __init__(self, path: Path) -> None:
        """Opens the clip and decodes its first picture. Raises UserError when there is none."""
        self._file = opened(path)
        self.damaged = 0  # packets and pictures that could not be read, and pictures of another shape
        self.has_other_shapes = False
        self._first_size: tuple[int, int] | None = None  # as decoded
        self._has_keyframe = False  # at or before the latest picture
        self._is_woven = False  # whether any picture was of two fields
        self.decoded = 0  # pictures, which gives the next one's index
        self._last_bytes = b""  # of the last packet
        self._latest_s = 0.0  # of the pictures since the start or the last jump
        self._is_in_order = True  # whether none of them is stamped with a time before that of the last
        self._searched = Searched(self._file)
        try:
            self._container: InputContainer = opened_container(self._searched)
        except (av.error.FFmpegError, OSError):
            is_begun = begins_as_mp4(self._file)
            self._file.close()
            raise (cut_short(path) if is_begun else no_clip(path)) from None
        try:
            self._stream = _stream_of_pictures(path, self._container)
            codec = self._stream.codec_context
            has_stated_size = codec.width > 0 and codec.height > 0  # FFmpeg takes a size beyond the limit for none
            self.fps = frames_a_second(path, self._stream)
            codec.thread_count = 1 if codec.width * codec.height <= ONE_THREAD_PIXELS else 2
            codec.thread_type = "FRAME"
            self._has_decoding_times = has_decoding_times_alone(self._container, self._stream)
            self.to_srgb = srgb_converter(codec.color_primaries, codec.color_trc)  # None: its colours are sRGB's
            self._videos = progressive(self._decoded(self._container, self._stream))
            first = next(self._videos, None)
            if first is None:
                raise without_picture(path, has_stated_size)
            aspect = stated_ratio(self._stream.sample_aspect_ratio)
            self.size = with_square_pixels((first.width, first.height), aspect)
            refuse_too_large(path, self.size)
        except UserError:
            self.close()
            raise
        self.start_pts = self._stamp(first)
        self.first = self._numbered(first)

    @property
    def contradicts_index(self) -> bool:
        """Whether frames have other numbers or times than in the index, which has damaged ones and times as stamped."""
        return self.damaged > 0 or not self._is_in_order

    def next(self) -> Picture | None:
        """The one after the last, at first after `first`; None at the end."""
        video = next(self._videos, None)
        return None if video is None else self._numbered(video)

    def jump(self, index: ClipIndex, keyframe: int) -> Picture | None:
        """Goes on from picture number `keyframe`, which it returns; None, and lost, where the container cannot."""
        damaged = self.damaged
        # A picture of two fields is made of the one before it as well.
        begin = keyframe - 1 if self._is_woven else keyframe
        for _ in range(JUMPS):
            if begin < 0:
                break
            begin = index.keyframe_before(begin)
            landed = self._landed(index.pts[begin], index.pts[keyframe])
            # Those before a keyframe lean on what was not decoded: broken, or not there at all.
            self.damaged = damaged
            if landed is not None:
                self.decoded, self._latest_s = keyframe, 0.0
                return self._numbered(landed)
            # MPEG's streams are searched by the times of decoding, and lead to the keyframe after the one asked for.
            begin -= 1
        return None

    def _landed(self, begin_pts: int, wanted_pts: int) -> VideoFrame | None:
        try:
            self._container.seek(begin_pts, stream=self._stream)
        except (av.error.FFmpegError, OSError):
            return None
        self._videos = progressive(self._decoded(self._container, self._stream))
        lacks_one_before = self._is_woven
        for video in self._videos:
            if video.pts is not None and video.pts >= wanted_pts:
                return video if video.pts == wanted_pts and not lacks_one_before else None
            lacks_one_before = False
        return None

    def stated_duration_s(self) -> float | None:
        """From the first picture to the last, as the file has it."""
        if self._stream.duration and self._stream.time_base:
            stated_s = float(self._stream.duration * self._stream.time_base)
        else:
            of_all = self._container.duration
            end_s = stated_end_s(self._container, self._stream) or (of_all / av.time_base if of_all else None)
            if end_s is None:
                return None
            stated_s = end_s - self._start_s()
        return max(0.0, stated_s - 1 / self.fps)

    def ends_early(self) -> bool:
        """A clip cut between two packets is no error to FFmpeg, but its index or its header promises more than came.

        The header's duration is that of all that is in the file, which may have more sound than pictures.
        """
        if self._container.format.name == "gif":
            return self._last_bytes != GIF_END
        if not self._stream.time_base:
            return False
        if self._stream.duration:
            promised_s = float(stated_length(self._container, self._stream) * self._stream.time_base)
        else:
            promised_s = (stated_end_s(self._container, self._stream) or 0.0) - self._start_s()
        return promised_s - self._end_s > TOLERATED_GAP_FRAMES / self.fps

    def _start_s(self) -> float:
        """Of the first picture: the header's duration counts from time 0, wherever that is."""
        return max(0.0, float((self.start_pts or 0) * (self._stream.time_base or 0)))

    def close(self) -> None:
        self._videos = iter(())
        self._container.close()
        self._file.close()

    def _stamp(self, video: VideoFrame) -> int | None:
        return video.dts if self._has_decoding_times else video.pts

    def _numbered(self, video: VideoFrame) -> Picture:
        stamp = self._stamp(video)
        if stamp is None or self.start_pts is None or not video.time_base:
            time_s = self.decoded / self.fps
        else:
            time_s = float((stamp - self.start_pts) * video.time_base)
        # Clips that were joined byte by byte begin anew. Of two at one time the second comes before the next's time.
        is_same = time_s == self._latest_s and self.decoded > 0
        if is_same or not self._latest_s <= time_s <= LONGEST_S:
            time_s = self._latest_s + (0.5 if is_same else 1.0) / self.fps
            self._is_in_order = False
        self._latest_s = time_s
        self._end_s = time_s + float((video.duration or 0) * (video.time_base or 0))
        self.decoded += 1
        return Picture(video, self.decoded - 1, time_s)

    def _decoded(self, container: InputContainer, stream: VideoStream) -> Iterator[VideoFrame]:
        packets = self._searched.following(container.demux(stream))
        is_jpeg = stream.codec_context.name == "mjpeg"
        while True:
            try:
                # The packet after the last one is empty and fetches what the decoder still holds.
                packet = next(packets, None)
                # Of a JPEG that was cut the rest of the picture would be whatever was in memory.
                if packet is not None and is_jpeg and (packet.is_corrupt or why_endless(bytes(packet)) is not None):
                    self.damaged += 1
                    continue
                pictures = packet.decode() if packet is not None else None
            except EOFError:
                return
            except av.error.FFmpegError:
                self.damaged += 1
                continue
            if packet is None or pictures is None:
                return
            if packet.size:
                self._last_bytes = bytes(memoryview(packet)[-len(GIF_END) :])
            for picture in pictures:
                assert isinstance(picture, VideoFrame)
                self._has_keyframe |= picture.key_frame
                is_out_of_grey = not self._has_keyframe and stream.codec_context.name in OUT_OF_GREY
                if picture.is_corrupt or is_out_of_grey or self._is_of_other_shape(picture):
                    self.damaged += 1
                else:
                    self._is_woven |= picture.interlaced_frame
                    yield picture

    def _is_of_other_shape(self, picture: VideoFrame) -> bool:
        """Calls and screens are recorded in changing sizes: one of the same shape is scaled, another would be bent."""
        if self._first_size is None:
            self._first_size = picture.width, picture.height
        width, height = self._first_size
        is_other = abs(picture.width * height / (width * picture.height) - 1) > SAME_SHAPE
        self.has_other_shapes |= is_other
        return is_other


def _stream_of_pictures(path: Path, container: InputContainer) -> VideoStream:
    """The clip's. Raises UserError when it has none that can be decoded."""
    stream = video_in(container)
    if stream is None or stream.codec_context is None:  # whatever the stub says: a codec that FFmpeg does not know
        raise sound_alone(path) if stream is None and container.streams.audio else no_clip(path)
    return stream
