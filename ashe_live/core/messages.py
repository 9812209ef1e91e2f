"""What is said to a person, in the terminal and in the window: one line, printable, of a bounded length.

File names, and what damaged or hostile files hold, find their way into messages. Whatever they contain must neither
break the line nor reach the terminal as a control sequence.
"""

import sys

MOST_CHARACTERS = 600  # about eight lines of a terminal; what is longer is cut in its middle
GAP = " ... "


def printable(text: object, most: int = MOST_CHARACTERS) -> str:
    """`text` as one line of at most `most` characters (at least 16), all of which `str.isprintable` accepts.

    Runs of white space become one space. Control and format characters (terminal sequences, bidirectional overrides)
    and lone surrogates (bytes of a file name that are no UTF-8) become escapes such as \\x1b or \\udcff.
    """
    # Cut twice: escapes are up to ten times as long as what they stand for, and a text of megabytes is not to be escaped.
    line = _cut(" ".join(_cut(str(text), 4 * most).split()), most)
    return _cut("".join(letter if letter.isprintable() else _escaped(letter) for letter in line), most)


def tell(text: object) -> None:
    """One line on standard error, for a person, under the program's name."""
    print(f"ashe-live: {printable(text)}", file=sys.stderr, flush=True)


def say(text: object) -> None:
    """One line on standard output: an answer."""
    print(printable(text), flush=True)


def _cut(text: str, most: int) -> str:
    if len(text) <= most:
        return text
    # The beginning says what it is about, the end what to do.
    kept = max(16, most) - len(GAP)
    return text[: kept - kept // 2] + GAP + text[len(text) - kept // 2 :]


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape", "surrogatepass").decode("ascii")
