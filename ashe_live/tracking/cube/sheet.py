"""The sheet that a cube is folded from: its net with flaps and fold lines, in true size."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ashe_live.errors import UserError
from ashe_live.tracking.cube.faces import FACES, TAG_SHARE, Face
from ashe_live.tracking.families.layout import Layout
from ashe_live.tracking.families.page import PAPERS_MM, PRINTER_EDGE_MM, Millimetres, PrintedPage, check_page_file

ROWS, COLUMNS = 4, 3
SMALLEST_MM = 30
FLAP_MM = 7.0
# How far a flap's end lies inwards of its base's: it must not come through the fold beside it.
SLANT = 0.7
FOLD_INK, NUMBER_INK = 150, 110
DASH_MM = 2.0
WORDS = "cut, crease, fold, glue, stand"
ADVICE = (
    "print at 100 %, do not scale:",
    "the ruler is 100 mm long",
    "matt, stiff paper",
    "print outwards, plain face down",
)

Line = tuple[Millimetres, Millimetres]


def write_cube_sheet(path: Path, cube: Layout, edge_m: float, paper: str = "a4", overwrite: bool = False) -> None:
    """Writes a PDF or PNG page, by `path`'s suffix, with the net of a cube of `edge_m` when printed at 100 %.

    paper: one of PAPERS_MM. Raises UserError for another suffix, an existing file (without `overwrite`), an edge that
    does not fit the page or is too short to fold, or a place that cannot be written.
    """
    edge_mm = 1000 * edge_m
    check_page_file(path, overwrite)
    size_mm = PAPERS_MM[paper][0]
    most_mm = largest_edge_mm(paper)
    if not SMALLEST_MM <= edge_mm <= most_mm:
        remedy = f"choose --side from {SMALLEST_MM / 1000:g} to {most_mm / 1000:g}"
        larger = ", or --paper a3" if most_mm < edge_mm <= largest_edge_mm("a3") else ""
        fault = "is too small to be folded and seen" if edge_mm < SMALLEST_MM else f"does not fit on {paper}"
        raise UserError(f"a cube of {edge_m:g} m {fault}", remedy + larger)
    page = PrintedPage.blank(size_mm)
    net = _Net(((size_mm[0] - COLUMNS * edge_mm) / 2, (size_mm[1] - ROWS * edge_mm - FLAP_MM) / 2), edge_mm)
    for number, (face, member) in enumerate(zip(FACES, cube.members, strict=True), 1):
        x, y = net.corner(face.row, face.column)
        margin = (1 - TAG_SHARE) / 2 * edge_mm
        bitmap = member.marker.bitmap(page.px(TAG_SHARE * edge_mm))
        page.picture(np.rot90(bitmap, face.turns), (x + margin, y + margin))
        page.text(net.lower_left(face, margin / 2), str(number), 0.35 * margin, ink=NUMBER_INK)
    for line in net.cuts():
        page.line(*line, width_mm=0.2)
    for start, end in net.folds():
        for dash in _dashes(start, end):
            page.line(*dash, width_mm=0.15, ink=FOLD_INK)
    _write_words(page, net, cube.spec)
    page.write(path, overwrite, f"{cube.spec}   {edge_mm:g} mm")


def largest_edge_mm(paper: str) -> int:
    """The largest edge of a cube whose net fits on the paper, in whole millimetres."""
    width, height = (side - 2 * PRINTER_EDGE_MM for side in PAPERS_MM[paper][0])
    return int(min(width / COLUMNS, (height - FLAP_MM) / ROWS))


class _Net:
    """The cross of six squares: four in the middle column, from back over top and front to bottom, and two arms."""

    def __init__(self, top_left_mm: Millimetres, edge_mm: float) -> None:
        self.top_left_mm = top_left_mm
        self.edge_mm = edge_mm

    def corner(self, row: float, column: float) -> Millimetres:
        """The corner where a row and a column begin."""
        left, top = self.top_left_mm
        return left + column * self.edge_mm, top + row * self.edge_mm

    def lower_left(self, face: Face, inwards_mm: float) -> Millimetres:
        """The place `inwards_mm` from both sides at the lower left of the upright print."""
        # The page's x right, y down; the print's lower left turned counter-clockwise about the face's centre.
        aside = self.edge_mm / 2 - inwards_mm
        from_middle = -aside, aside
        for _ in range(face.turns):
            from_middle = from_middle[1], -from_middle[0]
        x, y = self.corner(face.row + 0.5, face.column + 0.5)
        return x + from_middle[0], y + from_middle[1]

    def folds(self) -> Iterator[Line]:
        """Where the paper is creased: between faces, and at the flaps' bases."""
        for row in (1, 2, 3):
            yield self.corner(row, 1), self.corner(row, 2)
        for column in (1, 2):
            yield self.corner(1, column), self.corner(2, column)
        for base, _ in self._flaps():
            yield base

    def cuts(self) -> Iterator[Line]:
        """The net's outline."""
        free = [((0, 1), (0, 2)), ((0, 1), (1, 1)), ((0, 2), (1, 2)), ((2, 1), (3, 1)), ((2, 2), (3, 2))]
        free += [((1, 0), (2, 0)), ((1, 3), (2, 3))]
        for begin, stop in free:
            yield self.corner(*begin), self.corner(*stop)
        for (start, end), (x, y) in self._flaps():
            along = np.subtract(end, start) / self.edge_mm
            begins = np.add(start, FLAP_MM * (np.array((x, y)) + SLANT * along))
            ends = np.add(end, FLAP_MM * (np.array((x, y)) - SLANT * along))
            first, last = (begins[0], begins[1]), (ends[0], ends[1])
            yield from ((start, first), (first, last), (last, end))

    def _flaps(self) -> Iterator[tuple[Line, Millimetres]]:
        """Each flap's base, and which way it hangs out."""
        for column in (0, 2):
            for row, way in ((1, -1.0), (2, 1.0)):
                yield (self.corner(row, column), self.corner(row, column + 1)), (0.0, way)
        for column, way in ((1, -1.0), (2, 1.0)):
            yield (self.corner(3, column), self.corner(4, column)), (way, 0.0)
        yield (self.corner(4, 1), self.corner(4, 2)), (0.0, 1.0)


def _dashes(start: Millimetres, end: Millimetres) -> Iterator[Line]:
    begin, way = np.array(start), np.subtract(end, start)
    count = int(np.hypot(*way) / (2 * DASH_MM))
    for number in range(count):
        first, last = begin + way * number / count, begin + way * (number + 0.5) / count
        yield (first[0], first[1]), (last[0], last[1])


def _write_words(page: PrintedPage, net: _Net, spec: str) -> None:
    """Where the cross leaves the page white: the ruler to the left below, the words to the right."""
    left, right = net.corner(2, 2)[0] + FLAP_MM, page.width_mm - PRINTER_EDGE_MM
    x, y, room = (left + right) / 2, net.corner(2, 2)[1] + 18, right - left - 6
    for number, (words, height) in enumerate([(WORDS, 4.0), *((advice, 3.5) for advice in ADVICE)]):
        page.text((x, y + 7 * number), words, height, room)
    use = f"ashe-live --marker {spec} --marker-size {net.edge_mm / 1000:g}"
    page.text((x, y + 7 * (len(ADVICE) + 2)), use, 3.5, room)
    page.ruler((PRINTER_EDGE_MM + 17, page.height_mm - PRINTER_EDGE_MM - 104), upright=True)
