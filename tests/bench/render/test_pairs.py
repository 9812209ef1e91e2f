"""What the pairs are compared by, on pictures whose differences are known."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.bench.render.pairs import drawn, pair_error, read_pairs, relief_ratio
from ashe_live.bench.render.tables import pairs_table
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.transforms import rigid
from ashe_live.errors import UserError
from ashe_live.light.explanation.border_widths import border_widths
from ashe_live.quality import FAST
from ashe_live.render.gl.offscreen import offscreen_context
from tests.plain_pair import written_pair

TEN_TO_NINETY_SIGMAS = 2.563


@pytest.mark.parametrize("sigma", [0.6, 1.0, 1.8])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_width_of_a_blurred_border_is_the_blurs(sigma: float, noise: float) -> None:
    linear = np.where(np.arange(120)[None] + 0.3 * np.arange(80)[:, None] > 70, 0.5, 0.15)
    linear = cv2.GaussianBlur(linear, (0, 0), sigma)
    grey = 255 * srgb_from_linear(linear) + np.random.default_rng(1).normal(0, 1, linear.shape) * noise
    image = np.repeat(np.round(grey).astype(np.uint8)[..., None], 3, axis=2)
    rows = np.arange(15, 65.0)
    places = np.column_stack([70 - 0.3 * rows, rows])
    outward = np.repeat(np.array([(1, 0.3)]) / np.hypot(1, 0.3), len(rows), axis=0)
    width = np.nanmedian(border_widths(image, places, outward))
    # The pixels are boxes, and reading between them is a triangle.
    assert width == pytest.approx(TEN_TO_NINETY_SIGMAS * np.sqrt(sigma**2 + 1 / 12 + 1 / 6), rel=0.15)


def test_no_width_is_made_up_where_there_is_no_border() -> None:
    image = np.full((80, 120, 3), 150, np.uint8)
    places = np.column_stack([np.full(40, 60.0), np.arange(20, 60.0)])
    assert np.isnan(border_widths(image, places, np.repeat([(1.0, 0.0)], 40, axis=0))).all()


def test_relief_of_half_the_contrast_is_half_of_it_and_that_of_little_ground_is_not_measured() -> None:
    ripples = np.sin(np.arange(120)[None] * 1.5 + np.zeros((80, 1)))
    strong, weak = (
        np.repeat(np.round(120 * np.exp(amount * ripples))[..., None], 3, axis=2).astype(np.uint8)
        for amount in (0.2, 0.1)
    )
    where = np.ones((80, 120), bool)
    assert relief_ratio(weak, strong, where) == pytest.approx(0.5, rel=0.05)
    assert np.isnan(relief_ratio(weak, strong, np.arange(120)[None] + 120 * np.arange(80)[:, None] < 50))


def test_a_pair_without_any_difference_has_none(tmp_path) -> None:
    """The model is so far away that neither it nor its shadow is in the picture: bare and expected are alike."""
    pair = written_pair(tmp_path, rigid(np.eye(3), (3.0, 0.0, 1.0)))
    error = pair_error(offscreen_context(), pair, FAST.render)
    assert np.isnan(error.border_ratio)
    assert error.border_places == 0
    assert np.isnan(error.flip)


def test_the_renderers_own_picture_is_without_error_and_a_paler_shadow_is_not(tmp_path) -> None:
    ctx = offscreen_context()
    pair = written_pair(tmp_path, rigid(cv2.Rodrigues(np.array((2.4, 0.0, 0.0)))[0], (0.0, 0.0, 0.4)))
    ours = drawn(ctx, pair.scene, FAST.render)
    same = pair_error(ctx, replace(pair, expected=ours), FAST.render)
    assert same.flip == 0
    assert same.border_places > 0
    assert same.border_ratio == 1
    assert same.ground_de == 0
    half = np.round((ours.astype(float) + pair.scene.tracked.frame.image_bgr) / 2).astype(np.uint8)
    paler = pair_error(ctx, replace(pair, expected=half), FAST.render)
    assert paler.flip > 0.02
    # A border keeps its width when it fades.
    assert paler.border_ratio == pytest.approx(1, abs=0.1)


def test_a_smooth_cover_on_grainy_ground_lacks_the_grounds_relief(tmp_path) -> None:
    """The photo is plain, and so is its cover; the ground without a sheet that it is compared with has grain."""
    pair = written_pair(tmp_path, rigid(cv2.Rodrigues(np.array((2.4, 0.0, 0.0)))[0], (0.0, 0.0, 0.4)))
    pair.is_sheet[40:80, 60:100] = True
    grain = np.random.default_rng(5).normal(0, 12, pair.bare.shape[:2])[..., None]
    grainy = np.clip(pair.without_sheet + grain, 0, 255).astype(np.uint8)
    error = pair_error(offscreen_context(), replace(pair, without_sheet=grainy), FAST.render)
    assert error.hidden_relief_ratio < 0.1


def test_a_folder_without_pairs_is_named(tmp_path) -> None:
    with pytest.raises(UserError, match="holds no pairs"):
        read_pairs(tmp_path)


def test_a_pair_that_nothing_changes_in_is_left_out_of_the_means() -> None:
    told = dict.fromkeys(("flip", "ground_de", "paper_de", "model_de", "hidden_de", "border_ratio"), 0.25)
    told |= {"relief_ratio": 1.0, "hidden_relief_ratio": 1.0}
    rows = [each | {"preset": "fast", "seam_px": 0, "forced_choice": 0.5} for each in (told, {**told, "flip": np.nan})]
    flip, border = (list(column.cells) for column in pairs_table(rows).columns[1:3])
    assert (flip, border) == (["0.250"], ["0.25"])
