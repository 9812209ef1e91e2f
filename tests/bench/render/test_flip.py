"""What a difference between two pictures must obey, whichever metric a person's eye is modelled by."""

import numpy as np
import pytest

from ashe_live.bench.render.flip import flip_error


def _even(colour: tuple[int, int, int]) -> np.ndarray:
    return np.full((40, 60, 3), colour, np.uint8)


def test_equal_pictures_do_not_differ_and_black_differs_from_white_by_one() -> None:
    picture = np.random.default_rng(1).integers(0, 256, (40, 60, 3), dtype=np.uint8)
    assert np.abs(flip_error(picture, picture)).max() < 1e-6
    # The authors' largest error; white against black is just below it.
    assert 0.9 < flip_error(_even((0, 0, 0)), _even((255, 255, 255))).mean() <= 1.0


def test_error_is_symmetric_and_grows_with_the_difference() -> None:
    grey, near, far = _even((120, 120, 120)), _even((125, 125, 125)), _even((160, 160, 160))
    assert flip_error(grey, far).mean() == pytest.approx(flip_error(far, grey).mean())
    assert 0 < flip_error(grey, near).mean() < 0.5 * flip_error(grey, far).mean()


def test_an_edge_is_seen_more_than_the_same_step_spread_out() -> None:
    grey = _even((120, 120, 120))
    sharp, soft = grey.copy(), grey.copy()
    sharp[:, 30:] = 150
    soft[:] = (120 + 30 * np.clip((np.arange(60) - 5) / 50, 0, 1))[None, :, None]
    # Beside the edge, where both differ from grey by as much.
    assert flip_error(grey, sharp)[20, 30] > flip_error(grey, soft)[20, 54]
