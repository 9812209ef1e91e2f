"""What one window has done to a model the next one knows, until it is given back."""

import json
from collections.abc import Callable
from pathlib import Path

import PIL.Image
import pytest

from ashe_live.core.contract import SNAPSHOT_KEYWORD
from ashe_live.viewer.hands.hand import SCALE_STEP
from tests.conftest import Film
from tests.e2e.conftest import Running, player
from tests.patience import await_that


def scale(running: Running) -> float:
    """Of the model in a snapshot."""
    before = len(running.files("*.png"))
    running.press("s")
    await_that(lambda: len(running.files("*.png")) > before, "a snapshot")
    with PIL.Image.open(running.files("*.png")[-1]) as picture:
        known = json.loads(picture.text[SNAPSHOT_KEYWORD])
    return float(known["marker_from_placed"][2][2])


def test_a_model_is_as_large_in_the_next_window_and_backspace_forgets_it(
    launch: Callable[..., Running], film: Film, tmp_path: Path
) -> None:
    play = player(launch, film)
    first = play("--model", "mug", folder=tmp_path)
    assert scale(first) == 1
    first.press("plus", "plus", "plus")
    await_that(lambda: scale(first) == pytest.approx(SCALE_STEP**3), "a larger mug")
    assert first.end() == 0
    second = play("--model", "mug", folder=tmp_path)
    assert scale(second) == pytest.approx(SCALE_STEP**3)
    second.press("BackSpace")
    await_that(lambda: scale(second) == 1, "the mug as it comes")
    assert second.end() == 0
    assert scale(play("--model", "mug", folder=tmp_path)) == 1
