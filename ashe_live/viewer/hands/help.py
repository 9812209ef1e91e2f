"""The table of keys as it is shown in the window: on one page, or on several where one would be too small to read."""

from itertools import pairwise

from ashe_live.render.hud import GAP_PT, MIN_FONT_PX, Rows, fits, in_two
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.controls import help_rows

LEGIBLE_PT = 9.0  # least size of letters, for which the rows are spread over several pages
FEWEST_ROWS = 3  # on a page, even if its letters are smaller than that


class Help:
    """Which page is shown, if any."""

    def __init__(self) -> None:
        self.is_shown = False
        self._page = 0
        self._pages = 1  # how many there were when it was last drawn

    def turn(self) -> None:
        """Shows the first page, then the next; hides the last one."""
        if self.is_shown and self._page < self._pages - 1:
            self._page += 1
        else:
            self.is_shown, self._page = not self.is_shown, 0

    def close(self) -> None:
        self.is_shown, self._page = False, 0

    def rows(self, screen: Screen) -> Rows:
        """The rows of the page that is shown."""
        pages = pages_of(help_rows(), screen)
        self._pages = len(pages)
        self._page = min(self._page, len(pages) - 1)  # the window may have grown
        return pages[self._page]


def pages_of(rows: Rows, screen: Screen) -> tuple[Rows, ...]:
    """As few pages as hold all rows in legible letters; where there are several, each says how to get to the next."""
    size, gap = screen.size, screen.px(GAP_PT)
    pages: tuple[Rows, ...] = (rows,)
    for font_px in (LEGIBLE_PT * screen.content_scale, MIN_FONT_PX):
        for count in range(1, max(1, len(rows) // FEWEST_ROWS) + 1):
            pages = _parted(rows, count)
            if all(fits(page, font_px, size, gap) or fits(in_two(page), font_px, size, gap) for page in pages):
                return pages
    return pages


def _parted(rows: Rows, count: int) -> tuple[Rows, ...]:
    begins = [len(rows) * page // count for page in range(count + 1)]
    parts = [rows[begin:end] for begin, end in pairwise(begins)]
    goes_on = [(("H", f"page {page + 1} of {count}: the next"),) for page in range(count - 1)]
    return tuple(part + more for part, more in zip(parts, [*goes_on, ()], strict=True))
