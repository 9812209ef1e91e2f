"""Numbers in the text of a model file."""

import re

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.parsing.malformed import MalformedError

NO_NUMBER = "a word stands where a number belongs"
WINDOWS_NAN = re.compile(rb"[-+]?(?:1\.#\w+|nan\(\w+\))", re.IGNORECASE)  # -1.#IND00 of old C libraries, -nan(ind)

BRIGHTEST = 8.0  # fraction that is taken for one: it may be brighter than white, and a byte of 8 is as good as black


def with_plain_nan(text: bytes) -> bytes:
    """With "nan" for what programs on Windows write where a division by zero gave no number, as for a normal."""
    return WINDOWS_NAN.sub(b"nan", text) if b"#" in text or b"(" in text else text


def numbers_in(text: bytes) -> Float:
    """(n,) of words parted by white space. Raises MalformedError where one is no number."""
    if b"_" in text or b"\0" in text:  # which NumPy reads over, as Python does in its own source
        raise MalformedError(NO_NUMBER)
    try:
        return np.array(with_plain_nan(text).split(), dtype=np.bytes_).astype(np.float64)
    except ValueError:
        raise MalformedError(NO_NUMBER) from None


def full_intensity(fractions: Float) -> float:
    """What stands for it among colours that are written with a point: 1, or 255 where some are beyond any fraction.

    Formats that let them be written so do not say which.
    """
    return 255.0 if np.nanmax(fractions, initial=0.0) > BRIGHTEST else 1.0
