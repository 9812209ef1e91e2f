"""The guide: it names the edge that is nearer, the place that is missing, and is content in the end."""

import json
from typing import Any

import numpy as np
import pytest

from ashe_live.core.transforms import project
from ashe_live.errors import UserError
from ashe_live.tracking.boards import calibration_guide
from ashe_live.tracking.boards.calibration import MIN_VIEWS
from ashe_live.tracking.boards.calibration_board import BoardView
from ashe_live.tracking.boards.calibration_guide import TILTS, VIEWS_PER_TILT, CalibrationGuide
from tests.tracking.board_pictures import seen_from
from tests.tracking.boards.test_calibration import MIDDLE, POINTS, SIZE, camera_of

CAMERA = camera_of(560)
# Degrees about which axis of the picture (from x towards y) the board turns for an edge to come nearer.
AXIS_DEG = {"right": 90, "left": 270, "upper": 0, "lower": 180}


def view(
    at: tuple[float, float] = (0.0, 0.0), tilt_deg: float = 0.0, axis_deg: float = 0.0, height: float = 0.4
) -> BoardView:
    """The board `height` of the picture high, its middle `at` half pictures from the picture's middle."""
    ray = np.array(at) * SIZE / 2 / CAMERA.K[0, 0]
    pose = seen_from(8 * CAMERA.K[0, 0] / (height * SIZE[1]), tilt_deg, axis_deg, MIDDLE, ray, 0)
    return BoardView(project(CAMERA, pose, POINTS), POINTS)


def shown(guide: CalibrationGuide, *views: BoardView) -> CalibrationGuide:
    for each in views:
        guide.add(each, guide.frames_with_board)
    return guide


@pytest.mark.parametrize("edge", [name for name, _ in TILTS])
def test_it_knows_which_edge_is_nearer(edge: str) -> None:
    tilted = view(tilt_deg=30, axis_deg=AXIS_DEG[edge])
    assert shown(CalibrationGuide(SIZE), tilted).tilted() == {name: int(name == edge) for name, _ in TILTS}
    # What is nearer is larger: that edge's squares are the larger ones.
    outward = {"right": (1, 0), "left": (-1, 0), "lower": (0, 1), "upper": (0, -1)}[edge]
    along = (POINTS[:, :2] - MIDDLE) @ outward
    ahead = np.abs(along) > 1.5

    def extent(points: np.ndarray) -> float:
        return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))

    assert extent(tilted.corners_px[ahead & (along > 0)]) > extent(tilted.corners_px[ahead & (along < 0)])


@pytest.mark.parametrize(
    ("at", "row", "column"), [((-0.8, -0.8), 0, 0), ((0.8, -0.8), 0, 2), ((-0.8, 0.8), 2, 0), ((0.0, 0.0), 1, 1)]
)
def test_it_knows_where_the_board_was(at: tuple[float, float], row: int, column: int) -> None:
    covered = shown(CalibrationGuide(SIZE), view(at, height=0.25)).covered()
    assert covered[row][column]
    assert sum(map(sum, covered)) <= 2


def test_it_asks_for_what_is_missing_until_nothing_is() -> None:
    guide = CalibrationGuide(SIZE)
    assert guide.progress == 0
    last = 0.0
    for place in range(40):
        wanted = guide.wanted()
        if wanted is None:
            break
        lacking = [count for count in guide.tilted().values() if count < VIEWS_PER_TILT]
        assert ("once more" in wanted) == (lacking[:1] == [1])
        # Obeys to the letter.
        if wanted.startswith("tilt"):
            edge = next(name for name, _ in TILTS if f"its {name} edge" in wanted)
            shown(guide, view((0.25 * (place % 5 - 2), 0.0), 25, AXIS_DEG[edge]))
        elif wanted.startswith("bring"):
            x = -0.6 if "left" in wanted else 0.6 if "right" in wanted else 0.0
            y = -0.6 if "upper" in wanted else 0.6 if "lower" in wanted else 0.0
            shown(guide, view((x, y)))
        else:
            shown(guide, view((0.1, 0.1), 5 + place, 37 * place, 0.5))
        assert guide.progress > last
        last = guide.progress
    assert guide.wanted() is None
    assert guide.progress == 1
    assert all(count == VIEWS_PER_TILT for count in guide.tilted().values())
    found = guide.calibration()
    assert found.camera.K[0, 0] == pytest.approx(560, rel=0.01)
    assert json.dumps(found.to_json())


def test_the_same_view_is_kept_once_and_from_its_steadiest_frame() -> None:
    guide = CalibrationGuide(SIZE)
    assert guide.add(view((-0.3, 0.0)), 0)
    assert not guide.add(view((-0.28, 0.0)), 1)
    assert not guide.add(view((-0.279, 0.0)), 2)
    assert [kept.frame_index for kept in guide.kept] == [2]
    assert not guide.add(view((-0.26, 0.0)), 3)
    assert [kept.frame_index for kept in guide.kept] == [2]
    assert guide.add(view((0.4, 0.0)), 4)


@pytest.mark.parametrize(
    ("other", "is_new"),
    [
        ({"height": 0.4 * 1.1}, False),
        ({"height": 0.4 * 1.3}, True),
        ({"height": 0.4 / 1.3}, True),
        ({"tilt_deg": 26.0}, False),
        ({"tilt_deg": 33.0}, True),
        ({"axis_deg": 60.0}, True),
        ({"at": (0.1, 0.0)}, False),
        ({"at": (0.35, 0.0)}, True),
    ],
)
def test_a_view_is_new_in_another_place_another_size_or_turned(other: dict[str, Any], is_new: bool) -> None:
    usual: dict[str, Any] = {"at": (0.0, 0.0), "tilt_deg": 20.0, "axis_deg": 0.0, "height": 0.4}
    guide = shown(CalibrationGuide(SIZE), view(**usual))
    assert guide.add(view(**{**usual, **other}), 1) == is_new
    assert len(guide.kept) == 1 + is_new


def test_no_more_views_are_kept_than_can_be_worked_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration_guide, "MOST_VIEWS", 2)
    guide = CalibrationGuide(SIZE)
    assert [guide.add(view((x, 0.0)), at) for at, x in enumerate((-0.5, 0.0, 0.5))] == [True, True, False]
    assert [kept.frame_index for kept in guide.kept] == [0, 1]


@pytest.mark.parametrize("axis", [0, 1])
def test_a_cell_ends_between_two_pixels_and_is_covered_by_four_corners(axis: int) -> None:
    """The picture's first pixel has its middle at 0, and its outer edge half a pixel before that."""
    cut = 0.28 * SIZE[axis] - 0.5
    for off, lower, count in ((-0.2, True, 4), (0.2, False, 4), (-0.2, True, 3)):
        corners = np.full((count, 2), np.array(SIZE) / 2)
        corners[:, axis] = cut + off
        guide = CalibrationGuide(SIZE)
        seen = BoardView(corners, POINTS[:count])
        guide.kept.append(calibration_guide.KeptView(seen, 0, np.zeros(2), 0.0, np.array((0.0, 0.0, 1.0)), 0.0))
        covered = np.array(guide.covered())
        expected = np.zeros((3, 3), dtype=bool)
        expected[(1, 0 if lower else 1) if axis == 0 else (0 if lower else 1, 1)] = count == 4
        np.testing.assert_array_equal(covered, expected)


@pytest.mark.parametrize(("edges", "rows", "refused"), [(2, 2, None), (1, 2, "frontal"), (2, 1, "never showed")])
def test_two_edges_and_six_places_are_enough_to_try(
    monkeypatch: pytest.MonkeyPatch, edges: int, rows: int, refused: str | None
) -> None:
    monkeypatch.setattr(calibration_guide, "calibrate", lambda views, _size: len(views))
    guide = shown(CalibrationGuide(SIZE), view())
    guide.kept *= MIN_VIEWS
    monkeypatch.setattr(guide, "tilted", lambda: {name: int(at < edges) for at, (name, _) in enumerate(TILTS)})
    monkeypatch.setattr(guide, "covered", lambda: [[row < rows] * 3 for row in range(3)])
    if refused is None:
        assert guide.calibration() == MIN_VIEWS
        return
    with pytest.raises(UserError, match=refused) as caught:
        guide.calibration()
    assert caught.value.remedy == guide.wanted()


def test_no_board_at_all_is_said() -> None:
    guide = CalibrationGuide(SIZE)
    assert not guide.add(None, 0)
    with pytest.raises(UserError, match="no calibration board"):
        guide.calibration()


def test_frontal_views_only_are_refused_by_that_name() -> None:
    places = [(x, y) for x in (-0.6, 0.0, 0.6) for y in (-0.5, 0.0, 0.5)]
    guide = shown(CalibrationGuide(SIZE), *(view(place, tilt_deg=3) for place in places))
    with pytest.raises(UserError, match="frontal"):
        guide.calibration()


def test_views_in_one_place_only_are_refused_with_the_others_named() -> None:
    views = (view((0.5, 0.5), 20 + 12 * (at // 4), 90 * at, 0.2) for at in range(12))
    with pytest.raises(UserError, match="upper left"):
        shown(CalibrationGuide(SIZE), *views).calibration()
