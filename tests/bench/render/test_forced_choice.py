"""The classifier finds what differs, and nothing where nothing does."""

import cv2
import numpy as np

from ashe_live.bench.render.forced_choice import crop_features, forced_choice

WHERE = np.ones((120, 120), bool)


def _photo(seed: int, noise: float, blur: float, take: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    blocks = cv2.resize(rng.integers(60, 200, (8, 8, 3), dtype=np.uint8), (120, 120), interpolation=cv2.INTER_NEAREST)
    soft = cv2.GaussianBlur(blocks, (0, 0), blur).astype(float)
    grain = np.random.default_rng((seed, take)).normal(0, noise, (120, 120, 1))
    return np.clip(np.round(soft + grain), 0, 255).astype(np.uint8)


def _share_right(noise: float, blur: float) -> float:
    virtual = [crop_features(_photo(seed, noise, blur), WHERE) for seed in range(8)]
    real = [crop_features(_photo(seed, 2.0, 0.8), WHERE) for seed in range(8)]
    return forced_choice(virtual, real)


def test_sharper_edges_give_it_away() -> None:
    assert _share_right(2.0, 0.4) > 0.9


def test_missing_noise_gives_it_away() -> None:
    assert _share_right(0.5, 0.8) > 0.9


def test_other_noise_of_the_same_kind_does_not() -> None:
    virtual, real = ([crop_features(_photo(seed, 2.0, 0.8, take), WHERE) for seed in range(8)] for take in (1, 2))
    assert 0.3 < forced_choice(virtual, real) < 0.7


def test_one_scene_gives_no_figure() -> None:
    features = crop_features(_photo(1, 2.0, 0.8), WHERE)
    assert np.isnan(forced_choice([features], [features]))
