"""Numbers in the text of a model file."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.parsing.malformed import MalformedError


def numbers_in(text: bytes) -> Float:
    """(n,) of words parted by white space. Raises MalformedError where one is no number."""
    words = text.split()
    if not words:
        return np.empty(0)
    try:
        return np.array(words, dtype=np.bytes_).astype(np.float64)
    except ValueError:
        raise MalformedError("a word stands where a number belongs") from None
