"""Wrong use from Python is named in words that can be read."""

from pathlib import Path

import numpy as np
import pytest

from ashe_live.core import arguments
from ashe_live.core.types import Illumination


@pytest.mark.parametrize(
    ("value", "kind", "said"),
    [
        (3, Illumination, "light must be an Illumination, and is an int"),
        ("3", Illumination, "light must be an Illumination, and is a str"),
        (np.float64(3), Path, "light must be a Path, and is a float64"),
    ],
)
def test_the_kinds_that_are_and_should_be_are_named(value, kind, said):
    with pytest.raises(TypeError) as caught:
        arguments.instance(value, kind, "light")
    assert str(caught.value) == said
