"""Numbers in the text of a model file."""

import re

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.parsing.malformed import MalformedError

NO_NUMBER = "a word stands where a number belongs"
WINDOWS_NAN = re.compile(rb"[-+]?(?:1\.#\w+|nan\(\w+\))", re.IGNORECASE)  # -1.#IND00 of old C libraries, -nan(ind)


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
