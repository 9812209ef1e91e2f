"""Messages to the user, in the terminal and in the window: one printable line of bounded length.

File names, and what damaged or hostile files hold, find their way into messages. Whatever they contain must neither
break the line nor reach the terminal as a control sequence.
"""

import contextlib
import re
import sys
from collections.abc import Iterable

from ashe_live.errors import UserError

MOST_CHARACTERS = 600  # about eight lines of a terminal; longer messages are cut in their middle
GAP = " ... "
BREAK = re.compile(r"\s*[^\S ]\s*")  # white space other than plain spaces


def printable(text: object, most: int = MOST_CHARACTERS) -> str:
    """`text` as one line of at most `most` characters (at least 16), all of which `str.isprintable` accepts.

    Line breaks and tabs become one space. Control and format characters (terminal sequences, bidirectional overrides)
    and lone surrogates (bytes of a file name that are no UTF-8) become escapes such as \\x1b or \\udcff.
    """
    # Cut before, as escaping megabytes takes time, and after, as escapes are up to ten times as long as their
    # characters.
    line = _cut(BREAK.sub(" ", _cut(str(text), 4 * most)).strip(), most)
    return _cut(escaped(line), most)


def escaped(text: str) -> str:
    """`text` in which all that is neither printable nor a line's end is escaped, as `printable` does."""
    return "".join(letter if letter.isprintable() or letter == "\n" else _escape(letter) for letter in text)


def listed(names: Iterable[str], most: int | None = None) -> str:
    """Such as "clearcoat, sheen and volume"; of more than `most` names the first ones, and how many more there are."""
    *others, last = names
    if most is not None and len(others) >= most:
        others, last = others[:most], f"{len(others) + 1 - most} more"
    return f"{', '.join(others)} and {last}" if others else last


def print_message(text: object) -> None:
    """Prints one line for the user on standard error, after the program's name; does nothing if that is closed."""
    with contextlib.suppress(OSError):
        print(f"ashe-live: {printable(text)}", file=sys.stderr, flush=True)


def print_answer(text: object) -> bool:
    """Prints one line for the user on standard output: an answer. Returns and raises as `print_exactly`."""
    return print_exactly(printable(text))


def print_exactly(line: str) -> bool:
    """Prints one line for another program (JSON, TOML) on standard output, unchanged.

    Returns False if its reader has gone (`| head`), which is no reason to skip what else was asked for. Raises
    UserError when there is no space for it.
    """
    try:
        print(line, flush=True)
    except BrokenPipeError:
        return False
    except OSError as error:
        raise UserError(
            f"cannot write to standard output ({error.strerror})", "choose a place that has space left"
        ) from error
    return True


def _cut(text: str, most: int) -> str:
    if len(text) <= most:
        return text
    # The beginning says what happened, the end what to do about it.
    kept = max(16, most) - len(GAP)
    return text[: kept - kept // 2] + GAP + text[len(text) - kept // 2 :]


def _escape(letter: str) -> str:
    return letter.encode("unicode_escape", "surrogatepass").decode("ascii")
