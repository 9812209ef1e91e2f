"""The parts of an MTL's lines: numbers, and pictures with the options before their names.

http://paulbourke.net/dataformats/mtl/
"""

import re

import numpy as np

from ashe_live.models.material import MapLayout
from ashe_live.models.parsing.malformed import MalformedError

# How many numbers follow an option of a map; what is left is the file's name, spaces and all.
OPTIONS = {
    **dict.fromkeys(("-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-texres", "-type", "-bm", "-boost"), 1),
    "-mm": 2,
    **dict.fromkeys(("-o", "-s", "-t"), 3),
}
COMMENT = re.compile(rb'(?<=\.)(\w+"?)\s+#.*')
COMMENT_BEHIND_NAME = re.compile(r"\s+#(?:\s.*)?$")  # "Material #25" is a name


def text_of(content: bytes) -> str:
    """Text of another encoding is taken for Latin-1: only names may then look odd, and they are not shown."""
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1")


def without_comment(file: bytes) -> bytes:
    """A file's name without the comment that follows it; in the name itself, up to its suffix, # is a character."""
    return COMMENT.sub(rb"\1", file)


def plain_name(name: str) -> str:
    """A material's name without what may stand around it: a comment, quotation marks, tabs in place of spaces."""
    return " ".join(COMMENT_BEHIND_NAME.sub("", name).strip('"').split())


def numbers_of(value: str) -> tuple[float, ...]:
    """None of them for what is said in other terms, as a spectrum or in CIE XYZ. A comment may follow them."""
    try:
        numbers = tuple(float(word) for word in value.partition("#")[0].split())
    except ValueError:
        return ()
    if not np.isfinite(numbers).all():
        raise MalformedError("a material's number is not finite")
    return numbers


def picture_of(value: str) -> tuple[str, MapLayout]:
    """A picture's file, and how options before its name enlarge it (-s), then shift it (-o), and end it (-clamp)."""
    name, options = _file_name(value)
    scale, shift = (numbers_of(" ".join(options.get(option, []))) for option in ("-s", "-o"))
    # "The default for each is 1 1 1, or 0 0 0", also of those behind the first that are not given.
    (across, upwards), (right, up) = (*scale, 1.0, 1.0)[:2], (*shift, 0.0, 0.0)[:2]
    repeats = "on" not in options.get("-clamp", [])
    return name, MapLayout(matrix=(across, 0.0, right, 0.0, upwards, up), repeats=(repeats, repeats))


def _file_name(value: str) -> tuple[str, dict[str, list[str]]]:
    """The file, and the words of the options before it."""
    options: dict[str, list[str]] = {}
    word, rest = _first_word(value)
    while (option := word.lower()) in OPTIONS:
        said: list[str] = []
        value = rest
        word, rest = _first_word(value)
        while len(said) < OPTIONS[option] and not _is_name(word):
            said.append(word.lower())
            value = rest
            word, rest = _first_word(value)
        options[option] = said
    return value.strip().strip('"'), options


def _first_word(value: str) -> tuple[str, str]:
    """And what follows it, spaces and all."""
    word, rest = (*value.split(None, 1), "", "")[:2]
    return word, rest


def _is_name(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return word.lower() not in ("on", "off", "r", "g", "b", "m", "l", "z")
    return False
