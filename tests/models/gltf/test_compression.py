"""Geometry as web pages bring it: compressed by Draco or by meshoptimizer, to the same places."""

import base64
import json
from collections.abc import Iterable, Sequence
from pathlib import Path

import DracoPy
import numpy as np
import pytest

from ashe_live.errors import UserError
from ashe_live.models.gltf.meshopt.views import decompressed
from ashe_live.models.loading import load_model_file
from ashe_live.models.parsing.malformed import MalformedError
from tests.models.gltf_files import CORNERS, NORMALS, TRIANGLES, UVS, Document

# 5 x 5 points (1000 x, 1000 y, 37 x y) as 16-bit integers and the triangles between them, by meshoptimizer's encoder.
GRID_POINTS = base64.b64decode(
    "oAcALy8vL8AvLy8vwC8vLy/A///AAC8vLy/ALy8vLwoGiI9oiPaIjx0dHWiI9oiAAAAAHQUAMAwDLy8vAMAAAC8FADAMAwYICADAAAAIBQAP//9K"
    "SkpK2JSUlJRP///AAN7e3t6I19fX1wUAAAAJCEiAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA="
)
GRID_TRIANGLES = base64.b64decode(
    "4f7+/v7+/v7+///////////////+/v7+/v7+/v7+/v7+DwzyAvIC8gJ/BH8CfwJ/An8HDH8JDH8JDH8JDH8HDH8JDH8JDH8JDP8vDAHyBwzxCQwf"
    "CXAaGBdQFhYWUBYWFgB2h1ZneKmGZYlomAFpAAA="
)
# By the same encoder in the second version: what `elements` gives, in channels of bytes, shorts and turned words.
ELEMENTS = base64.b64decode(
    "oe136nhlFSZmZmZmZmZmZmYAAAACBgoOEhYaHiImKi4yNjpIQkZKTlJWZF5iZmp4cnZ6iIKGipiSlqQASkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpK"
    "SkpKSkpKSkpKSkpKAFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWBUqqqqqqqqqqqqqAAAAtiKO+mbSPqoWgu5axjKeCnbiTrom"
    "kv5q1kKuGobyXso2og565lK+DgAjRnms3v//EBETFBYXGBobHR4fISIkJScoKSv/ACwuLzEyMzU2APoGAQP++gYBA/76BgED/voGAQP++gYBA/76BgED"
    "/voGAQP++gYBAwECEAEDAAAAgIBAwKAgEFDQEMhoKAiElLTkpHSyomKq+pKymoqCQcVN2Un9VQYPj0LiYTHxMeQc/8THBMQHAw8DEQAHAQAQEdnZ2RER"
    "2dnZ2REA2dkAEBECBAIREQQCBAQRAAIEFQCAgICAgICAgIAAAAAABwAAAGDqAAAAAAAAAAAAAAAAAAEiMgA="
)
# By the same encoder: bodies whose triangles each share an edge with one of those before, as in nearly all models.
STRIP = [(i, i + 1, i + 2) if i % 2 == 0 else (i, i + 2, i + 1) for i in range(8)]
FAN = [(0, i, i + 1) for i in range(20, 24)]
STRIP_BACK = [(i, i - 1, i - 2) if i % 2 == 0 else (i, i - 2, i - 1) for i in range(40, 36, -1)]
TETRAHEDRON = [(50, 51, 52), (50, 52, 53), (50, 53, 51), (53, 52, 51)]
RING = [(61, 62), (62, 63), (63, 64), (64, 61)]
OCTAHEDRON = [*((60, a, b) for a, b in RING), *((65, b, a) for a, b in RING)]
FIRST_AGAIN = [(0, 1, 2), (0, 2, 3)]
BODIES = [*STRIP, *FAN, *STRIP_BACK, *TETRAHEDRON, *OCTAHEDRON, *FIRST_AGAIN]
BODIES_TRIANGLES = base64.b64decode(
    "4fAQABAAEAAQ/w4ODv8dDR3/DgIR/w4OA34CERT+AP8AKAL/IAEB/x4CAv8OAgIAAHaHVmd4qYZliWiYAWkAAA=="
)


def grid() -> tuple[np.ndarray, np.ndarray]:
    y, x = (along.ravel() for along in np.mgrid[:5, :5])
    first = (5 * np.arange(4)[:, None] + np.arange(4)).ravel()
    lower, upper = np.stack([first, first + 1, first + 6], 1), np.stack([first, first + 6, first + 5], 1)
    return np.stack([1000 * x, 1000 * y, 37 * x * y], 1), np.concatenate([lower, upper])


def attributes(count: int, stride: int, kind: str = "NONE") -> dict:
    return {"count": count, "byteStride": stride, "mode": "ATTRIBUTES", "filter": kind}


def test_what_meshoptimizer_wrote_is_read() -> None:
    points, triangles = grid()
    read = np.frombuffer(decompressed(GRID_POINTS, attributes(25, 8)), np.uint16).reshape(-1, 4)
    np.testing.assert_array_equal(read[:, :3], points)
    assert lowest_first(read_triangles(GRID_TRIANGLES, len(triangles))) == lowest_first(triangles)


def elements() -> np.ndarray:
    """(40, 20) bytes, as the stream above has them."""
    i = np.arange(40)
    singles = np.stack([i % 2, i * i % 251, np.full(40, 7), 37 * i], 1).astype(np.uint8)
    shorts = np.stack([300 * i, 60000 + 91 * i * i], 1).astype(np.uint16)
    floats = np.stack([i % 5 / 4, i * i / 64], 1).astype(np.float32)
    words = (i // 4 * 0x01000193).astype(np.uint32)[:, None]
    return np.hstack([each.view(np.uint8) for each in (singles, shorts, floats, words)])


def test_what_meshoptimizer_writes_today_is_read() -> None:
    """KHR_meshopt_compression's second version: widths by control modes, deltas of bytes, shorts and turned words."""
    read = np.frombuffer(decompressed(ELEMENTS, attributes(40, 20)), np.uint8).reshape(-1, 20)
    np.testing.assert_array_equal(read, elements())


def test_words_differ_from_those_before_by_an_exclusive_or() -> None:
    """So another first element, which the tail holds before the channels' modes, is as different in all of them."""
    other, differing = np.frombuffer(ELEMENTS, np.uint8).copy(), np.uint8((0x5A, 0x01, 0x80, 0xFF))
    other[-13:-9] ^= differing
    read = np.frombuffer(decompressed(other.tobytes(), attributes(40, 20)), np.uint8).reshape(-1, 20)
    changes = read ^ elements()
    np.testing.assert_array_equal(changes[:, 12:16], [differing] * 40)
    assert not np.delete(changes, range(12, 16), axis=1).any()


@pytest.mark.parametrize("mode", [0x03, 0x11, 0x20])
def test_a_channel_of_no_mode_is_said(mode: int) -> None:
    stream = ELEMENTS[:-1] + bytes([mode])
    with pytest.raises(MalformedError, match=f"a channel is of mode 0x{mode:02x}"):
        decompressed(stream, attributes(40, 20))


def test_triangles_beside_those_before_are_read() -> None:
    assert lowest_first(read_triangles(BODIES_TRIANGLES, len(BODIES))) == lowest_first(BODIES)


def test_triangles_are_as_the_specifications_cases_say() -> None:
    """Appendix A, mode 1, by hand: the streams above use neither pairs of the table nor an edge and a free corner."""
    codes = bytes([0xF0, 0xF0, 0xF1, 0x0F, 0x03, 0x0D, 0x0E, 0x03, 0x20, 0x02])
    free_corner, pairs = b"\x02", bytes([0x00, 0x30, *bytes(14)])
    read = read_triangles(b"\xe1" + codes + free_corner + pairs, len(codes))
    apart = [(0, 1, 2), (3, 4, 5), (6, 3, 7)]
    at_edges = [(6, 7, 1), (6, 1, 5), (6, 5, 0), (6, 0, 1), (6, 1, 7), (6, 1, 8), (6, 8, 0)]
    assert [tuple(corners) for corners in read.tolist()] == apart + at_edges


def read_triangles(content: bytes, count: int) -> np.ndarray:
    compression = {"count": 3 * count, "byteStride": 2, "mode": "TRIANGLES"}
    return np.frombuffer(decompressed(content, compression), np.uint16).reshape(-1, 3)


def lowest_first(triangles: Iterable[Sequence[int]]) -> list[list[int]]:
    """Each as turned so that its lowest corner comes first: the encoder may begin with any of them."""
    return [np.roll(corners, -int(np.argmin(corners))).tolist() for corners in triangles]


def test_the_specifications_example_of_a_group() -> None:
    """Appendix A, mode 0: sixteen deltas in four bits each, two of them apart."""
    group = bytes([0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5])
    empty = b"\0"
    stream = b"\xa0" + b"\x02" + group + 3 * empty + bytes(32)
    read = np.frombuffer(decompressed(stream, attributes(16, 4)), np.uint8).reshape(-1, 4)
    deltas = np.array([-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0])
    np.testing.assert_array_equal(read[:, 0], np.cumsum(deltas) % 256)
    assert not read[:, 1:].any()


def test_indices_are_deltas_to_either_of_two() -> None:
    """Appendix A, mode 2; 0x81 0x04 is 0x201, a delta of 128 from the second, and 0x80 0x04 one from the first."""
    stream = bytes([0xD1, 0x28, 0x50, 0x05, 0x81, 0x04, 0x80, 0x04, 0x0A]) + bytes(4)
    read = np.frombuffer(decompressed(stream, {"count": 6, "byteStride": 4, "mode": "INDICES"}), np.uint32)
    assert read.tolist() == [10, 30, 1, 129, 158, 155]


def stored(rows: np.ndarray, first: np.ndarray | None = None) -> bytes:
    """Rows as a stream that spares nothing: every byte's deltas whole, from the row `first` on, or from zeros."""
    values = np.ascontiguousarray(rows).view(np.uint8).reshape(len(rows), -1)
    last = np.zeros(values.shape[1], np.uint8) if first is None else first
    tail = bytes(max(32 - len(last), 0)) + last.tobytes()
    most = min(8192 // values.shape[1] // 16 * 16, 256)
    stream = b"\xa0"
    for block in np.split(values, range(most, len(values), most)):
        filled = np.vstack([block, np.repeat(block[-1:], -len(block) % 16, axis=0)])
        deltas = np.diff(filled, axis=0, prepend=last[None]).astype(np.int8).astype(int)
        codes = np.where(deltas < 0, -2 * deltas - 1, 2 * deltas).astype(np.uint8)
        stream += b"".join(bytes([0xFF] * -(-len(filled) // 64)) + column.tobytes() for column in codes.T)
        last = block[-1]
    return stream + tail


@pytest.mark.parametrize(("count", "stride"), [(1, 4), (256, 32), (257, 32), (600, 12), (70, 256)])
def test_elements_go_on_from_block_to_block(count: int, stride: int) -> None:
    """Blocks of 8 KiB or 256 elements at most; the first goes on from what the tail holds."""
    random = np.random.default_rng(count)
    first = random.integers(0, 256, stride).astype(np.uint8)
    rows = first + np.cumsum(random.integers(-9, 10, (count, stride)), axis=0).astype(np.uint8)
    read = decompressed(stored(rows, first), attributes(count, stride))
    np.testing.assert_array_equal(np.frombuffer(read, np.uint8).reshape(count, stride), rows)


def test_filters_give_directions_turns_and_floats() -> None:
    """Appendix B; the inputs by its definitions."""
    directions = np.float64([(0, 0, 1), (1, 0, 0), (0.6, 0, -0.8), (0, -0.6, 0.8), (-0.6, 0, 0.8), (-0.48, 0.6, -0.64)])
    share = directions / np.abs(directions).sum(axis=1, keepdims=True)
    folded = np.where(share[:, 2:] < 0, (1 - np.abs(share[:, 1::-1])) * np.where(share[:, :2] < 0, -1, 1), share[:, :2])
    packed = np.column_stack([np.round(folded * 127), np.full(6, 127), np.full(6, 5)]).astype(np.int8)
    read = np.frombuffer(decompressed(stored(packed), attributes(6, 4, "OCTAHEDRAL")), np.int8).reshape(-1, 4)
    np.testing.assert_allclose(read[:, :3] / 127, directions, atol=0.02)
    assert (read[:, 3] == 5).all()

    one, parts = 31, np.array((7, -18, 30))
    packed = np.int16([(*parts, one & ~3 | largest) for largest in range(4)])
    smaller = parts / one * np.sqrt(0.5)
    unit = np.array((np.sqrt(1 - smaller @ smaller), *smaller))
    read = np.frombuffer(decompressed(stored(packed), attributes(4, 8, "QUATERNION")), np.int16).reshape(-1, 4)
    np.testing.assert_allclose(read / 32767, [np.roll(unit, largest) for largest in range(4)], atol=0.6 / 32767)

    packed = np.int32([(-2 << 24) | 5, (3 << 24) | (-7 & 0xFFFFFF)])[:, None]
    read = np.frombuffer(decompressed(stored(packed), attributes(2, 4, "EXPONENTIAL")), np.float32)
    assert read.tolist() == [1.25, -56.0]


@pytest.mark.parametrize(("kind", "bits"), [(np.uint8, 8), (np.uint8, 6), (np.uint16, 12)])
def test_a_filter_gives_colours(kind: type, bits: int) -> None:
    """Appendix B: luma and two chrominances of so many bits, alpha of one less below a bit that tells how many."""
    most = (1 << bits) - 1
    rgb = np.array([(0, 0, 0), (60, 20, 40), (0, 0, 60), (0, 60, 0), (60, 0, 0)])
    alpha = np.array([0, most, most // 2 & ~3, 3, most])  # its last two bits are alike, as one of them is not stored
    red, green, blue = rgb.T
    luma, orange, greenish = (red + 2 * green + blue) // 4, (red - blue) // 2, (2 * green - red - blue) // 4
    packed = np.stack([luma, orange, greenish, 1 << bits - 1 | alpha >> 1], axis=1).astype(kind)
    stride = packed[0].nbytes
    read = np.frombuffer(decompressed(stored(packed), attributes(5, stride, "COLOR")), kind).reshape(-1, 4)
    largest = np.iinfo(kind).max
    np.testing.assert_allclose(read / largest, np.column_stack([rgb, alpha]) / most, atol=0.6 / largest)


def of_meshopt(cut: int = 0) -> Document:
    document = Document()
    points = document.view(GRID_POINTS[: len(GRID_POINTS) - cut])
    triangles = document.view(GRID_TRIANGLES)
    for view, (stride, count, mode) in ((points, (8, 25, "ATTRIBUTES")), (triangles, (2, 96, "TRIANGLES"))):
        own = document.json["bufferViews"][view]
        packed = {**own, "byteStride": stride, "count": count, "mode": mode}
        own |= {"buffer": 1, "byteOffset": 0, "byteLength": stride * count}
        own["extensions"] = {"EXT_meshopt_compression": packed}
    document.json["bufferViews"][points]["byteStride"] = 8
    document.json["accessors"] = [
        {"bufferView": points, "componentType": 5123, "count": 25, "type": "VEC3"},
        {"bufferView": triangles, "componentType": 5123, "count": 96, "type": "SCALAR"},
    ]
    document.json["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]
    document.json["nodes"], document.json["scenes"] = [{"mesh": 0}], [{"nodes": [0]}]
    document.json["extensionsRequired"] = ["EXT_meshopt_compression", "KHR_mesh_quantization"]
    document.more_buffers = [{"byteLength": 1000}]  # that nothing is in
    return document


def test_a_file_of_compressed_views_is_drawn(tmp_path: Path) -> None:
    model = load_model_file(of_meshopt().save(tmp_path / "a.glb"))
    assert model.triangle_count == 32
    np.testing.assert_allclose(np.ptp(model.bounds, axis=0), (4000, 592, 4000))


def test_a_file_of_the_successor_has_its_colours(tmp_path: Path) -> None:
    document = of_meshopt()
    magenta = stored(np.tile(np.array([30, 0, -30, 63], np.int8), (25, 1)))
    view = document.view(magenta)
    own = document.json["bufferViews"][view]
    packed = {**own, "byteStride": 4, "count": 25, "mode": "ATTRIBUTES", "filter": "COLOR"}
    own |= {"buffer": 1, "byteOffset": 0, "byteLength": 100, "extensions": {"EXT_meshopt_compression": packed}}
    document.json["accessors"].append(
        {"bufferView": view, "componentType": 5121, "count": 25, "type": "VEC4", "normalized": True}
    )
    document.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2
    document.json = json.loads(json.dumps(document.json).replace("EXT_meshopt", "KHR_meshopt"))
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    np.testing.assert_allclose(part.colours, [(60 / 63, 0, 60 / 63, 1)] * len(part.colours), atol=0.003)


@pytest.mark.parametrize("cut", [1, 100, 148])
def test_compressed_views_that_are_torn_are_said(tmp_path: Path, cut: int) -> None:
    document = of_meshopt(cut)
    with pytest.raises(UserError, match=r"bufferViews\[0\] cannot be decompressed \(it ends"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_a_compression_of_another_size_than_its_view_is_said(tmp_path: Path) -> None:
    document = of_meshopt()
    document.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 26
    with pytest.raises(UserError, match=r"bufferViews\[0\] is of 200 bytes, and its compression of 26 times 8 bytes"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_compressed_data_beyond_its_buffer_is_said(tmp_path: Path) -> None:
    document = of_meshopt()
    document.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteOffset"] = 1_000_000
    with pytest.raises(UserError, match=r"bufferViews\[0\] ends at byte 1000"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_a_compression_that_is_none_is_said(tmp_path: Path) -> None:
    document = of_meshopt()
    document.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["mode"] = "INDICES"
    with pytest.raises(UserError, match=r"bufferViews\[0\] cannot be decompressed \(indices of 8 bytes\)"):
        load_model_file(document.save(tmp_path / "a.glb"))


@pytest.mark.parametrize("stream", [b"\xe1" + bytes(60), b"\xa0", b"", b"\xa2" + bytes(60), b"\xa1" + bytes(23)])
def test_another_stream_is_refused(stream: bytes) -> None:
    with pytest.raises((MalformedError, IndexError)):
        decompressed(stream, attributes(4, 8))


@pytest.mark.parametrize(
    ("stream", "described", "said"),
    [
        (GRID_POINTS, attributes(25, 6), "elements of 6 bytes"),
        (GRID_POINTS, attributes(25, 260), "elements of 260 bytes"),
        (GRID_POINTS, attributes(25, 12, "OCTAHEDRAL"), "OCTAHEDRAL elements of 12 bytes"),
        (GRID_POINTS, attributes(25, 4, "QUATERNION"), "QUATERNION elements of 4 bytes"),
        (GRID_POINTS, attributes(25, 12, "COLOR"), "COLOR elements of 12 bytes"),
        (GRID_TRIANGLES, {"count": 96, "byteStride": 8, "mode": "TRIANGLES"}, "indices of 8 bytes"),
        (GRID_TRIANGLES, {"count": 95, "byteStride": 2, "mode": "TRIANGLES"}, "95 indices are no triangles"),
        (GRID_TRIANGLES, {"count": 96, "byteStride": 2, "mode": "INDICES"}, "0xe1 and not 0xd1"),
        (b"\xd1" + 5 * b"\xff", {"count": 1, "byteStride": 4, "mode": "INDICES"}, "more than 32 bits"),
    ],
)
def test_what_a_stream_cannot_be_is_said(stream: bytes, described: dict, said: str) -> None:
    with pytest.raises(MalformedError, match=said):
        decompressed(stream + bytes(600), described)


def of_draco(content: bytes | None = None, normals: np.ndarray = NORMALS) -> Document:
    document = Document()
    document.quad(TEXCOORD_0=document.accessor(UVS))
    whole = DracoPy.encode(
        CORNERS,
        TRIANGLES.astype(np.uint32),
        quantization_bits=14,
        normals=normals.astype(float),
        tex_coord=UVS.astype(float),
        preserve_order=True,
    )
    ids = {attribute["attribute_type"]: attribute["unique_id"] for attribute in DracoPy.decode(whole).attributes}
    primitive = document.json["meshes"][0]["primitives"][0]
    view = document.view(whole if content is None else content)
    named = {"POSITION": ids[0], "NORMAL": ids[1], "TEXCOORD_0": ids[3]}
    primitive["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": view, "attributes": named}}
    for accessor in document.json["accessors"]:
        del accessor["bufferView"]
    document.json["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    return document


def test_what_draco_wrote_is_read(tmp_path: Path) -> None:
    part = load_model_file(of_draco().save(tmp_path / "a.glb")).parts[0]
    corners = part.vertices[part.triangles].reshape(-1, 3)
    given = CORNERS[TRIANGLES].reshape(-1, 3)[:, [0, 2, 1]] * np.float32((1, -1, 1))
    np.testing.assert_allclose(sorted(corners.round(3).tolist()), sorted(given.round(3).tolist()), atol=2e-3)
    np.testing.assert_allclose(part.normals, [(0, -1, 0)] * len(part.normals), atol=1e-2)


def test_two_parts_may_name_other_attributes_of_the_same_draco_data(tmp_path: Path) -> None:
    """The normals are others than those of the triangles, which the part without any has."""
    document = of_draco(normals=np.tile((1.0, 0.0, 0.0), (len(CORNERS), 1)))
    (whole,) = primitives = document.json["meshes"][0]["primitives"]
    bare = json.loads(json.dumps(whole))
    del bare["attributes"]["NORMAL"], bare["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"]
    primitives[:] = [bare, whole]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    normals = {tuple(normal) for part in model.parts for normal in part.normals.round(2)}
    assert normals == {(0, -1, 0), (1, 0, 0)}


def test_what_is_not_in_draco_data_lies_beside_it(tmp_path: Path) -> None:
    """The extension names some of the primitive's attributes; what it names and is not there is said."""
    document = of_draco()
    (primitive,) = document.json["meshes"][0]["primitives"]
    primitive["attributes"]["COLOR_0"] = document.accessor(np.uint8([(255, 0, 51, 255)] * 4), normalised=True)
    part = load_model_file(document.save(tmp_path / "a.glb")).parts[0]
    np.testing.assert_allclose(part.colours, [(1, 0, 0.2, 1)] * 4, atol=1e-6)
    primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"]["COLOR_0"] = 99
    with pytest.raises(UserError, match="Draco data holds no COLOR_0"):
        load_model_file(document.save(tmp_path / "a.glb"))


@pytest.mark.parametrize("content", [b"DRACO" + bytes(40), b"", bytes(100)])
def test_draco_data_that_is_none_is_said(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(UserError, match="Draco data cannot be decoded"):
        load_model_file(of_draco(content or b"\1").save(tmp_path / "a.glb"))


def test_draco_data_of_another_size_is_said(tmp_path: Path) -> None:
    document = of_draco()
    for accessor in document.json["accessors"]:
        accessor["count"] = 6
    with pytest.raises(UserError, match=r"Draco data holds \(4, 3\) of POSITION, and its accessor \(6, 3\)"):
        load_model_file(document.save(tmp_path / "a.glb"))
