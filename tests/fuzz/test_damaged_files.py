"""Files that were damaged, or made to harm: each gives a value or a UserError, and little memory is taken."""

import io
import json
import tracemalloc
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from ashe_live.capture.opening import open_source
from ashe_live.core.camera import read_camera_file
from ashe_live.tracking.families.pattern_files import read_marker_picture, read_pattern_file
from tests.fuzz.damaged import files, is_refused

# Pillow's own words about what it skips.
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:PIL")
FEW = files(60)
FORMATS = ("png", "jpeg", "bmp", "tiff", "webp", "ppm")
# Where most formats keep sizes and kinds.
HEADER_BYTES = 200

damage = st.lists(
    st.tuples(st.integers(0, HEADER_BYTES), st.binary(min_size=1, max_size=4), st.booleans()), min_size=1, max_size=4
)
cut = st.one_of(st.none(), st.integers(1, HEADER_BYTES))
json_values = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=4)),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=4), inner, max_size=3)),
    max_leaves=12,
)


def damaged(whole: bytes, changes: list[tuple[int, bytes, bool]], cut: int | None, from_end: bool = False) -> bytes:
    """With bytes replaced or put in near the start, or as near to the end; and cut off somewhere."""
    content = bytearray(whole)
    for at, new, puts_in in changes:
        place = max(0, len(content) - at - len(new)) if from_end else at
        content[place : place if puts_in else place + len(new)] = new
    return bytes(content[: None if cut is None else len(content) * cut // HEADER_BYTES])


def all_frames(path: Path) -> Iterator[tuple[int, int]]:
    with open_source(path) as source:
        while (frame := source.read()) is not None:
            assert frame.image_bgr.dtype == np.uint8
            assert frame.size == source.size
            yield frame.size


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


@pytest.fixture(scope="module")
def photos() -> dict[str, bytes]:
    picture = PIL.Image.fromarray(np.random.default_rng(3).integers(0, 256, (32, 32, 3)).astype(np.uint8))
    files = {}
    for kind in FORMATS:
        picture.save(buffer := io.BytesIO(), kind)
        files[kind] = buffer.getvalue()
    return files


@FEW
@given(kind=st.sampled_from(FORMATS), changes=damage, cut=cut)
def test_a_damaged_photo_is_a_picture_or_a_user_error(folder, photos, kind, changes, cut):
    path = folder / f"photo.{kind}"
    path.write_bytes(damaged(photos[kind], changes, cut))
    is_refused(lambda: list(all_frames(path)))


@pytest.mark.parametrize("kind", ["png", "bmp"])
def test_a_photo_that_claims_to_be_huge_is_refused_before_memory_is_taken(folder, photos, kind):
    content = bytearray(photos[kind])
    at, order = (16, "big") if kind == "png" else (18, "little")
    content[at : at + 8] = (60_000).to_bytes(4, order) * 2
    if kind == "png":
        content[29:33] = zlib.crc32(content[12:29]).to_bytes(4, "big")
    path = folder / f"huge.{kind}"
    path.write_bytes(content)
    tracemalloc.start()
    try:
        assert is_refused(lambda: list(all_frames(path)))
        assert tracemalloc.get_traced_memory()[1] < 10e6
    finally:
        tracemalloc.stop()


@FEW
@example(changes=[(86, b"\x00\x00\x01", False)], cut=None, from_end=False)  # to be shown at an odd angle
@example(changes=[(0, b"\x00", False)], cut=11, from_end=False)  # taken for a format without a known codec
@given(changes=damage, cut=cut, from_end=st.booleans())
def test_a_damaged_clip_plays_as_far_as_it_goes_or_is_a_user_error(folder, film, changes, cut, from_end):
    path = folder / "clip.mp4"
    path.write_bytes(damaged(film.path.read_bytes(), changes, cut, from_end))
    is_refused(lambda: list(all_frames(path)))


@FEW
@given(content=st.binary(max_size=300))
def test_any_bytes_are_a_source_or_a_user_error(folder, content):
    path = folder / "anything"
    path.write_bytes(content)
    is_refused(lambda: list(all_frames(path)))


@FEW
@given(kind=st.sampled_from(FORMATS), changes=damage, cut=cut)
def test_a_damaged_marker_picture_is_a_picture_or_a_user_error(folder, photos, kind, changes, cut):
    path = folder / f"marker.{kind}"
    path.write_bytes(damaged(photos[kind], changes, cut))
    is_refused(lambda: read_marker_picture(path))


PATTERN = "\n\n".join(
    "\n".join(" ".join(str((7 * i + j) % 256) for j in range(16)) for i in range(48)) for _ in range(4)
)


@FEW
@given(changes=damage, cut=cut)
def test_a_damaged_pattern_file_is_a_pattern_or_a_user_error(folder, changes, cut):
    path = folder / "marker.patt"
    path.write_bytes(damaged(PATTERN.encode(), changes, cut))
    is_refused(lambda: read_pattern_file(path))


@FEW
@given(
    content=st.one_of(
        json_values,
        st.fixed_dictionaries({"size": json_values, "K": json_values}),
        st.fixed_dictionaries(
            {"size": st.lists(st.integers(), min_size=2, max_size=2), "K": st.just([[5, 0, 3], [0, 5, 2], [0, 0, 1]])},
            optional={"dist": json_values},
        ),
    )
)
def test_whatever_a_camera_file_says_is_a_camera_or_a_user_error(folder, content):
    path = folder / "camera.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    is_refused(lambda: read_camera_file(path))


@FEW
@given(content=st.binary(max_size=60))
def test_any_bytes_are_a_camera_or_a_user_error(folder, content):
    path = folder / "camera.json"
    path.write_bytes(content)
    is_refused(lambda: read_camera_file(path))


@pytest.mark.parametrize("read", [read_camera_file, read_pattern_file, lambda path: list(all_frames(path))])
def test_undamaged_files_are_not_refused(folder, film, read):
    path = {read_camera_file: film.camera_file, read_pattern_file: folder / "whole.patt"}.get(read, film.path)
    if read is read_pattern_file:
        path.write_text(PATTERN)
    assert not is_refused(lambda: read(path))
