"""What is drawn falls where OpenCV and the geometry of light say."""

import json

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import box_corners
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import project, rigid
from ashe_live.models.primitives import box, revolved
from ashe_live.quality import QUALITIES
from ashe_live.render.scene import Scene
from tests.render.green_model import split
from tests.render.in_turns import in_turns
from tests.render.inside import inside_px
from tests.shared_data import SHARED

SCENES = SHARED / "scenes"
GROUND = 200
POLE = (0.02, 0.03, 0.07)
RATIO = (0.2, 0.2, 0.2)
# Half of the light of a white ground is left: where a shadow's border lies, whatever its double throws into it.
HALF_LIT = 188


def _shadows(points: np.ndarray, to_light: np.ndarray) -> np.ndarray:
    return points - to_light * (points[:, 2:] / to_light[2])


@pytest.mark.parametrize(
    ("quality", "azimuth_deg", "elevation_deg", "light_azimuth_deg", "light_elevation_deg"),
    in_turns([(-90, 35, 150, 40), (-60, 50, 30, 30), (100, 25, 200, 60), (10, 65, -100, 45), (-90, 40, 90, 75)]),
)
def test_silhouette_and_shadow_fall_where_geometry_says(
    make_renderer,
    stage,
    quality: str,
    azimuth_deg: float,
    elevation_deg: float,
    light_azimuth_deg: float,
    light_elevation_deg: float,
) -> None:
    renderer = make_renderer(QUALITIES[quality].render)
    light = stage.light(light_azimuth_deg, light_elevation_deg, RATIO)
    tracked = stage.tracked(GROUND, stage.pose(azimuth_deg, elevation_deg))
    renderer.render(Scene(tracked, stage.placed(stage.glowing_green(box(POLE))), Illumination((light,))))
    is_model, is_shadow = split(renderer.read_bgr())

    corners = box_corners(np.array([(-POLE[0] / 2, -POLE[1] / 2, 0), (POLE[0] / 2, POLE[1] / 2, POLE[2])]))
    T_cam_marker = tracked.marker.T_cam_marker
    in_model = inside_px(project(tracked.camera, T_cam_marker, corners))
    in_shadow = inside_px(project(tracked.camera, T_cam_marker, _shadows(corners, light.to_light_marker)))

    assert is_model[in_model > 1].all()
    assert not is_model[in_model < -1].any()
    # The hull of the shadow holds the footprint: this also says that the shadow starts where the model stands.
    assert (is_shadow | is_model)[in_shadow > 1.5].all()
    assert not is_shadow[in_shadow < -1.5].any()
    assert is_shadow.sum() > 300


def test_shadow_is_joined_to_the_model_on_its_dark_side(make_renderer, stage) -> None:
    """No peter-panning: going from the model's foot into the shadow, no ground is lit."""
    renderer = make_renderer()
    for light_elevation_deg in (10, 30, 60, 80):
        light = stage.light(90, light_elevation_deg, RATIO)  # from behind, the shadow falls towards the camera
        tracked = stage.tracked(GROUND, stage.pose(-90, 45, 0.2, target=(0, 0, 0)))
        renderer.render(
            Scene(tracked, stage.placed(stage.glowing_green(box((0.04, 0.04, 0.06)))), Illumination((light,)))
        )
        is_model, is_shadow = split(renderer.read_bgr())
        for x in np.linspace(-0.015, 0.015, 7):
            (column, row), *_ = project(tracked.camera, tracked.marker.T_cam_marker, [(x, -0.02, 0.0)])
            column, foot = round(column), round(row)
            lowest = int(np.flatnonzero(is_model[:, column]).max())
            assert abs(lowest - foot) <= 1
            assert is_shadow[lowest + 1 : lowest + 5, column].all()


def _cylinders() -> list[dict]:
    if not SCENES.exists():
        return []
    scenes = json.loads((SCENES / "ground_truth.json").read_text())["scenes"]
    return [s for s in scenes if s["caster"]["type"] == "cylinder" and s["lights"] and s["category"] != "partial"]


@pytest.mark.skipif(not SCENES.exists(), reason="needs shared/scenes beside the checkout")
def test_shadow_agrees_with_path_traced_scenes(make_renderer, stage) -> None:
    """A virtual double of the real object casts the real object's shadow."""
    compared = 0
    for scene in _cylinders():
        image = cv2.imread(str(SCENES / scene["image"]))
        size = (image.shape[1], image.shape[0])
        truth = cv2.imread(str(SCENES / scene["masks"]["shadow"]), cv2.IMREAD_GRAYSCALE) > 0
        hidden = cv2.imread(str(SCENES / scene["masks"]["object"]), cv2.IMREAD_GRAYSCALE) > 0
        lower, upper = np.array(scene["caster"]["bbox_min_m"]), np.array(scene["caster"]["bbox_max_m"])
        radius, height = (upper - lower)[:2].mean() / 2, upper[2]
        double = revolved([(0, 0), (radius, 0), (radius, height), (0, height)], 64)
        double = double.moved(1.0, np.array([*(lower + upper)[:2] / 2, 0]))
        camera = Camera(size, np.array(scene["K"]), np.zeros(5), "file")
        white = np.full_like(image, 255)
        tracked = stage.tracked(white, rigid(scene["R"], scene["t"]), camera)
        light = Light(np.array(scene["lights"][0]["dir_to_light"]), shadow_rgb_ratio=np.zeros(3))
        renderer = make_renderer(size=size)
        renderer.render(Scene(tracked, stage.placed(double), Illumination((light,))))
        found = (renderer.read_bgr().max(axis=2) < HALF_LIT) & ~hidden
        both, either = (found & truth).sum(), ((found | truth) & ~hidden).sum()
        assert both / either > 0.98, scene["id"]
        compared += 1
    assert compared >= 3
