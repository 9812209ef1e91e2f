"""An OBJ or MTL file as trimesh is to read it: UTF-8, and of an OBJ the lines that are drawn.

For every object, group and smoothing group trimesh would look through all others.
"""

import re

# What follows is not kept: comments, objects, groups, curves, and whatever a program has added.
OTHER_LINES = re.compile(rb"^(?!(?:v|vt|vn|f|usemtl|mtllib)[ \t])[^\n]*\n?", re.MULTILINE)
CONTINUED = re.compile(rb"\\\r?\n")
BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def drawn_lines(content: bytes) -> bytes:
    """Of an OBJ, each on one line."""
    return OTHER_LINES.sub(b"", CONTINUED.sub(b" ", as_utf8(content).replace(b"\r\n", b"\n")))


def as_utf8(content: bytes) -> bytes:
    """Text of another encoding is taken for Latin-1: only names may then look odd, and they are not shown."""
    content = content.removeprefix(BYTE_ORDER_MARK)
    try:
        content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1").encode()
    return content
