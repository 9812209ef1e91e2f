"""`ashe-live bench fit-lamps`: errors by the fall of light alone, and the share of the nearness that they ask for."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.bench import cases
from ashe_live.bench.cases import Case
from ashe_live.bench.lamps import fall_errors
from ashe_live.bench.lamps.bench import LampBench
from ashe_live.bench.lamps.fall_errors import OPEN, FallError, fall_error, fitted_share, whole_share
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.lamps.place import Place
from ashe_live.light.lamps.sources import with_fall_off
from tests.bench.painted_case import painted_case
from tests.light.painted_scenes import BOX, paint


def errors(share: float, sigma_share: float) -> list[FallError]:
    """Of lamps whose nearness is told with a sigma of its own, and with a further error that it does not tell."""
    rng = np.random.default_rng(7)
    true = rng.uniform(0.5, 3.0, 4000)
    told = true * (1 + np.hypot(share, sigma_share) * rng.normal(size=4000))
    return [
        FallError(50.0, k, at, sigma_share * k, 0.0, 0.0) for k, at in zip(true.tolist(), told.tolist(), strict=True)
    ]


def test_the_further_share_is_what_the_sigmas_lack() -> None:
    assert fitted_share(errors(0.1, 0.1)) == pytest.approx(0.1, rel=0.1)
    assert whole_share(errors(0.1, 0.1)) == pytest.approx(0.1 * 2**0.5, rel=0.05)


def test_honest_sigmas_lack_nothing() -> None:
    assert fitted_share(errors(0.0, 0.1)) < 0.01


LAMP_M = np.array([-0.3, -0.15, 0.4])
WITHIN_99 = 9.2  # squared Mahalanobis distance in two dimensions


@pytest.fixture(scope="module")
def lamp_case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """A box under a painted lamp, with its true masks."""
    scene = paint(BOX, lamp_m=LAMP_M)
    to_lamp = LAMP_M / np.linalg.norm(LAMP_M)
    return painted_case(tmp_path_factory.mktemp("lamp"), scene, to_lamp[None], lamp_m=LAMP_M, foot_m=np.array(BOX.at))


def test_a_lamps_nearness_is_estimated_by_the_fall_of_light(lamp_case: Case) -> None:
    found = fall_error(lamp_case, BALANCED)
    assert found is not None
    assert found.true == pytest.approx(1 / LAMP_M[2])
    assert found.estimated == pytest.approx(found.true, rel=0.15)
    assert found.deviance > 30
    assert found.squared_sigmas < WITHIN_99


def test_what_is_given_is_the_true_direction_from_the_object_and_nothing_of_the_distance(
    lamp_case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = []

    def kept(place: Place, *others: object) -> Place:
        given.append(place)
        return with_fall_off(place, *others)

    monkeypatch.setattr(fall_errors, "with_fall_off", kept)
    assert fall_error(lamp_case, BALANCED) is not None
    assert lamp_case.foot_m is not None
    x, y = lamp_case.foot_m
    for nearness in (0.5, 1 / LAMP_M[2], 5.0):
        # Along the true direction from the object, at whatever height.
        at = np.array([x, y, 0.0]) + (LAMP_M - (x, y, 0.0)) / LAMP_M[2] / nearness
        off = np.append(at[:2], 1.0) / at[2] - given[0].mean
        assert given[0].information @ off == pytest.approx((0.0, 0.0, nearness / OPEN**2), abs=1e-6)


def test_where_the_ground_is_lit_evenly_it_shows_no_lamp(lamp_case: Case, tmp_path: Path) -> None:
    scene = paint(BOX, lamp_m=50 * LAMP_M)
    cv2.imwrite(str(tmp_path / "picture.png"), scene.tracked.frame.image_bgr)
    found = fall_error(replace(lamp_case, image_path=tmp_path / "picture.png"), BALANCED)
    assert found is None or found.deviance < 10


def test_suns_and_several_lights_are_left_out(lamp_case: Case) -> None:
    for unknown in ({"lamp_m": None}, {"foot_m": None}, {"mask_paths": {}}):
        assert fall_error(replace(lamp_case, **unknown), BALANCED) is None
    two = np.vstack([LAMP_M / np.linalg.norm(LAMP_M), [0.0, 0.0, 1.0]])
    assert fall_error(replace(lamp_case, to_lights_marker=two), BALANCED) is None


def test_pictures_of_the_same_name_in_several_sets_all_count(
    lamp_case: Case, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cases, "read_cases", lambda folder: [replace(lamp_case, folder=folder.name)])
    record = LampBench([tmp_path / name for name in ("one", "two", "three")]).run()
    assert record["lamps"].keys() == {"one/painted", "two/painted", "three/painted"}


def test_a_set_without_lamps_gets_a_line() -> None:
    with pytest.raises(UserError, match="0 of 2 pictures show a single lamp"):
        LampBench([resource("assets", "scenes")], limit=2).run()
