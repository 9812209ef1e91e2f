"""How the benches print: on a console wide enough, and in tables of figures."""

from rich.console import Console
from rich.table import Table

from ashe_live.process.console import TerminalConsole

PIPE_WIDTH = 120


def bench_console() -> Console:
    """As wide as the terminal; in a file or a pipe, wide enough for the tables."""
    console = TerminalConsole()
    return console if console.is_terminal else TerminalConsole(width=PIPE_WIDTH)


def figures_table(title: str, what: str, *figures: str) -> Table:
    """A row for each thing: under `what` its name, then its figures."""
    table = Table(what, title=title, title_justify="left")
    for heading in figures:
        table.add_column(heading, justify="right")
    return table
