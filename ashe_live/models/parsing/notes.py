"""Notes on features of a model file that are drawn differently, one line each: for terminal, window and programs."""

MOST_NOTES = 6
NAME_CHARACTERS = 60  # of a name that a file gives
WITHOUT_COORDINATES = "where it has no texture coordinates, pictures are drawn in one colour, that of their corner"


class Notes:
    """Gathered while a file is read; the same words count once."""

    def __init__(self) -> None:
        self._lines: dict[str, None] = {}

    def add(self, line: str) -> None:
        self._lines.setdefault(line)

    @property
    def lines(self) -> tuple[str, ...]:
        """In the order in which they were added, the first MOST_NOTES of them."""
        return tuple(self._lines)[:MOST_NOTES]
