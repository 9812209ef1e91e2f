"""Tables and progress bars on the terminal, also where the reader has gone."""

from typing import Any

from rich.console import Console
from rich.text import Text

from ashe_live.process.messages import escaped


class TerminalConsole(Console):
    """Rich's console without colours for numbers in text, and without markup, which names of files may look like.

    If the reader has gone, rich itself would end the process.
    """

    def __init__(self, **how: Any) -> None:
        """`how`: the arguments of rich's Console."""
        super().__init__(**{"highlight": False, "markup": False, **how})

    def render_str(self, text: str, **how: Any) -> Text:
        """Every string that is printed, cells of tables too: names in them may hold control sequences."""
        return super().render_str(escaped(text), **how)

    def on_broken_pipe(self) -> None:
        """Raises BrokenPipeError for standard output, which carries the results; ignores it for standard error."""
        self.quiet = True
        if not self.stderr:
            raise BrokenPipeError
