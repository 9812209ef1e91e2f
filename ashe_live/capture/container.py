"""The only way to a clip's content: FFmpeg is handed an open file, and can reach nothing else.

A name could mean an address or a protocol to it (`http:`, `concat:`), and some formats are lists of addresses.
"""

import os
import re
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, BinaryIO, TypeVar

import av
from av.container import InputContainer, OutputContainer
from av.stream import Disposition
from av.video.stream import VideoStream

from ashe_live.capture.sources import MAX_PIXELS
from ashe_live.process.signals import called_from_c

Packet = TypeVar("Packet")

# FFmpeg's names of what cameras, phones and editors write; none that names other files (HLS, DASH, concat, SDP).
DEMUXERS = (
    "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mpegvideo,flv,ogg,asf,gif,apng,mjpeg,h264,hevc,av1,obu,ivf,"
    "dv,mxf,nut,rm,swf,wtv,yuv4mpegpipe"
)
# Of text that is not UTF-8; from PyAV 19 on there is no choice.
ANY_METADATA: dict[str, Any] = {"metadata_errors": "replace"} if int(av.__version__.split(".")[0]) < 19 else {}
# Of any picture: no memory is spent on a larger one, be it the first or one that a clip of small ones ends with.
DECODED = {"max_pixels": str(MAX_PIXELS)}
ALLOWED = {"protocol_whitelist": "none", "format_whitelist": DEMUXERS}
DURATION_TAG = re.compile(r"(\d+):(\d+):(\d+(?:\.\d+)?)")
JPEG_BEGIN = b"\xff\xd8\xff"
# A picture of 8K has fewer without compression: whoever reads so much and finds no packet will not find any.
MOST_BYTES_TO_A_PACKET = 100_000_000


class Searched:
    """A file as FFmpeg reads it, which ends where nothing is found any more.

    FFmpeg looks for the next packet to the end of the file: for minutes in gigabytes of holes, as in a download that
    was not finished; and in a stream without a container it keeps in memory what it has looked through.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self.go_on()

    def go_on(self) -> None:
        """Something was found: as much may be looked through for the next."""
        self._left = MOST_BYTES_TO_A_PACKET

    def following(self, packets: Iterator[Packet]) -> Iterator[Packet]:
        """Packets that are read from this file."""
        for packet in packets:
            if self._left:  # else it is what was looked through in vain, as one packet
                self.go_on()
            yield packet

    @called_from_c
    def read(self, most_bytes: int) -> bytes:
        """For FFmpeg."""
        content = self._stream.read(min(most_bytes, self._left))
        self._left -= len(content)
        return content

    @called_from_c
    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """For FFmpeg."""
        return self._stream.seek(offset, whence)

    @called_from_c
    def tell(self) -> int:
        """For FFmpeg."""
        return self._stream.tell()


def opened_container(file: Searched) -> InputContainer:
    """From the start of a file, which stays open for as long as the container is used.

    Raises FFmpegError or OSError when it is not a clip.
    """
    file.seek(0)
    # JPEGs one after the other: where the first is large, FFmpeg takes it for a photo.
    demuxer = "mjpeg" if file.read(len(JPEG_BEGIN)) == JPEG_BEGIN else None
    file.seek(0)
    # The options are asked for twice: FFmpeg decodes the first pictures as it opens a file, by codecs of its own.
    container: InputContainer = av.open(file, "r", demuxer, options=DECODED, container_options=ALLOWED, **ANY_METADATA)
    for stream in container.streams.video:
        if stream.codec_context is not None:  # whatever the stub says: a codec that FFmpeg does not know
            stream.codec_context.options = DECODED
    file.go_on()
    return container


def video_in(container: InputContainer) -> VideoStream | None:
    """The first stream of pictures that is not a cover, as songs have."""
    return next((each for each in container.streams.video if not each.disposition & Disposition.attached_pic), None)


def stated_ratio(ratio: Any) -> Fraction | None:
    """A time base, rate or aspect ratio as PyAV states it; None where it is unknown.

    That is a Fraction or None up to PyAV 18. From 19 on it is FFmpeg's own kind of rational number, for which 0/1 and
    1/0 mean unknown.
    """
    return Fraction(ratio.numerator, ratio.denominator) if ratio else None


def has_decoding_times_alone(container: InputContainer, stream: VideoStream) -> bool:
    """Whether pictures are decoded in another order than they are shown in, and no times say which: AVI has none."""
    return container.format.name == "avi" and bool(stream.codec_context.has_b_frames)


def stated_length(container: InputContainer, stream: VideoStream) -> int:
    """The duration in the header, in the stream's unit; 0 where it has none."""
    if container.format.name == "avi":  # of one that is cut FFmpeg guesses it from the bytes that are left
        return stream.frames  # the unit is a picture
    return stream.duration or 0


def stated_end_s(container: InputContainer, stream: VideoStream) -> float | None:
    """When the last picture ends by a header that has no duration of the stream, from time 0; None where it is unknown.

    FFmpeg's Matroska, as of OBS, has it as a tag. Without one, the duration of all is that of the sound as well.
    """
    of_all_s = container.duration / av.time_base if container.duration else None
    tag = DURATION_TAG.fullmatch(stream.metadata.get("DURATION", ""))
    if tag is None or of_all_s is None:
        return of_all_s if len(container.streams) == 1 else None
    hours, minutes, seconds = map(float, tag.groups())
    return min(of_all_s, 3600 * hours + 60 * minutes + seconds)  # some programs keep the tag of what they cut


class WrittenContainer:
    """A new clip in a file that is open, which stays open.

    FFmpeg, and PyAV when it closes, lose or print what goes wrong in writing; so that is kept here, and raised by
    `check` and `close`.
    """

    def __init__(self, stream: BinaryIO, options: dict[str, str], muxer: str = "mp4") -> None:
        """`options` are those of FFmpeg's `muxer`. Raises FFmpegError."""
        # Not through its buffer, which would keep what a full disk refuses, and fail at every seek afterwards.
        self._stream = getattr(stream, "raw", stream)
        self._error: OSError | None = None
        self.container: OutputContainer = av.open(self, "w", format=muxer, options=options)

    def write(self, content: bytes) -> int:
        """For FFmpeg. After an error nothing more is written: what came before stays as it is."""
        if self._error is None:
            left = memoryview(content)
            try:
                while left:
                    left = left[self._stream.write(left) :]
            except OSError as error:
                self._error = error
        return len(content)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """For FFmpeg."""
        try:
            return int(self._stream.seek(offset, whence))
        except OSError as error:
            self._error = self._error or error
            return 0

    def tell(self) -> int:
        """For FFmpeg."""
        return int(self._stream.tell())

    def check(self) -> None:
        """Raises OSError when something could not be written."""
        if self._error is not None:
            raise self._error

    def close(self) -> None:
        """Finishes the file. Raises OSError or FFmpegError; may be called twice."""
        self.container.close()
        self.check()
