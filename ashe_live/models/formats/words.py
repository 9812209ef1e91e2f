"""Numbers in the text of a model file."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.parsing.malformed import MalformedError

NO_NUMBER = "a word stands where a number belongs"


def numbers_in(text: bytes) -> Float:
    """(n,) of words parted by white space. Raises MalformedError where one is no number."""
    if b"_" in text or b"\0" in text:  # which NumPy reads over, as Python does in its own source
        raise MalformedError(NO_NUMBER)
    try:
        return np.array(text.split(), dtype=np.bytes_).astype(np.float64)
    except ValueError:
        raise MalformedError(NO_NUMBER) from None
