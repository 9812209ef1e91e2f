"""Which markers of the known families a picture shows, whichever one is looked for."""

from collections.abc import Sequence
from itertools import product

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.process.messages import listed
from ashe_live.tracking.cube.faces import CUBE, CUBE_SPECS
from ashe_live.tracking.edges.corners import refined_corners
from ashe_live.tracking.edges.quads import MIN_SIDE_PX as LEAST_SIDE_PX
from ashe_live.tracking.edges.quads import dark_quads, ink_in, ink_quads, on_lighter, without_repeats
from ashe_live.tracking.edges.squares import is_front_of_square
from ashe_live.tracking.families.cells import reader_of
from ashe_live.tracking.families.dictionary_marker import DICTIONARIES, EDGE_SAMPLES, DictionaryMarker
from ashe_live.tracking.families.layout import cube_layout, in_words

# Long codes first: a chance likeness to one of the short ones is no news where a long one is read.
FAMILIES = ("apriltag_36h11", "7x7_1000", "6x6_1000", "5x5_1000", "4x4_250")
# Only where none of these is seen, as few people print them; nor in mirror image, in which 4x4_50:0 is 4x4_1000:871.
# Random cells are one of a thousand short codes in 6 % of cases, and number 0 of the original family is a stripe, as
# many a thing has.
OTHER_FAMILIES = ("mip_36h12", "apriltag_36h10", "apriltag_25h9", "original", "apriltag_16h5", "4x4_1000")
SIZES = (50, 100, 250, 1000)  # of each ArUco family; the smaller ones are the beginning of the larger
MIN_SIDE_PX = 20.0
MOST_PX = 1280  # of the longer side: what is larger is looked at reduced
CELL_WINDOW_PX = 101  # reaches white from within a marker's black, where that is up to three cells wide
# Largest share of the black border's cells that may be white: photos of other square things have more.
WRONG_IN_BORDER = 0.1
# Least number of the cube's tags that count as a cube: a single one may lie flat on a table.
FACES_OF_CUBE = 2
NAMED = 4  # of the markers in view


def markers_in_view(image_bgr: Image) -> tuple[str, ...]:
    """Specs such as "aruco:4x4_50:7" of the markers in (h, w, 3) uint8 sRGB, the largest first; two faces are a cube.

    Equal ones are named once. For a person who does not know which one it is: what random cells are as like to is
    passed over.
    """
    grey = _looked_at(image_bgr)
    found = _read(grey)
    if not found:
        found = _read_cell_by_cell(grey, OTHER_FAMILIES)
        if found and _read(_mirrored(grey)):
            return ()
    return _specs(found, grey)


def mirrored_in_view(image_bgr: Image) -> tuple[str, ...]:
    """The same of the markers that a picture shows in mirror image, as some programs deliver a webcam's pictures.

    For pictures in which there is no marker: a few are the mirror images of others.
    """
    mirrored = _mirrored(_looked_at(image_bgr))
    return _specs(_read(mirrored), mirrored)


def in_view_text(specs: Sequence[str]) -> str:
    """Such as "aruco:4x4_50:7 and the paper cube are in view": of a calibration board's 28 markers the first few."""
    return f"{listed(map(in_words, specs), NAMED)} {'is' if len(specs) == 1 else 'are'} in view"


def mirrored_text(specs: Sequence[str]) -> str:
    """As `in_view_text`, of markers that are seen in mirror image, and what helps."""
    return f"{in_view_text(specs)}, but in mirror image: switch off what mirrors the camera's picture"


def _looked_at(image_bgr: Image) -> Image:
    """(h, w) grey of the picture, reduced where it is large."""
    grey: Image = np.asarray(cv2.cvtColor(image_bgr, cv2.COLOR_BGR2GRAY), dtype=np.uint8)
    scale = min(1.0, max(MOST_PX / max(grey.shape), 1 / min(grey.shape)))  # a row of pixels is left of the narrowest
    if scale < 1:
        grey = np.asarray(cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    return grey


def _mirrored(grey: Image) -> Image:
    return np.ascontiguousarray(grey[:, ::-1])


def _read(grey: Image) -> list[tuple[Float, str]]:
    """Corners (4, 2) and specs of the markers of FAMILIES in `grey` (h, w)."""
    return _with_others(_read_as_a_whole(grey), _read_cell_by_cell(grey, FAMILIES))


def _specs(found: list[tuple[Float, str]], grey: Image) -> tuple[str, ...]:
    """Without their corners, the largest first, each once; two faces of the cube in `grey` (h, w) are one cube."""
    found.sort(key=lambda one: -cv2.contourArea(one[0].astype("float32")))
    specs = list(dict.fromkeys(spec for _, spec in found))
    seen = [spec for spec in specs if spec in CUBE_SPECS]
    if not seen or (len(seen) < FACES_OF_CUBE and not _shows_another_face(grey, seen)):
        return tuple(specs)
    return tuple(dict.fromkeys(CUBE if spec in CUBE_SPECS else spec for spec in specs))


def _shows_another_face(grey: Image, seen: Sequence[str]) -> bool:
    """Whether `grey` (h, w) shows a face of the cube beside those `seen`, looked for by its number, as a tracker does.

    From above the sides are small and seen at a slant, so that what looks for any marker reads the top alone.
    """
    markers = (member.marker for member in cube_layout().members if member.marker.spec not in seen)
    others = [marker for marker in markers if isinstance(marker, DictionaryMarker)]
    return any(others[0].find_several(others, grey, LEAST_SIDE_PX, thorough=True))


def _read_as_a_whole(grey: Image) -> list[tuple[Float, str]]:
    """Corners (4, 2) and specs of the markers in `grey` (h, w) that lie on lighter surroundings.

    By grey levels first; where a deep shadow's edge crosses a marker, it is readable by what is ink and what is not.
    """
    found: list[tuple[Float, str]] = []
    quads = on_lighter(grey, [*dark_quads(grey, MIN_SIDE_PX), *ink_quads(grey, MIN_SIDE_PX)])
    readable = grey, np.asarray(255 - ink_in(grey, CELL_WINDOW_PX), dtype=np.uint8)
    for quad in without_repeats([quad for quad in quads if is_front_of_square(quad)]):
        corners = refined_corners(grey, quad, EDGE_SAMPLES)
        for picture, family in product(readable, FAMILIES):
            number = reader_of(DICTIONARIES[family]).number(picture, corners)
            if number is not None:
                found.append((corners, _spec(family, number)))
                break
    return found


def _read_cell_by_cell(grey: Image, families: Sequence[str]) -> list[tuple[Float, str]]:
    """The same by OpenCV's detector, which finds some other squares; no cell may be wrong."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.minMarkerPerimeterRate = min(1.0, 4 * MIN_SIDE_PX / max(grey.shape))
    parameters.errorCorrectionRate = 0.0
    parameters.maxErroneousBitsInBorderRate = WRONG_IN_BORDER
    found: list[tuple[Float, str]] = []
    for family in families:
        dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARIES[family])
        quads, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(grey)
        numbers: list[int] = [] if ids is None else [int(number) for number in ids.ravel()]
        corners = [quad.reshape(4, 2).astype(float) for quad in quads]
        read = [(each, _spec(family, number)) for each, number in zip(corners, numbers, strict=True)]
        found = _with_others(found, [one for one in read if on_lighter(grey, [one[0]])])
    return found


def _with_others(found: list[tuple[Float, str]], others: list[tuple[Float, str]]) -> list[tuple[Float, str]]:
    """`found`, and of the others those that lie elsewhere."""
    both = [*found, *others]
    kept = {id(corners) for corners in without_repeats([corners for corners, _ in both])}
    return [one for one in both if id(one[0]) in kept]


def _spec(family: str, number: int) -> str:
    if family.startswith("apriltag_"):
        return f"apriltag:{family.removeprefix('apriltag_')}:{number}"
    cells, _, size = family.partition("_")
    if not size.isdecimal():
        return f"aruco:{family}:{number}"
    return f"aruco:{cells}_{next(one for one in SIZES if number < one)}:{number}"
