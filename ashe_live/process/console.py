"""Tables and progress bars for a person, whoever reads them, and for however long."""

from typing import Any

from rich.console import Console


class TerminalConsole(Console):
    """Rich's, without colours for numbers in text. Where nobody reads any more, rich would end the process."""

    def __init__(self, **how: Any) -> None:
        """`how` as for rich's Console."""
        super().__init__(**{"highlight": False, **how})

    def on_broken_pipe(self) -> None:
        """Raises BrokenPipeError of standard output, which is what was asked for; what goes to stderr is left out."""
        self.quiet = True
        if not self.stderr:
            raise BrokenPipeError
