"""What a .gltf or .glb is before anything in it is looked at: its version, its chunks, and where its buffers lie."""

import base64
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ashe_live.errors import UserError
from ashe_live.models.loading import load_model_file
from tests.models.gltf_files import Document

JSON, BINARY = 0x4E4F534A, 0x004E4942


def quad() -> Document:
    document = Document()
    document.quad()
    return document


def glb(version: int = 2, kind: int = JSON, rest: Callable[[bytes], bytes] | None = None) -> bytes:
    """A good file but for what is given; `rest` makes of its binary chunk what comes after the JSON."""
    document = quad()
    text = json.dumps({**document.json, "buffers": [{"byteLength": len(document.buffer)}]}).encode()
    binary = struct.pack("<2I", len(document.buffer), BINARY) + document.buffer
    chunks = struct.pack("<2I", len(text), kind) + text + (binary if rest is None else rest(binary))
    return struct.pack("<3I", 0x46546C67, version, 12 + len(chunks)) + chunks


def with_buffer(**buffer: Any) -> bytes:
    document = quad()
    return json.dumps({**document.json, "buffers": [{"byteLength": len(document.buffer), **buffer}]}).encode()


OTHER_CHUNK = struct.pack("<2I", 4, 0x12345678) + b"????"


@pytest.mark.parametrize("rest", [None, lambda binary: binary + OTHER_CHUNK], ids=["as it is", "with another chunk"])
def test_a_binary_file_is_read(tmp_path: Path, rest: Callable[[bytes], bytes] | None) -> None:
    (tmp_path / "a.glb").write_bytes(glb(rest=rest))
    assert load_model_file(tmp_path / "a.glb").triangle_count == 2


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_what_a_file_is_counts_and_not_its_name(tmp_path: Path, suffix: str) -> None:
    binary, text = quad().save(tmp_path / "b.glb"), quad().save(tmp_path / "t.gltf")
    for number, file in enumerate((binary, text)):
        other = file.rename(tmp_path / f"{number}{suffix}")
        assert load_model_file(other).triangle_count == 2


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (glb(version=1), "is glTF 1: export it as glTF 2.0"),
        (glb(version=3), "its header says that it is of version 3"),
        (glb(kind=BINARY), "its first chunk is not JSON"),
        (glb()[:19], "it ends within its first chunk"),
        (glb()[:-1], "it ends 1 bytes before its binary chunk does"),
        (glb(rest=lambda _: b""), r"buffers\[0\] has 0 bytes, and 48 are used"),
        (glb(rest=lambda _: OTHER_CHUNK), r"buffers\[0\] has 0 bytes, and 48 are used"),
        (with_buffer(), r"buffers\[0\].uri is missing"),
        (with_buffer(uri="data:application/octet-stream;base64"), "a data URI has no comma"),
        (with_buffer(uri="data:;base64,AAAAA"), "a data URI is no base64"),
        (with_buffer(uri="data:;base64,AA-_"), "a data URI is no base64"),
        (with_buffer(uri="DATA:;BASE64,AA*A"), "a data URI is no base64"),
        (with_buffer(uri="data:;base64,AAAA"), r"buffers\[0\] has 3 bytes, and 48 are used"),
        (with_buffer(uri="data:,%00%00"), r"buffers\[0\] has 2 bytes, and 48 are used"),
        (b"[]", "its JSON is not an object"),
        (b'{"asset":', "its JSON breaks off or is damaged in line 1"),
        (b'{"asset": {"version": "2.0"}, "a": 1' + 5000 * b"0" + b"}", "holds a number without an end"),
        (100_000 * b"[", "its JSON is nested too deeply"),
        (b"PK", "it begins neither as GLB does nor as JSON"),
    ],
)
def test_what_is_wrong_with_it_is_said(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "a.glb").write_bytes(content)
    with pytest.raises(UserError, match=said):
        load_model_file(tmp_path / "a.glb")


def of_version(**asset: str) -> bytes:
    content = json.loads(with_buffer(uri="data:;base64," + base64.b64encode(quad().buffer).decode()))
    return json.dumps({**content, "asset": asset}).encode()


@pytest.mark.parametrize(
    ("asset", "is_read"),
    [
        ({"version": "2.0", "minVersion": "2.0"}, True),
        ({"version": "2.1"}, True),
        ({"version": "2"}, True),
        ({"version": "2.1", "minVersion": "2.1"}, False),
        ({"version": "20.0"}, False),
        ({"version": "3.0", "minVersion": "2.0"}, False),
    ],
)
def test_what_needs_a_later_version_is_refused(tmp_path: Path, asset: dict[str, str], is_read: bool) -> None:
    """Section 3.2: of minor versions the file itself says from which on it can be read."""
    (tmp_path / "a.gltf").write_bytes(of_version(**asset))
    if is_read:
        assert load_model_file(tmp_path / "a.gltf").triangle_count == 2
    else:
        with pytest.raises(UserError, match=f"is glTF {max(asset.values())}: export it as glTF 2.0"):
            load_model_file(tmp_path / "a.gltf")


def test_a_buffer_may_lie_in_a_file_beside_it(tmp_path: Path) -> None:
    (tmp_path / "its data.bin").write_bytes(quad().buffer)
    (tmp_path / "a.gltf").write_bytes(with_buffer(uri="its%20data.bin"))
    assert load_model_file(tmp_path / "a.gltf").triangle_count == 2


def test_data_in_an_address_is_base64_where_that_is_said(tmp_path: Path) -> None:
    buffer = quad().buffer
    for uri in (
        "data:;base64," + base64.b64encode(buffer).decode(),
        "data:application/gltf-buffer," + "".join(f"%{byte:02x}" for byte in buffer),
        " Data:application/gltf-buffer; BASE64 , \r\n" + base64.b64encode(buffer + b"x").decode().rstrip("="),
    ):
        (tmp_path / "a.gltf").write_bytes(with_buffer(uri=uri))
        assert load_model_file(tmp_path / "a.gltf").triangle_count == 2


def test_the_scene_that_is_named_is_shown_or_the_first_one(tmp_path: Path) -> None:
    document = quad()
    document.quad(node={"translation": [5, 0, 0]})
    document.json["scenes"] = [{"nodes": [0]}, {"nodes": [0, 1]}]
    counts = []
    for scene in (None, 0, 1):
        document.json.pop("scene", None)
        document.json |= {} if scene is None else {"scene": scene}
        counts.append(load_model_file(document.save(tmp_path / "a.glb")).triangle_count)
    assert counts == [2, 2, 4]
