"""What is said to a person, in the terminal and in the window: one line, printable, of a bounded length.

File names, and what damaged or hostile files hold, find their way into messages. Whatever they contain must neither
break the line nor reach the terminal as a control sequence.
"""

import contextlib
import re
import sys

from ashe_live.errors import UserError

MOST_CHARACTERS = 600  # about eight lines of a terminal; what is longer is cut in its middle
GAP = " ... "
BREAK = re.compile(r"\s*[^\S ]\s*")  # white space other than plain spaces


def printable(text: object, most: int = MOST_CHARACTERS) -> str:
    """`text` as one line of at most `most` characters (at least 16), all of which `str.isprintable` accepts.

    Line breaks and tabs become one space. Control and format characters (terminal sequences, bidirectional overrides)
    and lone surrogates (bytes of a file name that are no UTF-8) become escapes such as \\x1b or \\udcff.
    """
    # Cut before and after: escapes are up to ten times as long as what they stand for, and megabytes take their time.
    line = _cut(BREAK.sub(" ", _cut(str(text), 4 * most)).strip(), most)
    return _cut("".join(letter if letter.isprintable() else _escaped(letter) for letter in line), most)


def tell(text: object) -> None:
    """One line on standard error, for a person, under the program's name; where nobody can read it, none."""
    with contextlib.suppress(OSError):
        print(f"ashe-live: {printable(text)}", file=sys.stderr, flush=True)


def say(text: object) -> bool:
    """One line on standard output, for a person: an answer. As `say_exactly`."""
    return say_exactly(printable(text))


def say_exactly(line: str) -> bool:
    """One line on standard output, for another program (JSON, TOML), as it is.

    False when its reader has gone (`| head`), which is no reason to leave out what else was asked for. Raises UserError
    when there is no space for it.
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
    # The beginning says what it is about, the end what to do.
    kept = max(16, most) - len(GAP)
    return text[: kept - kept // 2] + GAP + text[len(text) - kept // 2 :]


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape", "surrogatepass").decode("ascii")
