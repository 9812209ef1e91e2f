"""What a .gltf or .glb holds before anything in it is looked at: its JSON, and the bytes of its buffers."""

import base64
import binascii
import json
import re
import struct
from pathlib import Path
from urllib.parse import unquote_to_bytes

from ashe_live.errors import UserError
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.process.messages import printable

GLB_JSON, GLB_BINARY = 0x4E4F534A, 0x004E4942
DATA = "data:"
IN_BASE64 = re.compile(r"; *base64 *$", re.IGNORECASE)


def split(path: Path, content: bytes) -> tuple[Json, bytes | None]:
    """The JSON, and a GLB's binary chunk. Raises UserError for another version, MalformedError for what is no glTF."""
    binary = None
    text = content
    if content[:4] == b"glTF":
        if len(content) < 20:
            raise MalformedError("it ends within its first chunk")
        _, version, _, length, kind = struct.unpack_from("<5I", content)
        if version == 1:
            raise _other_version(path, "1")
        if version != 2:
            raise MalformedError(f"its header says that it is of version {version}")
        if kind != GLB_JSON:
            raise MalformedError("its first chunk is not JSON")
        text, binary = content[20 : 20 + length], _binary_chunk(content[20 + length :])
    elif path.suffix.lower() == ".glb" and content.lstrip()[:1] not in (b"{", b"["):
        raise MalformedError("it begins neither as GLB does nor as JSON")
    document = _parsed(text)
    _check_version(path, document)
    return document, binary


def _binary_chunk(rest: bytes) -> bytes:
    """Empty where there is none."""
    if len(rest) < 8:
        return b""
    length, kind = struct.unpack_from("<2I", rest)
    if kind != GLB_BINARY:
        return b""
    if len(rest) < 8 + length:
        raise MalformedError(f"it ends {8 + length - len(rest):,} bytes before its binary chunk does")
    return rest[8 : 8 + length]


def _parsed(text: bytes) -> Json:
    try:
        document = json.loads(text)
    except RecursionError:
        raise MalformedError("its JSON is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise MalformedError(f"its JSON breaks off or is damaged in line {error.lineno}") from None
    except ValueError:
        raise MalformedError("its JSON is no text, or holds a number without an end") from None
    if not isinstance(document, dict):
        raise MalformedError("its JSON is not an object")
    return document


def _check_version(path: Path, document: Json) -> None:
    asset = document.get("asset")
    # A file of a later version says by minVersion whether it can be read as 2.0.
    for key in ("version", "minVersion"):
        version = asset.get(key) if isinstance(asset, dict) else None
        if isinstance(version, str) and (version.partition(".")[0] != "2" or (key == "minVersion" and version > "2.0")):
            raise _other_version(path, version)
    # In glTF 1.0 meshes have names instead of places, and the version may be missing.
    if isinstance(document.get("meshes"), dict):
        raise _other_version(path, "1.0")


def _other_version(path: Path, version: str) -> UserError:
    return UserError(f"the model file {path} is glTF {printable(version, 16)}", "export it as glTF 2.0")


class Buffers:
    """The bytes of each buffer, read when it is first asked for: what compressed files fall back to never is."""

    def __init__(self, header: Json, binary: bytes | None, folder: Folder) -> None:
        self._buffers = header["buffers"]
        self._binary = binary
        self._folder = folder
        self._read: dict[int, bytes] = {}

    def part(self, place: int, offset: int, length: int) -> memoryview:
        """`length` bytes of the buffer at `place`. Raises MalformedError where it does not have them."""
        if place not in self._read:
            self._read[place] = self._content(place)
        content = self._read[place]
        if offset + length > len(content):
            raise MalformedError(f"buffers[{place}] has {len(content):,} bytes, and {offset + length:,} are used")
        return memoryview(content)[offset : offset + length]

    def _content(self, place: int) -> bytes:
        uri = self._buffers[place].get("uri")
        if uri is not None:
            return named_content(uri, self._folder)
        if self._binary is None or place > 0:
            raise MalformedError(f"buffers[{place}].uri is missing")
        return self._binary


def is_data(uri: str) -> bool:
    """Whether a URI holds what it stands for (RFC 2397)."""
    return uri.lstrip()[: len(DATA)].lower() == DATA


def named_content(uri: str, folder: Folder) -> bytes:
    """The content that a URI names: the data within it, or a file of the model's folder.

    Data are read as browsers read them: base64 may have spaces in it, and lack its padding.
    """
    if not is_data(uri):
        return folder.get(uri)
    kind, comma, data = uri.partition(",")
    if not comma:
        raise MalformedError("a data URI has no comma")
    content = unquote_to_bytes(data)
    if not IN_BASE64.search(kind):
        return content
    digits = content.translate(None, b" \t\n\f\r").rstrip(b"=")
    try:
        return base64.b64decode(digits + b"=" * (-len(digits) % 4), validate=True)
    except (binascii.Error, ValueError):
        raise MalformedError("a data URI is no base64") from None
