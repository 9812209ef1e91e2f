"""PNG without what makes it slow to open, or has Pillow refuse it: texts and colour profiles that swell.

Pillow decompresses each of them as it opens a picture, and refuses the picture for one of more than a megabyte. Some
programs write such texts and such profiles; and one of a kilobyte may stand there ten thousand times.

PNG specification: chunks in 5.3, profiles in 11.3.2.3, texts in 11.3.3.
"""

import io
import zlib
from collections.abc import Iterator
from typing import BinaryIO

START = b"\x89PNG\r\n\x1a\n"
PLAIN_TEXT, COMPRESSED_TEXT, PERHAPS_COMPRESSED_TEXT = TEXTS = b"tEXt", b"zTXt", b"iTXt"
PROFILE, END = b"iCCP", b"IEND"
HEAD_BYTES, CHECKSUM_BYTES = 8, 4  # of a chunk, before and after its content
DEFLATE = b"\0"  # the method of compression
# Decompressed: the largest text or profile that is left to Pillow, all texts together, and any profile: those of
# printers, which are tables, have a few million bytes.
MOST_LEFT_BYTES, MOST_TEXT_BYTES, MOST_PROFILE_BYTES = 1_000_000, 10_000_000, 20_000_000


def readable(file: BinaryIO) -> tuple[BinaryIO, bytes | None]:
    """What to read a picture from in place of `file`, and its profile where that is not in there but in the file.

    Most pictures, and whatever is no PNG, are left as they are: then that is `file` itself, at its start.
    """
    texts_left, profiles, has_profile = MOST_TEXT_BYTES, [], False
    kept = [(0, 0)]  # from byte to byte
    for at, after, kind in _chunks(file):
        is_kept = True
        if kind in TEXTS:
            text = _text(kind, _content(file, at, after, texts_left), min(MOST_LEFT_BYTES, texts_left))
            is_kept = text is not None
            texts_left = max(0, texts_left - (MOST_LEFT_BYTES if text is None else len(text)))
        elif kind == PROFILE:
            content = _content(file, at, after, MOST_PROFILE_BYTES)
            profile = None if has_profile else _profile(content)
            is_kept = profile is not None and len(profile) <= MOST_LEFT_BYTES
            profiles += [profile] if profile is not None and not is_kept else []
            has_profile = True
        if not is_kept:
            kept[-1] = kept[-1][0], at
            kept.append((after, after))
    size = file.seek(0, io.SEEK_END)
    file.seek(0)
    if len(kept) == 1:
        return file, None
    kept[-1] = kept[-1][0], size
    pieces = []
    for first, last in kept:
        file.seek(first)
        pieces.append(file.read(last - first))
    file.seek(0)
    return io.BytesIO(b"".join(pieces)), next(iter(profiles), None)


def _chunks(file: BinaryIO) -> Iterator[tuple[int, int, bytes]]:
    """Where each chunk begins and ends, and its kind, up to the picture's end or where the file breaks off."""
    size = file.seek(0, io.SEEK_END)
    file.seek(0)
    at = len(START) if file.read(len(START)) == START else size
    while at + HEAD_BYTES <= size:
        file.seek(at)
        head = file.read(HEAD_BYTES)
        after = at + HEAD_BYTES + int.from_bytes(head[:4], "big") + CHECKSUM_BYTES
        if after > size or head[4:] == END:
            return
        yield at, after, head[4:]
        at = after


def _content(file: BinaryIO, at: int, after: int, most: int) -> bytes:
    """Of a chunk; nothing of one that has more than `most` bytes already compressed, which may add a few."""
    first, last = at + HEAD_BYTES, after - CHECKSUM_BYTES
    if last - first > most + most // 1000 + 1000:
        return b""
    file.seek(first)
    return file.read(last - first)


def _text(kind: bytes, content: bytes, most: int) -> bytes | None:
    """Decompressed, as `_inflated`; plain ones of any length."""
    rest = content.partition(b"\0")[2]  # behind the keyword
    if kind == PLAIN_TEXT:
        return rest or None
    if kind == COMPRESSED_TEXT:
        return _inflated(rest, most)
    text = rest[2:].split(b"\0", 2)[-1]  # behind a language, and the keyword in it
    return text if rest[:1] == b"\0" else _inflated(rest[1:2] + text, most)


def _profile(content: bytes) -> bytes | None:
    return _inflated(content.partition(b"\0")[2], MOST_PROFILE_BYTES)


def _inflated(compressed: bytes, most: int) -> bytes | None:
    """Of bytes behind one that says how they are compressed; None for more than `most`, and for what is damaged."""
    if compressed[:1] != DEFLATE:
        return None
    try:
        whole = zlib.decompressobj().decompress(compressed[1:], most + 1)
    except zlib.error:
        return None
    return whole if len(whole) <= most else None
