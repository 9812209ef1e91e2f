"""How much work a JPEG is, told before anybody decodes it: the kilobytes of some take minutes.

Its parts are those of ITU-T T.81, B.1.1.
"""

import re
from pathlib import Path
from typing import BinaryIO

from ashe_live.errors import UserError

# A JPEG is decoded as often as it has scans; progressive ones have about ten.
MOST_SCANS = 100
# Readers keep each segment as an object. Of metadata there are 64 KB in one.
MOST_SEGMENTS = 10_000
START = b"\xff\xd8"
# A segment's beginning, and not what the data of a scan or fill bytes look like.
SEGMENT = re.compile(rb"\xff([\x02-\xcf\xd9-\xfe])")
START_OF_SCAN, END_OF_IMAGE = b"\xda", b"\xd9"


def why_endless(content: bytes) -> str | None:
    """In words, what of a JPEG would take very long; None for other content, and for what cameras and programs write.

    What follows the picture's end counts for nothing.
    """
    if not content.startswith(START):
        return None
    at, scans, segments = len(START), 0, 0
    while (segment := SEGMENT.search(content, at)) is not None and segment[1] != END_OF_IMAGE:
        scans += segment[1] == START_OF_SCAN
        segments += 1
        if segments > MOST_SEGMENTS:
            return f"is in more than {MOST_SEGMENTS:,} parts, and photos have about ten"
        at = segment.end() + int.from_bytes(content[segment.end() : segment.end() + 2], "big")
    return f"has its picture in {scans} scans, and photos have about ten" if scans > MOST_SCANS else None


def refuse_endless(path: Path, file: BinaryIO) -> None:
    """Raises UserError for a JPEG that would take very long; `file` is at its start afterwards."""
    file.seek(0)
    is_jpeg = file.read(len(START)) == START
    file.seek(0)
    if is_jpeg:
        why = why_endless(file.read())
        file.seek(0)
        if why is not None:
            raise UserError(f"{path} {why}", "save it again as JPEG")
