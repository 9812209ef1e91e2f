"""Numbers in the text of a model file."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.parsing.malformed import MalformedError


def numbers_in(text: bytes) -> Float:
    """(n,) of words parted by white space. Raises MalformedError where one is no number."""
    try:
        return np.array(text.split(), dtype=np.bytes_).astype(np.float64)
    except ValueError:
        raise MalformedError("a word stands where a number belongs") from None
