"""STL as programs write it: names of solids, and colours of triangles in the two ways that are in use."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ashe_live.core.colour import linear_from_srgb
from ashe_live.errors import UserError
from ashe_live.models.formats.stl import TRIANGLE
from ashe_live.models.loading import load_model_file
from ashe_live.models.parsing import limits

RED_FIRST, RED_LAST, MARK = 31, 31 << 10, 1 << 15


def colours(folder: Path, header: bytes, attributes: list[int]) -> np.ndarray | None:
    """(n, 4) of triangles beside one another with these attributes; None without colours."""
    facets = np.zeros(len(attributes), TRIANGLE)
    for number, facet in enumerate(facets):
        facet["corners"] = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)]) + np.array((number, 0, 0))
    facets["attribute"] = attributes
    content = header.ljust(80, b"\0") + len(facets).to_bytes(4, "little") + facets.tobytes()
    (folder / "a.stl").write_bytes(content)
    (part,) = load_model_file(folder / "a.stl", "z").parts
    if part.colours is None:
        return None
    order = np.argsort([part.vertices[triangle, 0].mean() for triangle in part.triangles])
    return part.colours[part.triangles[order, 0]]


def test_a_marked_triangle_has_a_colour_with_red_last(tmp_path: Path) -> None:
    np.testing.assert_allclose(
        colours(tmp_path, b"", [MARK | RED_LAST, MARK | 31, 0]), [(1, 0, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)]
    )


def test_with_a_colour_of_all_it_is_the_other_way_round(tmp_path: Path) -> None:
    header = b"COLOR=" + bytes((0, 51, 0, 255))
    green = linear_from_srgb(np.array(0.2))
    np.testing.assert_allclose(colours(tmp_path, header, [RED_FIRST, MARK]), [(1, 0, 0, 1), (0, green, 0, 1)])


@pytest.mark.parametrize("attributes", [[0, 0], [MARK, 7]])
def test_other_bits_are_no_colours(tmp_path: Path, attributes: list[int]) -> None:
    assert colours(tmp_path, b"COLOUR", attributes) is None


@pytest.mark.parametrize("rest", [b"", b"\xff"])
def test_a_header_that_ends_in_its_colour_is_read(tmp_path: Path, rest: bytes) -> None:
    header = (b"COLOR=" + rest).rjust(80, b" ")
    found = colours(tmp_path, header, [MARK])
    np.testing.assert_allclose(found, [(1, 1, 1, 1)])


def test_text_in_capitals_is_counted_as_text(monkeypatch: pytest.MonkeyPatch) -> None:
    corners = b"VERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\n"
    facet = b"FACET NORMAL 0 0 1\nOUTER LOOP\n" + corners + b"ENDLOOP\nENDFACET\n"
    monkeypatch.setattr(limits, "MAX_TRIANGLES", 20)
    limits.check_text(Path("a.stl"), b"SOLID a\n" + 20 * facet)
    with pytest.raises(UserError, match="21 triangles"):
        limits.check_text(Path("a.stl"), b"SOLID a\n" + 21 * facet)


def test_a_binary_file_that_speaks_of_facets_is_counted_as_binary(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MAX_TRIANGLES", 40)
    content = b"solid".ljust(84) + bytes(50 * 40) + b"facet".ljust(50)
    with pytest.raises(UserError, match="41 triangles"):
        limits.check_text(Path("a.stl"), content)


def test_a_binary_file_may_be_named_as_text_begins(tmp_path: Path) -> None:
    """As of a solid, which some programs write before its name, and of what is faceted."""
    assert colours(tmp_path, b"solid faceted vase", [MARK | RED_LAST, MARK]) is not None
    assert len(load_model_file(tmp_path / "a.stl", "z").parts[0].triangles) == 2


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("name", ["vertex cover", "a solid vertex 1 2 3", ""])
def test_a_solid_may_have_any_name(tmp_path: Path, name: str, line_end: str) -> None:
    corners = "".join(f"    vertex {place}\n" for place in ("0 0 0", "1 0 0", "0 1 0"))
    facet = f"  facet normal 0 0 1\n   outer loop\n{corners}   endloop\n  endfacet\n"
    text = 2 * f"solid {name}\n{facet}endsolid {name}\n"
    (tmp_path / "a.stl").write_text(text, newline=line_end)
    model = load_model_file(tmp_path / "a.stl", "z")
    np.testing.assert_array_equal(model.bounds, [(0, 0, 0), (1, 1, 0)])


@pytest.mark.parametrize("facet_end", [" ", "\n"])
@pytest.mark.parametrize("spelled", [str.lower, str.upper, str.title])
def test_lines_are_free(tmp_path: Path, spelled: Callable[[str], str], facet_end: str) -> None:
    """A facet, or all of a file, may stand on one."""
    loop = "outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop"
    text = facet_end.join(["solid a facet", f"facet normal 0 0 1 {loop} endfacet", "endsolid a"])
    (tmp_path / "a.stl").write_text(spelled(text))
    model = load_model_file(tmp_path / "a.stl", "z")
    np.testing.assert_array_equal(model.bounds, [(0, 0, 0), (1, 1, 0)])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"solid", "neither text STL nor binary STL"),
        (bytes(83), "neither text STL nor binary STL"),
        (bytes(80) + b"\x02\0\0\0" + bytes(99), "its header says 2 triangles, and there are 1"),
        (b"solid a\nfacet\nvertex 0 0 0\nvertex 1 0 0\n", "2 vertices of 6 numbers are no triangles"),
        (b"solid a\nfacet\nvertex 0 0 0\nvertex 1 0\nvertex 0 1 0\n", "3 vertices of 8 numbers are no triangles"),
    ],
)
def test_what_holds_no_triangles_is_said(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "a.stl").write_bytes(content)
    with pytest.raises(UserError, match=said):
        load_model_file(tmp_path / "a.stl")
