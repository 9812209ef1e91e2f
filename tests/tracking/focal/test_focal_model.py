"""The model of a printed square seen by a camera: as a pinhole projects it, and its derivatives those of itself."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.tracking.focal.focal_model import (
    BLOOM,
    CX,
    CY,
    KAPPA,
    SHAPE,
    SHAPE_MODES,
    SQUARE,
    UNKNOWNS,
    FocalModel,
    FocalState,
    Q,
    prior_information,
)

SIZE = (640, 480)
FOCAL_PX = 620.0
TURNS = np.array([(2.3, 0.2, -0.1), (-2.6, 0.4, 0.8), (0.3, 2.8, 0.5)])
PLACES = np.array([(0.3, -0.2, 6.0), (-0.8, 0.5, 8.0), (0.0, 0.9, 5.0)])  # sides
ROTATIONS = np.array([cv2.Rodrigues(turn)[0] for turn in TURNS])
SHAPES = np.array([0.01, -0.02, 0.005, 0.008, -0.03])


def state_of(**values: float | np.ndarray) -> FocalState:
    g = np.zeros(UNKNOWNS)
    g[Q] = 1 / FOCAL_PX
    for name, value in values.items():
        g[{"cx": CX, "cy": CY, "kappa": KAPPA, "bloom": BLOOM, "shape": SHAPE}[name]] = value
    # Depths are over the focal length.
    return FocalState(g, ROTATIONS, PLACES * (1, 1, 1 / FOCAL_PX))


def pinhole_px(print_sides: np.ndarray) -> np.ndarray:
    """(n, 4, 2) from the picture's middle, of a print (4, 3) in every pose."""
    points = print_sides @ np.swapaxes(ROTATIONS, 1, 2) + PLACES[:, None]
    return FOCAL_PX * points[..., :2] / points[..., 2:]


def test_a_flat_square_is_where_a_pinhole_projects_it() -> None:
    seen = pinhole_px(SQUARE)
    residuals, depth = FocalModel(seen, SIZE).residuals(state_of())
    np.testing.assert_allclose(residuals, 0, atol=1e-9)
    points = SQUARE @ np.swapaxes(ROTATIONS, 1, 2) + PLACES[:, None]
    np.testing.assert_allclose(FOCAL_PX * depth, points[..., 2])


def test_what_is_bent_and_off_centre_is_where_it_is_printed_and_seen() -> None:
    print_sides = SQUARE + np.tensordot(SHAPES, SHAPE_MODES, axes=1)
    ideal = pinhole_px(print_sides)
    half_diagonal = np.hypot(*SIZE) / 2
    bent = ideal * (1 + 0.04 * (ideal**2).sum(axis=-1, keepdims=True) / half_diagonal**2) + (5.0, -7.0)
    state = state_of(cx=5.0, cy=-7.0, kappa=0.04, shape=SHAPES)
    np.testing.assert_allclose(FocalModel(bent, SIZE).residuals(state)[0], 0, atol=1e-9)


def test_bloom_moves_every_side_inwards_by_as_many_pixels() -> None:
    seen = pinhole_px(SQUARE)
    moved = FocalModel(seen, SIZE).residuals(state_of(bloom=1.0))[0] + seen
    for before, after in zip(seen, moved, strict=True):
        middle = before.mean(axis=0)
        for corner in range(4):
            a, b = before[corner], before[(corner + 1) % 4]
            normal = np.array((a[1] - b[1], b[0] - a[0])) / np.linalg.norm(b - a)
            normal *= np.sign((middle - a) @ normal)
            inwards = (after[[corner, (corner + 1) % 4]] - a) @ normal
            np.testing.assert_allclose(inwards, 1.0, atol=1e-9)


def test_derivatives_are_those_of_the_residuals() -> None:
    model = FocalModel(pinhole_px(SQUARE) + 0.3, SIZE)
    state = state_of(cx=3.0, cy=-2.0, kappa=0.05, bloom=0.4, shape=SHAPES)
    by_pose, by_globals = model.derivatives(state)

    def change(low: FocalState, high: FocalState, step: float) -> np.ndarray:
        found = (model.residuals(high)[0] - model.residuals(low)[0]) / (2 * step)
        return found.reshape(len(ROTATIONS), 8)

    for axis in range(3):
        turn = 1e-6 * np.eye(3)[axis]
        low, high = (replace(state, R=cv2.Rodrigues(sign * turn)[0] @ state.R) for sign in (-1, 1))
        np.testing.assert_allclose(by_pose[:, :, axis], change(low, high, 1e-6), rtol=1e-4, atol=1e-3)
        step = (1e-6, 1e-6, 1e-9)[axis]
        low, high = (replace(state, t=state.t + sign * step * np.eye(3)[axis]) for sign in (-1, 1))
        scale = np.abs(by_pose[:, :, 3 + axis]).max()
        np.testing.assert_allclose(by_pose[:, :, 3 + axis], change(low, high, step), rtol=1e-4, atol=1e-5 * scale)
    for place in range(UNKNOWNS):
        step = 1e-9 if place == Q else 1e-5
        low, high = (replace(state, g=state.g + sign * step * np.eye(UNKNOWNS)[place]) for sign in (-1, 1))
        scale = np.abs(by_globals[:, :, place]).max()
        np.testing.assert_allclose(by_globals[:, :, place], change(low, high, step), rtol=1e-4, atol=1e-5 * scale)


def test_of_the_focal_length_nothing_is_known_before_and_centres_go_with_the_picture() -> None:
    small, large = prior_information(SIZE), prior_information((1280, 960))
    assert small[Q] == large[Q] == 0
    assert small[CX] == small[CY] == pytest.approx(4 * large[CX])
    np.testing.assert_array_equal(small[KAPPA:], large[KAPPA:])
    assert (small[1:] > 0).all()
