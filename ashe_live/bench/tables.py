"""The benches' output: a console that is wide enough, and tables of figures."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from ashe_live.process.console import TerminalConsole

PIPE_WIDTH = 120


def bench_console() -> Console:
    """A console as wide as the terminal or, for a file or a pipe, PIPE_WIDTH columns."""
    console = TerminalConsole()
    return console if console.is_terminal else TerminalConsole(width=PIPE_WIDTH)


def figures_table(title: str, names: str | Sequence[str], *figures: str) -> Table:
    """An empty table with a column, or several, for names, and a right-aligned column for each of `figures`."""
    table = Table(title=title, title_justify="left")
    for heading in (names,) if isinstance(names, str) else names:
        table.add_column(heading, no_wrap=True)
    for heading in figures:
        table.add_column(heading, justify="right")
    return table


def cell(value: float | None, form: str) -> str:
    """A figure in a format such as ".1f", as all of these; "-" for one that is not known."""
    return "-" if value is None else format(value, form)


def degrees(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}°"


def percent(value: float | None) -> str:
    return cell(value, ".0%")


def fraction(value: float | None) -> str:
    return cell(value, ".2f")
