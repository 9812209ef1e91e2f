"""A recording in the making as it lies on the disk: an MP4 of fragments (ISO/IEC 14496-12) that may break off anywhere.

All functions take files that are open, and never look one up by its name again.
"""

import struct
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import BinaryIO

import av
from av.container import InputContainer
from av.packet import Packet
from av.video.stream import VideoStream

from ashe_live.capture.container import Searched, WrittenContainer, opened_container
from ashe_live.errors import UserError
from ashe_live.files.new_file import NewFile

IN_THE_MAKING = "ashe-live: a recording in the making"
HEADER_BYTES = 4096  # of a recording: the boxes ftyp and moov, with the comment in the latter
BOX_HEADER = struct.Struct(">I4s")  # of what MP4 files consist of: length in bytes with this header, kind
# Size of the index (box moov): a part that does not depend on the number of pictures, and for each picture at most its
# size (4 bytes), place (8), time (8), shift (8), share in a chunk (12) and whether decoding can begin at it (4).
INDEX_BYTES, INDEX_BYTES_PER_PICTURE = 4096, 44
COPIED_BYTES = 1 << 20  # copied at a time


def is_in_the_making(stream: BinaryIO) -> bool:
    """Whether it begins as our recordings do before they are finished."""
    stream.seek(0)
    return IN_THE_MAKING.encode("ascii") in stream.read(HEADER_BYTES)


def with_index_first(fragments: BinaryIO, clip: BinaryIO, pictures: int) -> None:
    """Copies the packets, without encoding them again, into an MP4 whose index comes first.

    There is room for the index of so many `pictures`. (`faststart`, which moves the index, wants to open the file by
    its name once more.) Raises OSError or FFmpegError when reading or writing fails.
    """
    room = INDEX_BYTES + pictures * INDEX_BYTES_PER_PICTURE
    target = WrittenContainer(clip, {"moov_size": str(room)})
    searched = Searched(fragments)
    with opened_container(searched) as source, closing(target):
        template = source.streams.video[0]
        stream = target.container.add_stream_from_template(template)
        for packet in _whole_packets(searched, source):
            packet.stream = stream
            target.container.mux(packet)
            target.check()


def published(fragments: NewFile, pictures: int) -> Path:
    """Gives the final path to a copy with its index in front, or to the fragments where there is no room for one.

    Both are read again before, as a disk that is full is not always told. What has appeared there meanwhile stays
    unless it is to be overwritten; where the clip is then is returned. Raises OSError when it has not all `pictures`.
    """
    fragments.follow_folder()
    with (
        suppress(OSError, av.error.FFmpegError, UserError),
        NewFile(fragments.path, fragments.overwrite, beside=True) as clip,
    ):
        with_index_first(fragments.stream, clip.stream, pictures)
        if picture_count(clip.stream) == pictures:
            return clip.publish(beside=True)
    if picture_count(fragments.stream) < pictures:
        raise OSError("not all of it could be written")
    return fragments.publish(beside=True)


def picture_count(stream: BinaryIO) -> int:
    """How many packets of pictures can be read; 0 when it is no clip, or the first one cannot be decoded.

    Raises OSError or FFmpegError when reading fails.
    """
    searched = Searched(stream)
    try:
        with opened_container(searched) as clip:
            next(clip.decode(video=0))
        with opened_container(searched) as clip:
            return sum(1 for _ in _whole_packets(searched, clip))
    except (av.error.InvalidDataError, EOFError, StopIteration, IndexError):
        return 0


def made_playable(recording: BinaryIO) -> bool:
    """Cuts off what is not whole: after half a fragment's header readers refuse what comes before it as well.

    For a file of our own. True when at least one picture can be decoded.
    """
    try:
        recording.truncate(_whole_bytes(recording))
        searched = Searched(recording)
        with opened_container(searched) as clip:
            ends = [(packet.pos or 0) + packet.size for packet in _whole_packets(searched, clip)]
        recording.truncate(max(ends, default=0))  # half a picture is worse than none to a decoder
        return picture_count(recording) > 0
    except (OSError, av.error.FFmpegError):
        return False


def copy_whole_fragments(broken: BinaryIO, copy: BinaryIO) -> None:
    """Copies what can be played of a file that is only read. Raises OSError."""
    left = _whole_bytes(broken)
    broken.seek(0)
    while left > 0 and (content := broken.read(min(left, COPIED_BYTES))):
        copy.write(content)
        left -= len(content)
    copy.flush()


def _whole_packets(searched: Searched, clip: InputContainer) -> "Iterator[Packet[VideoStream]]":
    """The whole packets: where a file breaks off, the last may be cut, and an empty one follows it."""
    for packet in searched.following(clip.demux(video=0)):
        if packet.size and not packet.is_corrupt:
            yield packet


def _whole_bytes(stream: BinaryIO) -> int:
    """Where the last whole box ends; the file's end if it breaks off in a fragment's pictures, which can be read."""
    size, end = stream.seek(0, 2), 0
    while end < size:
        stream.seek(end)
        header = stream.read(BOX_HEADER.size)
        length, kind = BOX_HEADER.unpack(header) if len(header) == BOX_HEADER.size else (0, b"")
        if length < BOX_HEADER.size or end + length > size:
            return size if kind == b"mdat" else end
        end += length
    return end
