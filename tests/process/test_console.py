"""What tables and lines of a console bring to the terminal."""

import io

import pytest
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


def test_names_are_printed_as_they_are_and_are_no_instructions():
    """A scene may be called "[bold]7"; and rich would give numbers a colour."""
    file = io.StringIO()
    console = TerminalConsole(file=file, width=60, force_terminal=True, color_system="standard")
    console.print("scene [bold]7[/bold].png")
    table = Table.grid()
    table.add_row("scene [red]7[/red].png")
    console.print(table)
    assert file.getvalue().split() == ["scene", "[bold]7[/bold].png", "scene", "[red]7[/red].png"]


def test_colours_and_bars_of_our_own_do():
    file = io.StringIO()
    console = TerminalConsole(file=file, width=60, force_terminal=True, color_system="standard")
    with Progress(TextColumn("{task.description}", style="red", markup=False), console=console) as progress:
        progress.add_task("going")
    assert "\x1b[31mgoing" in file.getvalue()


def test_a_reader_that_has_gone_ends_what_prints_results_and_not_what_shows_progress():
    """Rich itself would end the process. Nothing is written after that, as what cleans up may do."""

    class Gone(io.StringIO):
        tries = 0

        def write(self, _text: str) -> int:
            self.tries += 1
            raise BrokenPipeError

    results, progress = Gone(), Gone()
    console = TerminalConsole(file=results)
    with pytest.raises(BrokenPipeError):
        console.print("a")
    beside = TerminalConsole(file=progress, stderr=True)
    for each in (console, beside, beside):
        each.print("b")
    assert results.tries == progress.tries == 1
