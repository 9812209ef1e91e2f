"""Texts and profiles of a PNG: small ones are left as they are, and nothing is refused or slow for large ones."""

import io
import zlib
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.photo import PhotoSource, looks_like_photo
from ashe_live.errors import UserError
from ashe_live.files import png, slow_pictures
from ashe_live.files.png import readable
from ashe_live.files.reading import opened
from ashe_live.models.loading import load_model_file
from ashe_live.tracking.families.pattern_files import read_marker_picture

RGB = np.random.default_rng(0).integers(0, 256, (40, 40, 3), np.uint8)
IDAT = b"IDAT"
LARGE = bytes(range(256)) * 8_000  # two million bytes in a few thousand


def chunk(kind: bytes, content: bytes) -> bytes:
    return len(content).to_bytes(4, "big") + kind + content + zlib.crc32(kind + content).to_bytes(4, "big")


def profile(content: bytes) -> bytes:
    return chunk(b"iCCP", b"name\0\0" + zlib.compress(content))


def text(content: bytes, keyword: bytes = b"workflow") -> bytes:
    return chunk(b"zTXt", keyword + b"\0\0" + zlib.compress(content))


def unicode_text(content: bytes) -> bytes:
    return chunk(b"iTXt", b"XML:com.adobe.xmp\0\1\0en\0keyword\0" + zlib.compress(content))


def picture(before: bytes = b"", after: bytes = b"") -> bytes:
    """RGB, with chunks before and after its pixels."""
    encoded = io.BytesIO()
    PIL.Image.fromarray(RGB).save(encoded, "PNG")
    content = encoded.getvalue()
    at, end = content.index(IDAT) - 4, content.index(b"IEND") - 4
    return content[:at] + before + content[at:end] + after + content[end:]


def kinds(content: bytes) -> list[bytes]:
    """The chunks of a PNG, without those of its pixels."""
    found, at = [], 8
    while at < len(content):
        found.append(content[at + 4 : at + 8])
        at += 12 + int.from_bytes(content[at : at + 4], "big")
    return [kind for kind in found if kind not in (b"IHDR", IDAT, b"IEND")]


def left(content: bytes) -> tuple[list[bytes], bytes | None]:
    file, kept = readable(io.BytesIO(content))
    return kinds(file.read()), kept


@pytest.mark.parametrize(
    "chunks",
    [
        b"",
        profile(b"a small one") + text(b"words") + unicode_text(b"words") + chunk(b"tEXt", b"a\0words"),
        chunk(b"iTXt", b"a\0\0\0\0\0" + LARGE),  # which Pillow only reads
        text(LARGE[:999_000]),
    ],
)
def test_most_pictures_are_read_from_their_own_file(chunks: bytes) -> None:
    behind_its_end = picture(chunks) + text(LARGE)  # nobody reads that
    starts_otherwise, breaks_off = b"\xff\xd8\xff" + picture(chunks), picture(chunks)[:-40]
    for content in (picture(chunks), picture(after=chunks), behind_its_end, starts_otherwise, breaks_off):
        file = io.BytesIO(content)
        assert readable(file) == (file, None)
        assert file.tell() == 0


ODD = {
    "large profile": profile(LARGE),
    "large text": text(LARGE),
    "large text in Unicode": unicode_text(LARGE),
    "profile by another method": chunk(b"iCCP", b"name\0\1" + zlib.compress(b"words")),
    "text by another method": chunk(b"zTXt", b"a\0\1" + zlib.compress(b"words")),
    "text in Unicode by another method": chunk(b"iTXt", b"a\0\1\1\0\0" + zlib.compress(b"words")),
    "profile without end": chunk(b"iCCP", b"n" * 90),
    "damaged text": chunk(b"zTXt", b"a\0\0no such stream"),
}


@pytest.mark.parametrize("one", ODD.values(), ids=ODD)
@pytest.mark.parametrize("is_behind", [False, True])
def test_a_picture_is_read_whatever_its_texts_and_profile(tmp_path: Path, one: bytes, is_behind: bool) -> None:
    """As a photo, as a texture and as a marker. They are no part of what is seen."""
    content = picture(after=one) if is_behind else picture(one)
    path = tmp_path / "a.png"
    path.write_bytes(content)
    assert looks_like_photo(path)
    frame = PhotoSource(path).read()
    assert frame is not None
    np.testing.assert_array_equal(frame.image_bgr, RGB[:, :, ::-1])
    (tmp_path / "a.mtl").write_text("newmtl m\nmap_Kd a.png\n")
    faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    (tmp_path / "a.obj").write_text(f"mtllib a.mtl\nusemtl m\n{faces}")
    texels = load_model_file(tmp_path / "a.obj").parts[0].material.base_map
    assert texels is not None
    np.testing.assert_array_equal(texels[..., :3], RGB)
    assert read_marker_picture(path).shape == RGB.shape[:2]


def test_a_large_profile_is_handed_on_and_one_without_end_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    assert left(picture(profile(LARGE) + text(b"words"))) == ([b"zTXt"], LARGE)
    monkeypatch.setattr(png, "MOST_PROFILE_BYTES", len(LARGE) - 1)
    assert left(picture(profile(LARGE))) == ([], None)


@pytest.mark.parametrize("content", [None, b"a small one", LARGE], ids=["none", "small", "large"])
def test_a_picture_is_opened_with_its_profile(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(picture(b"" if content is None else profile(content)))
    with opened(path) as file, slow_pictures.opened_picture(path, file, ("PNG",)) as read:
        assert read.info.get("icc_profile") == content
        assert ("icc_profile" in read.info) == (content is not None)
        np.testing.assert_array_equal(np.asarray(read), RGB)


@pytest.mark.parametrize("content", [picture(), b"P5 1 1 255\nx", b"no picture"], ids=["PNG", "PGM", "none"])
def test_what_is_not_slow_is_at_its_start_afterwards(content: bytes) -> None:
    file = io.BytesIO(content)
    file.seek(3)
    slow_pictures.refuse_slow(Path("a"), file)
    assert file.tell() == 0


def test_of_several_profiles_the_first_counts() -> None:
    """A thousand of them are a megabyte, and each took two milliseconds to open."""
    first, second = profile(b"first"), profile(b"second")
    file, kept = readable(io.BytesIO(picture(first + second + second)))
    assert file.read() == picture(first)
    assert kept is None
    assert left(picture(profile(LARGE) + second)) == ([], LARGE)


def test_no_more_is_decompressed_of_all_texts_than_they_may_have(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ones that were too large count as well."""
    monkeypatch.setattr(png, "MOST_LEFT_BYTES", 1000)
    monkeypatch.setattr(png, "MOST_TEXT_BYTES", 3500)
    words, swollen = text(b"w" * 900), text(bytes(2000))
    assert left(picture(4 * words))[0] == 3 * [b"zTXt"]
    assert left(picture(2 * swollen + 4 * words))[0] == [b"zTXt"]
    assert left(picture(4 * swollen + 4 * words)) == ([], None)


def test_a_marker_in_parts_without_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As photos are: Pillow reads them one by one."""
    monkeypatch.setattr(slow_pictures, "MOST_PARTS", 50)
    (tmp_path / "a.png").write_bytes(picture(60 * chunk(b"teSt", b"")))
    with pytest.raises(UserError, match=r"is in more than 50 parts, .*: save it as JPEG"):
        read_marker_picture(tmp_path / "a.png")
