"""What a difference from a photo consists of, of pairs whose truth is made here."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from rich.console import Console

from ashe_live.bench.render.budget import COLUMNS, BudgetBench, Truth, budget, composed, drawn_at, read_truth, under
from ashe_live.bench.render.pairs import Pair
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import rigid
from ashe_live.errors import UserError
from ashe_live.quality import FAST
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.lights.photometry import Photometry
from tests.plain_pair import written_pair

SKY = np.array((0.2, 0.25, 0.3))
OBLIQUE = rigid(cv2.Rodrigues(np.array((2.4, 0.0, 0.0)))[0], (0.0, 0.0, 0.4))


def written_truth(folder: Path) -> Pair:
    """A pair in which a dark patch stands for the model, and a strip beside it for its shadow; every photo is exact."""
    pair = written_pair(folder, OBLIQUE)
    bare = LINEAR_FROM_SRGB_8BIT[pair.bare].astype(np.float32)
    with_model = bare.copy()
    with_model[40:80, 60:100] = (0.30, 0.10, 0.05)
    with_model[40:80, 100:130] *= 0.4
    photo = np.round(255 * srgb_from_linear(with_model)).astype(np.uint8)[..., ::-1]
    for name in ("", "_untoned", "_linear"):
        cv2.imwrite(str(folder / f"one_bare{name}.jpg"), pair.bare, [cv2.IMWRITE_JPEG_QUALITY, 100])
    for name in ("", "_untoned", "_linear", "_noise", "_moved_25", "_moved_50"):
        cv2.imwrite(str(folder / f"one_model{name}.jpg"), photo, [cv2.IMWRITE_JPEG_QUALITY, 100])
    for name, light in (("bare", bare), ("model", with_model)):
        cv2.imwrite(str(folder / f"one_{name}_light.tiff"), light[..., ::-1])
    is_model = np.zeros(pair.is_model.shape, bool)
    is_model[40:80, 60:100] = True
    return replace(pair, expected=photo, is_model=is_model)


def test_with_the_true_light_and_shading_an_exact_photo_is_met(tmp_path) -> None:
    pair = written_truth(tmp_path)
    ctx, truth = offscreen_context(), read_truth(pair)
    picture = composed(ctx, pair.scene, FAST.render, truth, pair.is_model)
    inside = np.zeros(pair.is_model.shape, bool)
    inside[45:75, 65:95] = inside[45:75, 105:125] = inside[5:30] = True  # away from borders, which are blurred
    assert np.abs(picture.astype(int) - pair.expected)[inside].max() <= 1
    rows = dict(budget(ctx, pair, FAST.render))
    for cause in ("true light and shading", "linear camera: true light and shading"):
        assert rows[cause]["dE model"] < 1
        assert rows[cause]["FLIP"] < 0.03
    assert rows["as photographed"]["dE model"] > 5  # the renderer draws a cube, and no patch
    assert rows["the photo with other noise"]["FLIP"] < 0.01  # nothing but the JPEG


def test_no_light_is_drawn_where_the_truth_has_changed_nothing(tmp_path) -> None:
    pair = written_truth(tmp_path)
    truth = read_truth(pair)
    same = Truth(truth.bare, truth.bare, truth.white_rgb, truth.sky)
    picture = composed(offscreen_context(), pair.scene, FAST.render, same, np.zeros(pair.is_model.shape, bool))
    np.testing.assert_array_equal(picture, pair.bare)


def test_a_camera_that_exposes_twice_as_much_gives_the_model_twice_the_light(tmp_path) -> None:
    ctx = offscreen_context()
    pair = written_pair(tmp_path, OBLIQUE)
    scene = replace(pair.scene, illumination=replace(pair.scene.illumination, seen_in=None))  # polished faces mirror it
    once, twice = (LINEAR_FROM_SRGB_8BIT[drawn_at(ctx, scene, FAST.render, np.full(3, w))] for w in (0.2, 0.4))
    is_model = (np.abs(once - LINEAR_FROM_SRGB_8BIT[pair.bare]).max(axis=2) > 0.02) & (twice.max(axis=2) < 0.9)
    changed = is_model & (np.abs(twice - once).max(axis=2) > 0.05)
    assert changed.sum() > 200
    assert np.median(twice[changed].sum(axis=1) / once[changed].sum(axis=1)) == pytest.approx(2, rel=0.03)


def test_the_light_of_a_known_sky_is_that_skys(tmp_path) -> None:
    scene = under(written_pair(tmp_path, OBLIQUE).scene, SKY)
    lighting = Photometry(FAST.render).lighting(scene.illumination)
    np.testing.assert_allclose(lighting.sky, SKY, atol=1e-6)
    np.testing.assert_allclose(lighting.ground_shares.sum(axis=0), 1 - SKY, atol=1e-6)


def test_the_table_has_the_means_of_what_each_scene_has(tmp_path) -> None:
    pair = written_truth(tmp_path)
    cv2.imwrite(str(tmp_path / "one_mask.png"), pair.is_model.astype(np.uint8) * 255)
    record = BudgetBench(tmp_path, console=Console(quiet=True)).run()
    assert {row["scene"] for row in record["budget"]} == {pair.name}
    assert len({row["cause"] for row in record["budget"]}) == len(record["budget"]) == 10
    assert all(set(COLUMNS) <= set(row) for row in record["budget"])


def test_pairs_that_were_developed_without_their_truth_are_named(tmp_path) -> None:
    pair = written_pair(tmp_path, OBLIQUE)
    with pytest.raises(UserError, match="developed without its truth"):
        next(budget(offscreen_context(), pair, FAST.render))
