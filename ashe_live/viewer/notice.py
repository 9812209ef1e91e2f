"""The line that says what has just happened, shown for as long as it takes to read."""

NOTICE_S = 4.0  # the least that a line is shown
READ_PER_S = 15.0  # letters a second that a slow reader takes in


class Notice:
    """The last line that was said, and until when it is shown."""

    def __init__(self) -> None:
        self.text: str | None = None  # the last line, even if it is no longer shown
        self._until_s = 0.0

    def say(self, text: str, now_s: float) -> None:
        self.text, self._until_s = text, now_s + max(NOTICE_S, len(text) / READ_PER_S)

    def shown(self, now_s: float) -> str | None:
        """The line, while it is to be shown."""
        return None if self.text is None or now_s > self._until_s else self.text

    def withdraw(self, begin: str) -> None:
        """No longer shows the line, if it begins so."""
        if self.text is not None and self.text.startswith(begin):
            self._until_s = 0.0
