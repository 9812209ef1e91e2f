"""A white page to draw on in true size, and how it is written."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import PIL.Image
import PIL.ImageDraw

from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.fonts import lettering
from ashe_live.files.new_file import check_output
from ashe_live.files.writing import written_whole
from ashe_live.process.messages import printable

SUFFIXES = (".pdf", ".png")
# Portrait pages by the paper that a printer has, from that paper to the largest of its series: ISO 216 and ANSI Y14.1.
ISO_MM = ((210, 297), (297, 420), (420, 594), (594, 841), (841, 1189))
ANSI_MM = ((215.9, 279.4), (279.4, 431.8), (431.8, 558.8), (558.8, 863.6), (863.6, 1117.6))
PAPERS_MM: Mapping[str, tuple[tuple[float, float], ...]] = {"a4": ISO_MM, "letter": ANSI_MM, "a3": ISO_MM[1:]}
# As shops call them.
NAMES = dict(
    zip(
        (*ISO_MM, *ANSI_MM),
        ("A4", "A3", "A2", "A1", "A0", "letter", "tabloid", "ANSI C", "ANSI D", "ANSI E"),
        strict=True,
    )
)
FINEST_DPI, FINEST_WIDTH_MM = 600, 210  # larger pages have about as many pixels
PRINTER_EDGE_MM = 8
INCH_MM = 25.4
INK = 0
PAPER = 255

Millimetres = tuple[float, float]  # from the page's top-left corner


@dataclass(frozen=True, slots=True)
class PrintedPage:
    """A white page to draw on, measured in millimetres from its top-left corner."""

    image: PIL.Image.Image
    dpi: int

    @classmethod
    def blank(cls, size_mm: Millimetres) -> "PrintedPage":
        dpi = round(FINEST_DPI * min(1, FINEST_WIDTH_MM / size_mm[0]))
        width, height = (round(side / INCH_MM * dpi) for side in size_mm)
        return cls(PIL.Image.new("L", (width, height), PAPER), dpi)

    @property
    def width_mm(self) -> float:
        return self.image.width / self.dpi * INCH_MM

    @property
    def height_mm(self) -> float:
        return self.image.height / self.dpi * INCH_MM

    def px(self, mm: float) -> int:
        return round(mm / INCH_MM * self.dpi)

    def picture(self, grey: Image, top_left_mm: Millimetres) -> None:
        self.image.paste(
            PIL.Image.fromarray(np.ascontiguousarray(grey)), (self.px(top_left_mm[0]), self.px(top_left_mm[1]))
        )

    def line(self, start_mm: Millimetres, end_mm: Millimetres, width_mm: float = 0.25, ink: int = INK) -> None:
        ends = [(self.px(x), self.px(y)) for x, y in (start_mm, end_mm)]
        PIL.ImageDraw.Draw(self.image).line(ends, fill=ink, width=max(1, self.px(width_mm)))

    def text(
        self, centre_mm: Millimetres, words: str, height_mm: float = 4.0, room_mm: float | None = None, ink: int = INK
    ) -> None:
        """Words centred on a point, made smaller where they need more room than there is: the page's, or `room_mm`."""
        words = printable(words)  # a file's name may have several lines, or bytes that are no text
        draw = PIL.ImageDraw.Draw(self.image)
        room = self.image.width - 2 * self.px(PRINTER_EDGE_MM) if room_mm is None else self.px(room_mm)
        size = float(self.px(height_mm))
        words, font = lettering(words, size)
        # Again and again, as letters keep to whole pixels: those of half the size may need more than half the room.
        while (length := draw.textlength(words, font)) > room and size > 1:
            size = max(1.0, 0.99 * size * room / length)
            words, font = lettering(words, size)
        draw.text((self.px(centre_mm[0]), self.px(centre_mm[1])), words, fill=ink, font=font, anchor="mm")

    def ruler(self, start_mm: Millimetres, upright: bool = False) -> None:
        """A line of 100 mm to the right, or downwards, with a tick every 10 mm and labels at 0, 50 and 100."""

        def at(along: float, aside: float) -> Millimetres:
            x, y = start_mm
            return (x + aside, y + along) if upright else (x + along, y - aside)

        self.line(at(0, 0), at(100, 0))
        for mm in range(0, 101, 10):
            self.line(at(mm, 3.0 if mm % 50 == 0 else 1.5), at(mm, 0))
        for mm, label in ((0, "0"), (50, "50"), (100, "100 mm")):
            self.text(at(mm, -9 if upright else -4), label, 3.5)

    def write(self, path: Path, overwrite: bool, title: str) -> None:
        """As a PDF or PNG by `path`'s suffix. Raises UserError for a place that cannot be written."""
        with written_whole(path, overwrite) as file:
            if path.suffix.lower() == ".pdf":
                self.image.save(file.stream, "PDF", resolution=self.dpi, quality=95, title=printable(title))
            else:
                self.image.save(file.stream, "PNG", dpi=(self.dpi, self.dpi))


def larger_than(paper: str, page_mm: Millimetres) -> str:
    """In words, what paper a page needs that is larger than `paper`, one of PAPERS_MM; nothing for one that is not."""
    usual, *larger = PAPERS_MM[paper]
    needed = min((usual, *larger), key=lambda size_mm: abs(size_mm[0] - page_mm[0]))  # a page has whole pixels
    if needed == usual:
        return ""
    width, height = needed
    return f" on {NAMES[needed]} paper ({width:.0f} x {height:.0f} mm), as {NAMES[usual]} is too small"


def check_page_file(path: Path, overwrite: bool) -> None:
    """Raises UserError for a suffix that pages do not have, or an existing file (without `overwrite`)."""
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(f"cannot print to {path.name!r}", "name a .pdf or a .png file")
    check_output(path, overwrite)
