"""What tables and lines of a console bring to the terminal."""

import io

from rich.progress import Progress, TextColumn
from rich.table import Table

from ashe_live.process.console import TerminalConsole

HOSTILE = "a\x1b]0;title\x07\x1b[2Jb\u202ec"


def test_no_control_sequence_reaches_the_terminal_from_names_in_tables_and_lines():
    """Such as those that somebody else's list of pictures holds."""
    file = io.StringIO()
    console = TerminalConsole(file=file, width=120)
    table = Table(HOSTILE, title=HOSTILE)
    table.add_row(HOSTILE)
    console.print(table, HOSTILE)
    console.print("  indented\nas it is")
    assert file.getvalue().endswith("  indented\nas it is\n")
    assert all(letter.isprintable() or letter == "\n" for letter in file.getvalue())
    assert file.getvalue().count(r"a\x1b]0;title\x07\x1b[2Jb\u202ec") == 4


def test_colours_and_bars_of_our_own_do():
    file = io.StringIO()
    console = TerminalConsole(file=file, width=60, force_terminal=True, color_system="standard")
    with Progress(TextColumn("{task.description}", style="red", markup=False), console=console) as progress:
        progress.add_task("going")
    assert "\x1b[31mgoing" in file.getvalue()
