"""What a bench prints, so that figures are read under their headings."""

from collections.abc import Callable
from typing import Any

from rich.console import Console
from rich.table import Table

Rows = dict[tuple[str, ...], dict[str, str]]


class Printed(Console):
    """Shows nothing; keeps tables, row by row, and lines."""

    def __init__(self, keys: int = 1) -> None:
        super().__init__(quiet=True)
        self._keys = keys  # columns that name a row
        self.tables: list[Rows] = []
        self.titles: list[str] = []
        self.lines: list[str] = []

    def print(self, what: Any = "", **_: Any) -> None:
        if not isinstance(what, Table):
            self.lines.append(what)
            return
        headings = [str(column.header) for column in what.columns]
        rows = zip(*(column.cells for column in what.columns), strict=True)
        self.titles.append(str(what.title))
        self.tables.append(
            {
                row[: self._keys]: dict(zip(headings[self._keys :], row[self._keys :], strict=True))
                for row in (tuple(map(str, row)) for row in rows)
            }
        )


def printed(tables: Callable[..., None], results: Any, keys: int = 1) -> Printed:
    console = Printed(keys)
    tables(console, results)
    return console
