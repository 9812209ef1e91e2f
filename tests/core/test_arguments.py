"""Wrong use from Python is named in words that can be read."""

import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from ashe_live.core import arguments
from ashe_live.core.light import Illumination, Light
from ashe_live.core.ranges import Range


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


PICTURE = np.zeros((4, 6, 3), np.uint8)


def test_what_is_right_is_returned() -> None:
    assert arguments.picture(PICTURE, "image") is PICTURE
    assert arguments.picture_size([np.int64(640), 480], "size") == (640, 480)  # type: ignore[arg-type]
    assert arguments.path("a.png", "file") == arguments.path(Path("a.png"), "file") == Path("a.png")
    assert arguments.one_of("fast", ("fast", "slow"), "quality") == "fast"


@pytest.mark.parametrize(
    ("call", "error"),
    [
        (lambda: arguments.picture(PICTURE.tolist(), "image"), TypeError),
        (lambda: arguments.picture(PICTURE[..., 0], "image"), ValueError),
        (lambda: arguments.picture(PICTURE[..., :2], "image"), ValueError),
        (lambda: arguments.picture(PICTURE.astype(float), "image"), ValueError),
        (lambda: arguments.picture(PICTURE[:0], "image"), ValueError),
        (lambda: arguments.picture_size(640, "image size"), TypeError),
        (lambda: arguments.picture_size((640, 480, 3), "image size"), TypeError),
        (lambda: arguments.picture_size((640, True), "image size"), TypeError),
        (lambda: arguments.picture_size((640.0, 480), "image size"), TypeError),
        (lambda: arguments.picture_size((640, 0), "image size"), ValueError),
        (lambda: arguments.path(b"image.png", "image file"), TypeError),
        (lambda: arguments.path("a\0b", "image file"), ValueError),
        (lambda: arguments.path(3, "image file"), TypeError),
        (lambda: arguments.one_of("quick", ("fast", "slow"), "image quality"), ValueError),
        (lambda: arguments.one_of(None, ("fast", "slow"), "image quality"), TypeError),
    ],
)
def test_what_is_wrong_is_of_another_kind_or_value_and_named(
    call: Callable[[], object], error: type[Exception]
) -> None:
    with pytest.raises(error, match="image"):
        call()


@pytest.mark.parametrize("half", [np.float16(0.5), np.float32(0.5), Fraction(1, 2), 0.5])
def test_a_number_of_any_kind_becomes_a_float(half) -> None:
    """In a range that ends beyond the largest float16, which warned; in sums with which a float16 stays one."""
    checked = Range(0.0, 1e6, "m").checked(half, "side_m")
    assert type(checked) is float
    assert checked == 0.5


def test_a_number_hardly_beyond_a_range_is_not_told_a_limit_that_it_is_within() -> None:
    """As a float32's pi, by a limit rounded up."""
    with pytest.raises(ValueError, match=r"from 0 to 3\.14159265[0-9]* rad, and is 3\.14159274"):
        Light((0.0, 0.0, 1.0), angular_size_rad=float(np.float32(math.pi)))
    assert str(Range(1e-6, 1e6, "m")) == "from 0.000001 to 1000000 m"


@pytest.mark.parametrize("huge", [Fraction(10**400), 10**400, np.longdouble("1e4000"), np.inf])
def test_a_number_beyond_every_float_is_beyond_its_range(huge) -> None:
    with pytest.raises(ValueError, match="side_m must be a number"):
        Range(0.0, 1e6, "m").checked(huge, "side_m")


@pytest.mark.parametrize(
    ("covariance", "said"),
    [
        ([(-1.0, 0.0), (0.0, 1.0)], "a variance in spread must be"),
        ([(1e300, 0.0), (0.0, 1.0)], "a variance in spread must be"),
        ([(1.0, 0.5), (0.0, 1.0)], "spread is not symmetric"),
        ([(1.0, 2.0), (2.0, 1.0)], "spread is no covariance"),
        ([(1e308, 0.0), (0.0, 1e308)], "a variance in spread"),  # without a word of NumPy's on the way
        ([(1.0, 1e308), (-1e308, 1.0)], "spread is not symmetric"),
        ([(0.0, 1e-9), (1e-9, 1.0)], "spread is no covariance"),
        ([(4e-12, -2.1e-3), (-2.1e-3, 1e6)], "spread is no covariance"),
        (np.full((2, 2), np.nan), "not finite"),
        (np.eye(3), "shape"),
    ],
)
def test_what_is_no_covariance_is_named(covariance, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        arguments.covariance(covariance, 2, "spread")


def test_of_three_pairs_that_may_be_correlated_so_not_all_may() -> None:
    """None of the correlations is beyond 1, but their matrix has the eigenvalue 1 - 2 * 0.9."""
    with pytest.raises(ValueError, match="negative variance"):
        arguments.covariance(1.9 * np.eye(3) - 0.9, 3, "spread")


def test_every_covariance_may_be_rounded_and_in_any_units() -> None:
    rng = np.random.default_rng(3)
    for _ in range(300):
        by_causes = rng.normal(size=(6, rng.integers(1, 7))) * 10.0 ** rng.uniform(-9, 6, (6, 1))
        arguments.covariance(np.asarray(by_causes @ by_causes.T, np.float32), 6, "spread")
    for covariance in (np.zeros((6, 6)), 5e-324 * np.eye(6), 1e-310 * np.ones((6, 6))):
        np.testing.assert_array_equal(arguments.covariance(covariance, 6, "spread"), covariance)
