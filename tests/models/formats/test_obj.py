"""OBJ and MTL as programs write them: what a person sees there is seen here."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ashe_live.core.colour import linear_from_srgb
from ashe_live.errors import UserError
from ashe_live.models.formats.polygons import triangulated
from ashe_live.models.loading import load_model_file
from ashe_live.models.material import NO_COORDINATES, UNKNOWN, Alpha, Material
from ashe_live.models.mesh import Model, face_normals
from ashe_live.models.parsing.limits import MAX_NAMED_FILES
from ashe_live.models.parsing.notes import WITHOUT_COORDINATES

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"


def read(folder: Path, text: str, **materials: str) -> Model:
    for name, lines in materials.items():
        (folder / f"{name}.mtl").write_text(lines)
    (folder / "a.obj").write_text(text)
    return load_model_file(folder / "a.obj")


def surface(folder: Path, lines: str) -> Material:
    return read(folder, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=f"newmtl m\n{lines}\n").parts[0].material


def area(model: Model) -> float:
    return sum(float(np.linalg.norm(face_normals(p.vertices, p.triangles), axis=1).sum()) / 2 for p in model.parts)


@pytest.mark.parametrize(
    ("line", "opacity"), [("d 0.25", 0.25), ("Tr 0.75", 0.25), ("d -halo 0.25", 0.25), ("Tr 0", 1), ("Tr x", 1)]
)
def test_opacity_is_said_in_either_of_two_ways(tmp_path: Path, line: str, opacity: float) -> None:
    material = surface(tmp_path, f"Kd 1 0 0\n{line}")
    assert material.base_colour == pytest.approx((1, 0, 0, opacity))
    assert material.alpha is (Alpha.BLEND if opacity < 1 else Alpha.OPAQUE)


def test_a_picture_keeps_the_opacity_beside_it(tmp_path: Path) -> None:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    material = surface(tmp_path, "Kd 0.1 0.1 0.1\nd 0.5\nmap_Kd red.png")
    assert material.base_colour == (1, 1, 1, 0.5)
    assert material.alpha is Alpha.BLEND


def test_a_mask_cuts_its_picture_out(tmp_path: Path) -> None:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    Image.fromarray(np.uint8([[0, 255], [255, 255]])).save(tmp_path / "mask.png")
    material = surface(tmp_path, "map_Kd red.png\nmap_d mask.png")
    assert material.alpha is Alpha.CUT_OUT
    np.testing.assert_array_equal(material.base_map[..., 3], [[0, 255], [255, 255]])


def test_of_a_picture_and_its_mask_nothing_but_their_opacity_is_of_the_material(tmp_path: Path) -> None:
    """Nor does the mask lie otherwise than the picture."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    Image.fromarray(np.uint8([[0, 255], [255, 255]])).save(tmp_path / "mask.png")
    material = surface(tmp_path, "Kd 0.1 0.1 0.1\nd 0.5\nmap_Kd -s 2 2 red.png\nmap_d -s 3 3 mask.png")
    assert material.base_colour == (1, 1, 1, 0.5)
    assert material.layout("base_map").matrix == (2, 0, 0, 0, 2, 0)


@pytest.mark.parametrize(
    ("picture", "mask", "is_said"),
    [
        ("red.png", "-s 3 3 mask.png", True),
        ("-s 3 3 red.png", "mask.png", True),
        ("-s 3 3 red.png", "-s 3 3 1 mask.png", False),
        ("red.png", "-s 3 3 red.png", False),  # by which nothing is cut out
        ("gone.png", "-s 3 3 mask.png", False),
    ],
)
def test_a_mask_that_lies_otherwise_than_its_picture_is_said(
    tmp_path: Path, picture: str, mask: str, is_said: bool
) -> None:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    Image.fromarray(np.uint8([[0, 255], [255, 255]])).save(tmp_path / "mask.png")
    library = f"newmtl m\nmap_Kd {picture}\nmap_d {mask}\n"
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=library)
    assert any(note.startswith("a mask of holes (map_d) is enlarged") for note in model.notes) is is_said


@pytest.mark.parametrize("key", ["map_Tr", "map_opacity", "map_Pc", "MAP_Ps"])
def test_maps_that_the_format_does_not_know_are_said_to_be_left_out(tmp_path: Path, key: str) -> None:
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=f"newmtl m\nKd 1 0 0\n{key} a.png\n")
    assert model.notes == (f"{key.lower()} of its materials is left out",)
    assert not read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=f"newmtl m\n{key}\nmap_aat on\n").notes


def test_what_is_black_is_black_unless_a_picture_is_missing_there(tmp_path: Path) -> None:
    assert surface(tmp_path, "Kd 0 0 0").base_colour == (0, 0, 0, 1)
    Image.new("L", (2, 2), 255).save(tmp_path / "mask.png")
    assert surface(tmp_path, "Kd 0 0 0\nmap_d mask.png").base_colour == (0, 0, 0, 1)
    assert surface(tmp_path, "Kd 0 0 0\nmap_Kd gone.png").base_colour == UNKNOWN.base_colour


@pytest.mark.parametrize("line", ["map_Kd", "map_Kd ", "map_d", 'map_Kd ""', "map_Kd -s 1 1 1", "bump ", "Kd"])
def test_a_line_that_goes_on_with_nothing_says_nothing(tmp_path: Path, line: str) -> None:
    """As exporters write where a material has no picture."""
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=f"newmtl m\nKd 1 0 0\n{line}\n")
    found, plain = model.parts[0].material, surface(tmp_path, "Kd 1 0 0")
    assert (found.base_colour, found.roughness, found.alpha) == (plain.base_colour, plain.roughness, plain.alpha)
    assert found.base_map is None
    assert not model.notes


@pytest.mark.parametrize("name", ["maps/", "maps", ".", "D:\\work\\maps\\"])
def test_a_picture_that_is_a_folder_is_left_out_and_said(tmp_path: Path, name: str) -> None:
    """As the others that are not there."""
    (tmp_path / "maps").mkdir()
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=f"newmtl m\nKd 1 0 0\nmap_Kd {name}\n")
    assert model.parts[0].material.base_colour == (1, 0, 0, 1)
    (note,) = model.notes
    assert note.endswith("is not beside it, and is left out")


@pytest.mark.parametrize("line", ["mtllib", "mtllib maps", 'mtllib ""'])
def test_a_library_that_is_none_is_as_if_it_were_missing(tmp_path: Path, line: str) -> None:
    (tmp_path / "maps").mkdir()
    model = read(tmp_path, f"{line}\nusemtl m\n{TRIANGLE}")
    assert model.parts[0].material.base_colour == UNKNOWN.base_colour
    (note,) = model.notes
    assert note.endswith("it is drawn as plain plastic")


def test_a_picture_that_is_seen_nowhere_is_as_it_is(tmp_path: Path) -> None:
    """As a slot that the artist left empty: there is no seen colour to fill it with."""
    Image.new("RGBA", (4, 2), (9, 8, 7, 0)).save(tmp_path / "clear.png")
    np.testing.assert_array_equal(surface(tmp_path, "map_Kd clear.png").base_map, np.full((2, 4, 4), (9, 8, 7, 0)))


def test_one_missing_picture_of_many_materials_is_said_once(tmp_path: Path) -> None:
    """And looked for once, as a model may name so many files only."""
    names = range(MAX_NAMED_FILES + 1)
    library = "".join(f"newmtl m{number}\nmap_Kd gone.png\n" for number in names)
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m0\n{TRIANGLE}", a=library)
    assert model.notes == ("its picture gone.png is not beside it, and is left out",)


@pytest.mark.parametrize(("kind", "whole"), [(np.float32, 1.0), (np.uint16, 65535), (np.int32, 65535)])
def test_grey_of_a_deep_picture_is_the_share_that_it_says(tmp_path: Path, kind: type, whole: float) -> None:
    """Fractions, or 16 bits, also where these are kept in more; what is beyond white is white."""
    shares = np.array([[0.0, 0.25, 0.5, 1.0]])
    given = (shares * whole).astype(kind)
    if kind is np.float32:
        given = np.append(given, np.float32([[7.0, -1.0, np.nan]]), axis=1)
        shares = np.append(shares, [[1.0, 0.0, 0.0]], axis=1)
    Image.fromarray(given).save(tmp_path / "grey.tif")
    texels = surface(tmp_path, "map_Kd grey.tif").base_map
    np.testing.assert_allclose(texels[..., 0], 255 * shares, atol=0.51)


def test_a_mask_may_be_smaller_than_its_picture(tmp_path: Path) -> None:
    Image.new("RGB", (8, 4), (255, 0, 0)).save(tmp_path / "red.png")
    Image.fromarray(np.uint8([[0, 0, 255, 255]] * 2)).save(tmp_path / "mask.png")
    material = surface(tmp_path, "map_Kd red.png\nmap_d mask.png")
    assert material.alpha is Alpha.CUT_OUT
    assert (material.base_map[:, :3, 3] < 128).all()
    assert (material.base_map[:, 5:, 3] > 128).all()


def test_a_picture_and_its_mask_are_drawn_at_the_size_of_the_one_that_has_more_texels(tmp_path: Path) -> None:
    Image.new("RGB", (8, 1), (255, 0, 0)).save(tmp_path / "red.png")
    mask = np.uint8(np.indices((4, 4)).sum(axis=0) % 2 * 255)
    Image.fromarray(mask).save(tmp_path / "mask.png")
    material = surface(tmp_path, "map_Kd red.png\nmap_d mask.png")
    np.testing.assert_array_equal(material.base_map[..., 3], mask)


def test_a_mask_may_be_larger_than_its_picture(tmp_path: Path) -> None:
    """As on leaves of one colour, whose shape the mask alone has."""
    Image.new("RGB", (1, 1), (255, 0, 0)).save(tmp_path / "red.png")
    mask = np.uint8(np.indices((8, 16)).sum(axis=0) % 2 * 255)
    Image.fromarray(mask).save(tmp_path / "mask.png")
    material = surface(tmp_path, "map_Kd red.png\nmap_d mask.png")
    assert material.alpha is Alpha.CUT_OUT
    np.testing.assert_array_equal(material.base_map[..., 3], mask)
    assert (material.base_map[..., :3] == (255, 0, 0)).all()


@pytest.mark.parametrize("has_mask", [True, False])
def test_what_is_cut_out_has_the_colours_beside_it(tmp_path: Path, has_mask: bool) -> None:
    """Filtering mixes them in at the rims of leaves, where the black or white around them would be a line."""
    holes = np.zeros((4, 8), np.uint8)
    holes[:, :4] = 255
    colours = np.where(holes[..., None] > 0, np.uint8((30, 160, 40)), np.uint8(0))
    Image.fromarray(colours if has_mask else np.dstack([colours, holes])).save(tmp_path / "leaf.png")
    Image.fromarray(holes).save(tmp_path / "mask.png")
    material = surface(tmp_path, "map_Kd leaf.png" + "\nmap_d mask.png" * has_mask)
    assert material.alpha is Alpha.CUT_OUT
    np.testing.assert_array_equal(material.base_map[..., 3], holes)
    assert (material.base_map[..., :3] == (30, 160, 40)).all()


def test_a_picture_with_its_mask_is_made_once_for_all_materials(tmp_path: Path) -> None:
    """As in an atlas: materials that look alike are drawn as one."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    Image.fromarray(np.uint8([[0, 255], [255, 255]])).save(tmp_path / "mask.png")
    lines = "map_Kd red.png\nmap_d mask.png\n"
    library = f"newmtl m\n{lines}newmtl n\n{lines}newmtl shiny\nNs 900\n{lines}"
    faces = "vt 0 0\nvt 1 0\nvt 0 1\n" + "".join(f"usemtl {name}\nf 1/1 2/2 3/3\n" for name in ("m", "n", "shiny"))
    parts = read(tmp_path, f"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}", a=library).parts
    assert len(parts) == 2
    assert np.shares_memory(*(part.material.base_map for part in parts))


@pytest.mark.parametrize("mask", ["green.png", "./green.png"])
def test_the_picture_of_the_colours_is_a_mask_by_its_alpha_alone(tmp_path: Path, mask: str) -> None:
    """Exporters name one picture for both; green, which has no red, would be all holes."""
    Image.new("RGB", (2, 2), (0, 255, 0)).save(tmp_path / "green.png")
    material = surface(tmp_path, f"map_Kd green.png\nmap_d {mask}")
    assert material.alpha is Alpha.OPAQUE
    np.testing.assert_array_equal(material.base_map, np.tile(np.uint8((0, 255, 0, 255)), (2, 2, 1)))


@pytest.mark.parametrize(
    "name",
    [
        "red.png",
        ".\\red.png",
        "RED.PNG",
        "maps/../red.png",
        "C:\\Users\\me\\models\\red.png",
        "/home/me/models/red.png",
        "../models/Red.png",
        "-s 1 1 1 -o 0 0 red.png",
        "-bm 0.5 red.png",
        "-s 1  1 1   -o 0 0  red.png",
        "-bm\t0.5\tred.png",
        '"red.png"',
    ],
)
def test_a_picture_beside_the_model_is_found(tmp_path: Path, name: str) -> None:
    (tmp_path / "maps").mkdir()
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    assert tuple(surface(tmp_path, f"map_Kd {name}").base_map[0, 0]) == (255, 0, 0, 255)


@pytest.mark.parametrize("name", ["my%20red.png", "100%25.png", "MY%20RED.png"])
def test_a_picture_may_have_a_percent_sign_in_its_name(tmp_path: Path, name: str) -> None:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / name.replace("MY%20RED", "my%20red"))
    assert surface(tmp_path, f"map_Kd {name}").base_map is not None


LETTERS, ACCENTS_APART = "größé.png", "gro\u0308ße\u0301.png"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere both names are of one file")
@pytest.mark.parametrize(
    ("on_disk", "named"),
    [
        (ACCENTS_APART.encode(), LETTERS.encode()),
        (LETTERS.encode(), ACCENTS_APART.encode()),
        (LETTERS.encode(), ACCENTS_APART.upper().replace("SS", "ß").encode()),
        (LETTERS.encode("latin-1"), LETTERS.encode("latin-1")),
        (LETTERS.encode("latin-1"), LETTERS.encode()),
        ("グ.png".encode("gbk"), "グ.png".encode("gbk")),
    ],
)
def test_a_picture_is_found_however_its_letters_are_encoded(tmp_path: Path, on_disk: bytes, named: bytes) -> None:
    """Macs part accents from letters, and archives bring names in the encoding of another system."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    (tmp_path / "red.png").rename(tmp_path / os.fsdecode(on_disk))
    (tmp_path / "a.mtl").write_bytes(b"newmtl m\nmap_Kd " + named)
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}")
    assert model.parts[0].material.base_map is not None
    assert not model.notes


BLENDERS = (r"D:\\work\\", r"..\\", r"\\\\server\\")  # with two backslashes, as it wrote them once
BEFORE = ("D:/work/", "D:/", "//server/work/", "/home/me/", "/", "../", "../../a/b/", *BLENDERS)


@pytest.mark.parametrize("before", BEFORE)
def test_a_picture_in_a_folder_beside_the_model_is_found_by_the_end_of_its_path(tmp_path: Path, before: str) -> None:
    (tmp_path / "Textures").mkdir()
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "Textures" / "my red.png")
    end = "textures/my red.png".replace("/", r"\\" if "\\" in before else "/")
    assert surface(tmp_path, f"map_Kd {before}{end}").base_map is not None


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere both names are of one file")
@pytest.mark.parametrize("name", ["red.png", "RED.png", "Red.png"])
def test_of_names_in_other_capitals_that_which_was_said_counts(tmp_path: Path, name: str) -> None:
    for number, each in enumerate(("red.png", "RED.png", "Red.png")):
        Image.new("RGB", (2, 2), (number, 0, 0)).save(tmp_path / each)
    assert surface(tmp_path, f"map_Kd {name}").base_map[0, 0, 0] == ("red.png", "RED.png", "Red.png").index(name)


@pytest.mark.parametrize("libraries", ["mtllib a.mtl\nmtllib b.mtl", "mtllib a.mtl b.mtl"])
def test_materials_come_from_several_libraries(tmp_path: Path, libraries: str) -> None:
    text = f"{libraries}\nusemtl one\n{TRIANGLE}usemtl two\nf 1/1 3/3 2/2\n"
    model = read(tmp_path, text, a="newmtl one\nKd 1 0 0", b="newmtl two\nKd 0 1 0")
    assert sorted(part.material.base_colour for part in model.parts) == [(0, 1, 0, 1), (1, 0, 0, 1)]


def test_a_library_that_is_missing_is_said_and_plain_plastic_drawn(tmp_path: Path) -> None:
    model = read(tmp_path, f"mtllib gone.mtl\nusemtl m\n{TRIANGLE}")
    assert model.notes == ("its materials gone.mtl are missing: it is drawn as plain plastic",)
    assert model.parts[0].material.metallic == 0


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ("my mug.mtl", ["my mug.mtl"]),
        ('"my mug.mtl"', ["my mug.mtl"]),
        ("a.mtl gone.mtl lost.mtl", ["gone.mtl", "lost.mtl"]),
    ],
)
def test_a_missing_library_is_named_as_the_file_names_it(tmp_path: Path, named: str, said: list[str]) -> None:
    """One with a space in its name was said to be two; of several those are said that are missing."""
    model = read(tmp_path, f"mtllib {named}\nusemtl m\n{TRIANGLE}", a="newmtl m\nKd 1 0 0\n")
    assert model.notes == tuple(f"its materials {name} are missing: it is drawn as plain plastic" for name in said)


def test_what_is_not_drawn_of_a_material_is_said(tmp_path: Path) -> None:
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}l 1 2\n", a="newmtl m\nmap_Bump bumps.png\nKd 1 1 1")
    assert model.notes == ("points and lines are left out", "bump maps of its materials are left out")


L_SHAPE = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
ARROW = [(0, 0), (2, 1), (0, 2), (1, 1)]  # four corners, one of them inwards
SMALL_L = [(0.01 * x, 0.01 * y) for x, y in L_SHAPE]
CORNER_TWICE = [*L_SHAPE[:2], *L_SHAPE[1:]]
WITH_SPIKE = [*L_SHAPE, (0, 5), (0, 3)]


@pytest.mark.parametrize("turn", range(6))
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize(
    ("shape", "size"), [(L_SHAPE, 5.0), (ARROW, 1.0), (CORNER_TWICE, 5.0), (WITH_SPIKE, 5.0), (SMALL_L, 5e-4)]
)
@pytest.mark.parametrize("plane", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_a_polygon_that_is_not_convex_keeps_its_area_and_sense(shape, size, turn, backwards, plane) -> None:
    """Wherever its first corner is, and whichever way it faces."""
    flat = np.roll(np.array(shape, dtype=float), turn, axis=0)[:: -1 if backwards else 1]
    places = np.column_stack([flat, 0.1 * flat.sum(axis=1)])[:, plane]
    triangles = triangulated(places, np.arange(len(places)), np.array([len(places)]))
    normals = face_normals(places.astype(np.float32), triangles)
    whole = np.cross(places, np.roll(places, -1, axis=0)).sum(axis=0)
    has_area = np.linalg.norm(normals, axis=1) > 1e-6 * np.linalg.norm(whole)
    assert (normals[has_area] @ whole > 0).all()
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(np.linalg.norm(whole), rel=1e-6)
    assert np.linalg.norm(whole) == pytest.approx(2 * size * np.sqrt(1.02), rel=1e-6)


def test_a_polygon_that_crosses_itself_has_triangles_of_its_corners() -> None:
    star = np.array([(np.cos(turn), np.sin(turn), 0.0) for turn in np.arange(5) * 0.8 * np.pi])
    triangles = triangulated(star, np.arange(5), np.array([5]))
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4]]
    # It turns both ways, and its halves lie on one another in part: what ears would cover is not what it encloses.
    loop = np.array([(0.0, 0, 0), (4, 0, 0), (4, 3, 0), (1, -1, 0), (0, 3, 0)])
    assert triangulated(loop, np.arange(5), np.array([5])).tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4]]
    line = np.array([(x, 0.0, 0.0) for x in (0, 3, 1, 4, 2)])
    assert triangulated(line, np.arange(5), np.array([5])).shape == (3, 3)


@pytest.mark.parametrize("place", ["nan 1 0", "0 inf 0"])
def test_a_polygon_that_is_at_no_place_is_said(tmp_path: Path, place: str) -> None:
    corners = "".join(f"v {x} {y} 0\n" for x, y in L_SHAPE[:5])
    with pytest.raises(UserError, match="vertices hold a value that is not finite"):
        read(tmp_path, f"{corners}v {place}\nf 1 2 3 4 5 6\n")


def test_faces_of_two_corners_are_no_triangles(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no triangles"):
        read(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 3\n")


def test_polygons_of_all_sizes_stand_beside_one_another(tmp_path: Path) -> None:
    corners = [*L_SHAPE, *((x + 5, y) for x, y in ARROW), (10, 0), (11, 0), (10, 1)]
    text = "".join(f"v {x} {y} 0\n" for x, y in corners)
    model = read(tmp_path, text + "f 1 2 3 4 5 6\nf 7 8 9 10\nf -3 -2 -1\nf 1 2\nf 3\n")
    assert area(model) == pytest.approx(5 + 1 + 0.5)


@pytest.mark.parametrize(
    "face", ["f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/3/1", "f 1/1/1 2//1 3"]
)
def test_corners_are_named_in_every_way(tmp_path: Path, face: str) -> None:
    values = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 -2\n"
    part = read(tmp_path, f"{values}{face}\n").parts[0]
    assert part.triangles.shape == (1, 3)
    assert (part.uvs is not None) == (face.count("/") > 2 and "//" not in face)
    has_normals = face.count("/1 ") > 1 and face.count("/") == 6
    np.testing.assert_allclose(part.normals, [(0, 0, -1 if has_normals else 1)] * 3)


def test_corners_of_several_kinds_in_one_face_are_distinguished(tmp_path: Path) -> None:
    """As many slashes in all as if every corner had one."""
    values = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n"
    part = read(tmp_path, f"{values}f 1/2 3 2/1/1\n").parts[0]
    np.testing.assert_allclose(np.ptp(part.vertices, axis=0).max(), 1)
    assert len(np.unique(part.vertices, axis=0)) == 3


def test_a_place_is_a_corner_for_each_coordinate_and_normal_that_it_has(tmp_path: Path) -> None:
    """A box: sides that meet share coordinates and not normals, both triangles of a side the normal alone."""
    places = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    normals = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    uvs = [(number / 16, number % 4 / 4) for number in range(16)]
    lines = [f"v {x} {y} {z}" for x, y, z in places] + [f"vn {x} {y} {z}" for x, y, z in normals]
    lines += [f"vt {u} {v}" for u, v in uvs]
    expected = set()
    for side, corners in enumerate(sides):
        for half, numbers in enumerate([(0, 1, 2), (0, 2, 3)]):
            named = [(corners[number], 8 * (side % 2) + 4 * half + number, side) for number in numbers]
            expected |= {(*places[v], *uvs[vt], *normals[vn]) for v, vt, vn in named}
            lines.append("f " + " ".join(f"{v + 1}/{vt + 1}/{vn + 1}" for v, vt, vn in named))
    (tmp_path / "a.obj").write_text("\n".join(lines))
    (part,) = load_model_file(tmp_path / "a.obj", "z").parts
    corners = np.hstack([part.vertices, part.uvs, part.normals])[part.triangles].reshape(-1, 8)
    assert set(map(tuple, corners.tolist())) == expected


def test_a_place_may_have_a_weight_and_a_coordinate_may_be_left_out(tmp_path: Path) -> None:
    """The weight is of curves. What is left out of a texture coordinate is 0."""
    text = "v 0 0 0 1\nv 2 0 0 1\nv 0 3 0 0.5\nvt 1\nvt 0.25 0.5 7\nvt 0.5 0.75\nf 1/1 2/2 3/3\n"
    (tmp_path / "a.obj").write_text(text)
    (part,) = load_model_file(tmp_path / "a.obj", "z").parts
    found = dict(zip(map(tuple, part.vertices.tolist()), map(tuple, part.uvs.tolist()), strict=True))
    assert found == {(0, 0, 0): (1, 0), (2, 0, 0): (0.25, 0.5), (0, 3, 0): (0.5, 0.75)}


def test_negative_numbers_count_back_from_the_face(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 9 9 9\nv 9 8 9\nv 8 9 9\nf -3 -2 -1\n"
    model = read(tmp_path, text)
    np.testing.assert_allclose(np.ptp(model.bounds, axis=0), (9, 9, 9))
    assert area(model) == pytest.approx(1)


@pytest.mark.parametrize(
    ("face", "said"),
    [
        ("f 0 1 2", "a face names vertex 0 of 3"),
        ("f 1 2 4", "a face names vertex 4 of 3"),
        ("f -4 1 2", "a face names vertex -4 of 3"),
        ("f 1/2 2/2 3/2", "a face names texture coordinate 2 of 1"),
        ("f 1/-2 2/1 3/1", "a face names texture coordinate -2 of 1"),
        ("f 1//2 2//2 3//2", "a face names normal 2 of 1"),
        ("f a b c", "a word stands where a number belongs"),
        ("f 1.5 2 3", "a face names a vertex by what is no whole number"),
        ("f 1e300 2 3", "a face names a vertex by what is no whole number"),
        ("f", "a face has no corners"),
    ],
)
def test_a_face_of_what_is_not_there_is_said(tmp_path: Path, face: str, said: str) -> None:
    for values in ("", "vt 0 0\nvn 0 0 1\n"):
        of_those = said if values else said.replace("of 1", "of 0")
        with pytest.raises(UserError, match=rf"a\.obj is malformed \({of_those}\)"):
            read(tmp_path, f"v 0 0 0\nv 1 0 0\nv 0 1 0\n{values}{face}\n")


@pytest.mark.parametrize("word", ["1_0", "1\0", "one", "0x1"])
def test_a_word_that_is_no_number_is_said(tmp_path: Path, word: str) -> None:
    with pytest.raises(UserError, match=r"a\.obj is malformed"):
        read(tmp_path, f"v 0 0 0\nv {word} 0 0\nv 0 1 0\nf 1 2 3\n")


def test_colours_behind_the_places_are_of_srgb(tmp_path: Path) -> None:
    part = read(tmp_path, "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n").parts[0]
    np.testing.assert_allclose(part.colours, [(1, 0, 0, 1)] * 3)


def test_colours_behind_the_places_may_be_bytes(tmp_path: Path) -> None:
    """As some scanners write them: all was white. What is dark in bytes is a fraction only where none is bright."""
    text = "v 0 0 0 255 0 51\nv 1 0 0 1 0 0\nv 0 1 0 255 0 51\nf 1 2 3\n"
    part = read(tmp_path, text).parts[0]
    shares = part.colours[np.argsort(part.vertices[:, 0]), :3]
    expected = linear_from_srgb(np.array([(255, 0, 51), (255, 0, 51), (1, 0, 0)]) / 255)
    np.testing.assert_allclose(shares, expected, atol=1e-6)


def test_colours_stand_last_and_behind_all_places_or_are_none(tmp_path: Path) -> None:
    """Of seven numbers the fourth is a weight, and more than full intensity is full."""
    part = read(tmp_path, "v 0 0 0 1 0 2 0\nv 1 0 0 1 0 2 0\nv 0 1 0 1 0 2 0\nf 1 2 3\n").parts[0]
    np.testing.assert_allclose(part.colours, [(0, 1, 0, 1)] * 3)
    model = read(tmp_path, "v 0 0 0 1 0 0\nv 3 0 0\nv 0 2 0\nf 1 2 3\n")
    assert model.parts[0].colours is None
    assert area(model) == 3


def test_colours_are_linear_where_blender_has_written_them(tmp_path: Path) -> None:
    """By its exporter's formulas: 1000 (1 - roughness)^2 as exponent, colours as its shaders have them, metal as Ka."""
    header = "# Blender 4.2.0 MTL File: 'None'\n# www.blender.org\n\n"
    lines = "newmtl m\nNs 90\nKd 0.2 0.5 0.8\nKe 0.1 0 0\nKa 0.75 0.75 0.75\nillum 3\n"
    theirs, others = (
        read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=first + lines).parts[0].material
        for first in (header, "")
    )
    assert theirs.base_colour == pytest.approx((0.2, 0.5, 0.8, 1))
    assert theirs.emissive == pytest.approx((0.1, 0, 0))
    assert (theirs.roughness, theirs.metallic) == pytest.approx((0.7, 0.75))
    assert others.metallic == 0
    rough = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=f"{header}newmtl m\nNs 0\n").parts[0].material
    assert rough.roughness == 1
    assert others.base_colour[1] == pytest.approx(0.214, abs=0.001)  # of sRGB's 0.5


@pytest.mark.parametrize(("illumination", "metallic"), [(1, 0), (2, 0), (3, 1), (4, 0), (5, 0), (6, 1), (7, 0), (9, 0)])
def test_blenders_ambient_colour_is_metal_by_models_of_mirrors_alone(tmp_path, illumination, metallic) -> None:
    """Of all others it is white, whatever the material."""
    library = f"# Blender 4.2.0 MTL File: 'None'\n\nnewmtl m\nNs 250\nKa 1.0 1.0 1.0\nillum {illumination}\n"
    (part,) = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}", a=library).parts
    assert part.material.metallic == metallic


def test_a_picture_without_texture_coordinates_is_said(tmp_path: Path) -> None:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    bare = TRIANGLE.replace("1/1 2/2 3/3", "1 2 3")
    for triangle, is_said in ((bare, True), (TRIANGLE, False)):
        model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{triangle}", a="newmtl m\nmap_Kd red.png\n")
        assert any("texture coordinates" in note for note in model.notes) is is_said


def test_a_picture_is_enlarged_and_shifted_as_its_options_say(tmp_path: Path) -> None:
    """u * s + o, from the bottom left; what is left out of an option is as if nothing was said."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    layout = surface(tmp_path, "map_Kd -o 0.25 0.5 0 -s 2 3 1 -clamp on red.png").layout("base_map")
    at = np.reshape(layout.matrix, (2, 3)) @ (0.5, 0.125, 1.0)
    np.testing.assert_allclose(at, (0.5 * 2 + 0.25, 0.125 * 3 + 0.5))
    assert layout.repeats == (False, False)
    assert surface(tmp_path, "map_Kd -CLAMP On red.png").layout("base_map").repeats == (False, False)
    assert surface(tmp_path, "map_Kd -clamp off red.png").layout("base_map").repeats == (True, True)
    assert surface(tmp_path, "map_Kd -s 4 red.png").layout("base_map").matrix == (4, 0, 0, 0, 1, 0)
    assert surface(tmp_path, "map_Kd red.png").layout("base_map").is_plain


OPTIONS = "blendu off,blendv on,boost 1.5,cc on,clamp off,mm 0.1 0.9,o 0 0 0,s 1 1 1,t 0 0 0,texres 512,bm 1"
CHANNELS = "rgbmlz"  # of -imfchan


@pytest.mark.parametrize("name", ["red.png", "2 red.png", "on red.png", "-x.png"])
@pytest.mark.parametrize("option", [*OPTIONS.split(","), *(f"imfchan {channel}" for channel in CHANNELS)])
def test_options_of_a_picture_end_where_its_name_begins(tmp_path: Path, option: str, name: str) -> None:
    """Which may begin with what could be one more of an option's numbers."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / name)
    material = surface(tmp_path, f"map_Kd -{option} {name}")
    assert material.base_map is not None
    assert material.layout("base_map").is_plain


def test_roughness_and_metal_may_be_said(tmp_path: Path) -> None:
    material = surface(tmp_path, "Kd 1 0 0\nNs 10\nPr 0.25\nPm 0.75")
    assert (material.roughness, material.metallic) == (0.25, 0.75)


def test_an_exponent_is_that_of_a_lobe_as_wide_as_its_roughness_says(tmp_path: Path) -> None:
    """Of Blinn and Phong's exponent n and Beckmann's alpha, the roughness squared: n = 2 / alpha^2 - 2."""
    for exponent in (1, 10, 96, 900):
        alpha = surface(tmp_path, f"Kd 1 0 0\nNs {exponent}").roughness ** 2
        assert 2 / alpha**2 - 2 == pytest.approx(exponent)
    for nothing in ("", "Ns 0", "Ns shiny"):  # which is no exponent, and as if there were no material
        assert surface(tmp_path, f"Kd 1 0 0\n{nothing}").roughness == UNKNOWN.roughness


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_library_may_begin_with_a_byte_order_mark(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 1 0 0\n", encoding=encoding)
    assert read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}").parts[0].material.base_colour == (1, 0, 0, 1)


@pytest.mark.parametrize("line", ["Kd nan 0 0", "Ns 1e999", "map_Kd -s inf 1 1 red.png"])
def test_a_number_of_a_material_that_is_none_is_said(tmp_path: Path, line: str) -> None:
    with pytest.raises(UserError, match=r"a\.obj is malformed \(a material's number is not finite\)"):
        surface(tmp_path, line)


@pytest.mark.parametrize(
    ("line", "colour"),
    [("Kd 0.5", "Kd 0.5 0.5 0.5"), ("Kd 0.5 0.2", "Kd 0.5 0.5 0.5"), ("Kd 3 0 -1\nd 7", "Kd 1 0 0\nd 1")],
)
def test_one_number_is_a_grey_and_nothing_sends_back_more_light_than_falls_on_it(tmp_path, line, colour) -> None:
    assert surface(tmp_path, line).base_colour == surface(tmp_path, colour).base_colour


@pytest.mark.parametrize("value", ["spectral red.rfl", "spectral red.rfl 0.5", "xyz 1 0 0"])
@pytest.mark.parametrize("key", ["Ka", "Kd", "Ke"])
def test_colours_in_other_terms_are_as_if_not_said(tmp_path: Path, key: str, value: str) -> None:
    material = surface(tmp_path, f"{key} {value}")
    assert (material.base_colour, material.emissive) == (surface(tmp_path, "").base_colour, (0, 0, 0))


@pytest.mark.parametrize(
    ("lines", "opacity"),
    [
        ("d 1\nTr 1", 1),
        ("Tr 1\nd 1", 1),
        ("d 0.25\nTr 0.25", 0.25),
        ("Tr 1\nd 0.25", 0.25),
        ("d 0", 0),
        ("d 0\nTr 1", 0),
        ("Tr 0\nd 0", 1),
        ("d 0.25\nTr x", 0.25),
    ],
)
def test_of_two_opacities_that_of_the_format_holds(tmp_path: Path, lines: str, opacity: float) -> None:
    """Where one of both hides what the other shows, it is shown."""
    assert surface(tmp_path, lines).base_colour[3] == opacity


def test_what_meshlab_writes_is_opaque(tmp_path: Path) -> None:
    """`Tr 1.000000` stands in all that it wrote for years: scans and data sets of them were invisible."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "scan.png")
    colours = "Ka 0.200000 0.200000 0.200000\nKd 0.501961 0.501961 0.501961\nKs 1.000000 1.000000 1.000000"
    material = surface(tmp_path, f"{colours}\nTr 1.000000\nillum 2\nNs 0.000000\nmap_Kd scan.png")
    assert material.base_colour == (1, 1, 1, 1)
    assert material.alpha is Alpha.OPAQUE


@pytest.mark.parametrize(
    ("used", "described"),
    [
        ("red # of the mug", "red"),
        ("red", "red # of the mug"),
        ("red\t#", "red # of the mug"),
        ('"red"', "red"),
        ("red", '"red"'),
        ("red\tmug", "red\tmug"),
        ("red  mug", "red mug"),
        ("Material #25", "Material #25 # of the mug"),
    ],
)
def test_a_materials_name_is_found_whatever_stands_around_it(tmp_path: Path, used: str, described: str) -> None:
    library = f"newmtl {described}\nKd 1 0 0\nnewmtl Material #26\nKd 0 1 0\n"
    model = read(tmp_path, f"mtllib a.mtl\nusemtl {used}\n{TRIANGLE}", a=library)
    assert model.parts[0].material.base_colour == (1, 0, 0, 1)
    assert not model.notes


def test_of_materials_of_nearly_one_name_the_very_one_counts_and_else_the_first(tmp_path: Path) -> None:
    library = "".join(f"newmtl {name}\nKd {shade} 0 0\n" for name, shade in (("m # a", 0), ("m # b", 1), ("m", 0)))
    for used, red in (("m # b", 1), ("m", 0), ("m # c", 0)):
        model = read(tmp_path, f"mtllib a.mtl\nusemtl {used}\n{TRIANGLE}", a=library)
        assert model.parts[0].material.base_colour[0] == red
    model = read(tmp_path, f"mtllib a.mtl\nusemtl Material #25\n{TRIANGLE}", a="newmtl Material #26\nKd 1 0 0\n")
    assert model.notes == ("its material Material #25 is in none of its libraries: it is drawn as plain plastic",)


def test_a_material_that_no_library_has_is_said_and_one_that_nothing_uses_is_not(tmp_path: Path) -> None:
    model = read(tmp_path, f"mtllib a.mtl\nusemtl other\nusemtl gone\n{TRIANGLE}", a="newmtl m\nKd 1 0 0\n")
    assert model.notes == ("its material gone is in none of its libraries: it is drawn as plain plastic",)
    assert not read(tmp_path, f"mtllib a.mtl\nusemtl gone\nusemtl m\n{TRIANGLE}", a="newmtl m\nKd 1 0 0\n").notes
    assert not read(tmp_path, f"mtllib a.mtl\n{TRIANGLE}v 0 0 1\nusemtl m\nf 1 2 4\n", a="newmtl m\nKd 1 0 0\n").notes
    assert not read(tmp_path, f"usemtl gone\n{TRIANGLE}").notes
    (tmp_path / "a.mtl").unlink()
    assert len(read(tmp_path, f"mtllib a.mtl\nusemtl gone\n{TRIANGLE}").notes) == 1  # on the library alone


def test_curved_surfaces_are_said_to_be_left_out(tmp_path: Path) -> None:
    curved = "cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 3\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n"
    assert read(tmp_path, TRIANGLE + curved).notes == ("curves and curved surfaces are left out",)
    with pytest.raises(UserError, match="holds no triangles: curves and curved surfaces are left out"):
        read(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + curved)


@pytest.mark.parametrize("picture", ["", "map_Kd gone.png\n"])
def test_a_mask_without_a_picture_cuts_out_the_materials_colour(tmp_path: Path, picture: str) -> None:
    """As of leaves in one green. The mask lies as its own options say."""
    holes = np.uint8([[0, 255], [255, 255]])
    Image.fromarray(holes).save(tmp_path / "mask.png")
    material = surface(tmp_path, f"Kd 0 1 0\n{picture}map_d -s 3 3 3 mask.png")
    assert material.base_colour == (0, 1, 0, 1)
    assert material.alpha is Alpha.CUT_OUT
    np.testing.assert_array_equal(material.base_map[..., 3], holes)
    assert (material.base_map[..., :3] == 255).all()
    assert material.layout("base_map").matrix == (3, 0, 0, 0, 3, 0)
    assert surface(tmp_path, f"Kd 0 1 0\nd 0.5\n{picture}map_d mask.png").alpha is Alpha.BLEND
    (tmp_path / "mask.png").unlink()
    assert surface(tmp_path, f"Kd 0 1 0\n{picture}map_d mask.png").alpha is Alpha.OPAQUE


@pytest.mark.parametrize("libraries", ['"my looks.mtl"', '"b.mtl" "my.mtl"', '"my.mtl" b.mtl'])
def test_the_names_of_libraries_may_be_quoted(tmp_path: Path, libraries: str) -> None:
    model = read(
        tmp_path,
        f"mtllib {libraries}\nusemtl m\n{TRIANGLE}",
        **{"my looks": "newmtl m\nKd 1 0 0\n", "my": "newmtl m\nKd 1 0 0\n", "b": ""},
    )
    assert model.parts[0].material.base_colour == (1, 0, 0, 1)
    assert not model.notes


def test_colours_of_vertices_and_materials_together_are_said(tmp_path: Path) -> None:
    """The format knows the ones alone, and programs differ in what they make of both."""
    coloured = TRIANGLE.replace("v 0 0 0", "v 0 0 0 1 0 0").replace("v 1 0 0", "v 1 0 0 1 0 0")
    coloured = coloured.replace("v 0 1 0", "v 0 1 0 1 0 0")
    assert not read(tmp_path, coloured).notes
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{coloured}", a="newmtl m\nKd 1 0 0\n")
    assert model.notes == ("the colours of its vertices are multiplied with those of its materials",)


@pytest.mark.parametrize("turn", range(4))
def test_a_quad_is_cut_along_the_diagonal_that_is_within_it(turn: int) -> None:
    """An arrowhead keeps its area. Of a quad that crosses itself neither is."""
    arrowhead = np.roll(np.array([(0, 0, 0), (2, 0, 0), (0.5, 0.5, 0), (0, 2, 0)]), turn, axis=0)
    triangles = triangulated(arrowhead, np.arange(4), np.array([4]))
    crosses = face_normals(arrowhead, triangles)
    assert crosses[:, 2] == pytest.approx([1, 1])  # together twice the area, the same side up
    crossed = np.roll(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]), turn, axis=0)
    assert {*map(frozenset, triangulated(crossed, np.arange(4), np.array([4])).tolist())} == {
        frozenset((0, 1, 3)),
        frozenset((1, 2, 3)),
    }  # as Blender cuts it, though either half lies on the other in part


def test_comments_may_stand_behind_numbers(tmp_path: Path) -> None:
    plain = read(tmp_path, TRIANGLE)
    commented = read(tmp_path, "".join(f"{line} # {line}\n" for line in TRIANGLE.splitlines()))
    np.testing.assert_array_equal(plain.parts[0].vertices, commented.parts[0].vertices)
    np.testing.assert_array_equal(plain.parts[0].uvs, commented.parts[0].uvs)


NO_NUMBERS = ("nan", "-nan", "-1.#IND00", "1.#QNAN", "-1.#J", "1.#INF00", "-nan(ind)", "nan(snan)")  # of C libraries


@pytest.mark.parametrize("word", NO_NUMBERS)
@pytest.mark.parametrize("suffix", ["obj", "ply"])
def test_a_normal_that_is_no_number_is_that_of_the_surface(tmp_path: Path, word: str, suffix: str) -> None:
    """Exporters write them for faces without an area, each C library in its own words."""
    normal = f"{word} {word} {word}"
    if suffix == "obj":
        text = f"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn {normal} # none\nvn 0 0 1\nf 1//1 2//2 3//2\n"
    else:
        properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        text = f"ply\nformat ascii 1.0\nelement vertex 3\n{properties}{faces}"
        text += f"0 0 0 {normal}\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"
    (tmp_path / f"a.{suffix}").write_text(text)
    (part,) = load_model_file(tmp_path / f"a.{suffix}", "z").parts
    np.testing.assert_array_equal(part.normals, [(0, 0, 1)] * 3)


def test_words_may_be_parted_by_any_space(tmp_path: Path) -> None:
    """Lines may be indented as well; and in a name # begins no comment."""
    lines = f"mtllib a.mtl\nusemtl a #1\n{TRIANGLE}p 1\n".replace(" ", "\t").replace("a\t#1", "a #1")
    text = "".join(f" \t{line} \n" for line in lines.splitlines())
    model = read(tmp_path, text, a="newmtl a #1\nKd 1 0 0\n")
    assert model.parts[0].material.base_colour == (1, 0, 0, 1)
    assert area(model) == 0.5
    assert model.notes == ("points and lines are left out",)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_comment_that_ends_in_a_backslash_is_one_line(tmp_path: Path, end: str) -> None:
    """As a path of Windows does. A number that goes on in the next line does so whatever ends lines."""
    lines = TRIANGLE.replace("v 1 0 0", f"v 1 \\{end}0 0").replace("\n", end)
    (tmp_path / "a.obj").write_bytes(f"# from C:\\models\\{end}{lines}  # in C:\\{end}f 1/1 2/2 3/3{end}".encode())
    model = load_model_file(tmp_path / "a.obj")
    np.testing.assert_array_equal(model.parts[0].vertices, read(tmp_path, TRIANGLE).parts[0].vertices)
    assert model.triangle_count == 2


@pytest.mark.parametrize("library", ["looks/m.mtl", "looks\\m.mtl"])
@pytest.mark.parametrize("where", ["looks", "."])
def test_a_picture_lies_beside_the_library_that_names_it_or_beside_the_obj(
    tmp_path: Path, library: str, where: str
) -> None:
    (tmp_path / "looks").mkdir()
    (tmp_path / "looks" / "m.mtl").write_text("newmtl m\nmap_Kd red.png\n")
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / where / "red.png")
    model = read(tmp_path, f"mtllib {library}\nusemtl m\n{TRIANGLE}")
    assert model.parts[0].material.base_map is not None
    assert not model.notes


def test_of_two_pictures_of_one_name_that_beside_the_library_counts(tmp_path: Path) -> None:
    (tmp_path / "looks").mkdir()
    (tmp_path / "looks" / "m.mtl").write_text("newmtl m\nmap_Kd a.png\nnewmtl n\nmap_Kd b.png\n")
    for folder, colour in ((tmp_path, (255, 0, 0)), (tmp_path / "looks", (0, 255, 0))):
        Image.new("RGB", (2, 2), colour).save(folder / "a.png")
    model = read(tmp_path, f"mtllib looks/m.mtl\nusemtl m\n{TRIANGLE}v 0 0 1\nusemtl n\nf 1/1 2/2 4/3\n")
    pictured = next(part.material for part in model.parts if part.material.base_map is not None)
    np.testing.assert_array_equal(pictured.base_map[..., :3], np.full((2, 2, 3), (0, 255, 0)))
    assert model.notes == ("its picture b.png is not beside it, and is left out",)


def test_comments_may_stand_behind_a_materials_numbers(tmp_path: Path) -> None:
    lines = "Kd 1.0 0.0 0.0 # red\nKe 0 0 1# glows\nd 0.5 # half\nPr 0.25 # smooth"
    material = surface(tmp_path, lines)
    assert material.base_colour == pytest.approx((1, 0, 0, 0.5))
    assert material.emissive == (0, 0, 1)
    assert material.roughness == 0.25


@pytest.mark.parametrize("name", ["red.png", "red #1.png", "red # 1.png", '"red.png"', "-s 2 2 1.0 red.png"])
@pytest.mark.parametrize("comment", ["# the diffuse map", "\t#it.is.red"])
def test_comments_may_stand_behind_files_names(tmp_path: Path, name: str, comment: str) -> None:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / name.strip('"').removeprefix("-s 2 2 1.0 "))
    library = f"newmtl m\nmap_Kd {name} {comment}\n"
    for libraries in (f"a.mtl {comment}", f"b.mtl a.mtl {comment}"):
        model = read(tmp_path, f"mtllib {libraries}\nusemtl m\n{TRIANGLE}", a=library, b="")
        assert model.parts[0].material.base_map is not None
        assert not model.notes


def test_coordinates_may_be_of_any_number_whatever_they_add_up_to(tmp_path: Path) -> None:
    """Of a texture's three the last two may be left out, and are 0."""
    text = TRIANGLE.replace("vt 0 0\nvt 1 0\nvt 0 1\n", "vt 0 1\nvt 0.5\nvt 1 1 1\nvt 0 0\n").replace("3/3", "3/4")
    (part,) = read(tmp_path, text).parts
    assert sorted(map(tuple, part.uvs)) == [(0, 0), (0, 1), (0.5, 0)]


def test_a_picture_is_seen_wherever_there_are_texture_coordinates(tmp_path: Path) -> None:
    """One object has them; another of the same material has none, and the colour of the picture's corner."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    bare = "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 4 5 6\n"
    model = read(tmp_path, f"mtllib a.mtl\nusemtl m\n{TRIANGLE}{bare}", a="newmtl m\nmap_Kd red.png\n")
    (part,) = model.parts
    assert part.material.base_map is not None
    of_first = part.vertices[:, 0] < 5
    np.testing.assert_array_equal(sorted(map(tuple, part.uvs[of_first])), [(0, 0), (0, 1), (1, 0)])
    np.testing.assert_array_equal(part.uvs[~of_first], [NO_COORDINATES] * 3)
    assert model.notes == (WITHOUT_COORDINATES,)


@pytest.mark.parametrize(
    ("name", "beside"), [("rot…".encode("cp1252"), b""), ("グ".encode("gbk"), b""), ("Grün".encode(), b"\xfcber.png")]
)
def test_names_of_materials_may_be_of_any_encoding(tmp_path: Path, name: bytes, beside: bytes) -> None:
    """Also where a byte of them ends lines of text (0x85), and where a path beside them is of another one."""
    (tmp_path / "a.mtl").write_bytes(b"newmtl other\nbump " + beside + b"\nnewmtl " + name + b"\nKd 1 0 0\n")
    (tmp_path / "a.obj").write_bytes(b"mtllib a.mtl\nusemtl " + name + b"\n" + TRIANGLE.encode())
    model = load_model_file(tmp_path / "a.obj")
    assert model.parts[0].material.base_colour[:3] == (1, 0, 0)
    assert not any("none of its libraries" in note for note in model.notes)
