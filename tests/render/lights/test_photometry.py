"""What the picture shows of its light does not change with the light that a person sets."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.quality import FAST
from ashe_live.render.lights import photometry
from ashe_live.render.lights.light_map import HEIGHT_PX, light_map
from ashe_live.render.lights.photometry import Photometry

SIDE_M = 0.08
CAMERA = Camera((320, 240), np.array([[400.0, 0, 159.5], [0, 400, 119.5], [0, 0, 1]]), np.zeros(5), "file")
POSE = rigid([[1, 0, 0], [0, -0.6, -0.8], [0, 0.8, -0.6]], [0.0, 0.0, 0.6])
# A carton beside the marker, as wide as its whole sheet: a low light behind it leaves the print in its shadow.
CARTON = Proxy("box", np.array([(x, y, z, 0, 0) for x in (0.1, 0.14) for y in (-0.15, 0.15) for z in (0.0, 0.2)]))
GROUND = np.full(3, 0.3)
RATIO = np.array([0.2, 0.3, 0.4])


def seen() -> TrackedFrame:
    """A print in full light on grey ground."""
    image: Image = np.full((240, 320, 3), 150, np.uint8)
    for side, level in ((2.0, 210), (1.0, 50)):
        outline = project(CAMERA, POSE, square_corners(side * SIDE_M))
        cv2.fillConvexPoly(image, np.round(outline).astype(np.int32), (level,) * 3)
    corners = project(CAMERA, POSE, square_corners(SIDE_M))
    return TrackedFrame(Frame(image, 0, 0.0), CAMERA, MarkerPose(POSE, corners, SIDE_M, 0.0, None))


ESTIMATED = Light((-0.6, 0.3, 0.7), shadow_rgb_ratio=RATIO)


@pytest.mark.parametrize("towards", [(0.6, 0.0, 0.4), (0.0, 0.2, 0.9)], ids=["behind the carton", "overhead"])
def test_a_light_by_hand_changes_nothing_of_what_is_read_in_the_picture(towards: tuple[float, float, float]) -> None:
    tracked = seen()
    estimated = Illumination((ESTIMATED,), RATIO, GROUND, CARTON, tracked)
    by_hand = estimated.relit((Light(towards, shadow_rgb_ratio=RATIO),), RATIO)
    read, turned = Photometry(FAST.render), Photometry(FAST.render)
    lighting, lighting_by_hand = read.lighting(estimated), turned.lighting(by_hand)
    assert lighting_by_hand.lights[0].to_light == pytest.approx(by_hand.lights[0].to_light_marker)
    assert lighting_by_hand.sky == pytest.approx(lighting.sky)  # the sky is as open, wherever the light stands
    assert lighting_by_hand.bounce == pytest.approx(lighting.bounce, rel=0.1)
    assert turned.white_seen_in(by_hand) == read.white_seen_in(estimated)
    saved = np.median(light_map(by_hand)[: HEIGHT_PX // 2], axis=(0, 1))
    assert saved == pytest.approx(np.array(lighting.sky), rel=1e-5)


def test_the_same_lights_are_the_same_object_while_the_video_is_lit_by_others() -> None:
    """The renderer asks for both in turn, and takes a new object for a change of the light."""
    estimated = Illumination((ESTIMATED,), RATIO, GROUND, CARTON, seen())
    moved = estimated.relit((Light((0.0, 0.5, 0.8), shadow_rgb_ratio=RATIO),), RATIO)
    by_hand = estimated.relit((Light((0.6, 0.0, 0.4), shadow_rgb_ratio=RATIO),), RATIO)
    measured = Photometry(FAST.render)
    first = [measured.lighting(each) for each in (by_hand, moved, estimated)]
    again = [measured.lighting(each) for each in (by_hand, moved, estimated)]
    assert all(one is other for one, other in zip(first, again, strict=True))
    for of, lighting in zip((by_hand, moved, estimated), first, strict=True):
        assert lighting.lights[0].to_light == pytest.approx(of.lights[0].to_light_marker)
    later = Illumination((Light((0.0, -0.6, 0.7), shadow_rgb_ratio=0.5 * RATIO),), 0.5 * RATIO, GROUND)
    assert measured.lighting(later).sky == pytest.approx(0.5 * RATIO, rel=0.05)


def test_a_shadows_border_is_measured_once_in_shares_of_the_width_where_there_is_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[object] = []

    def eight_px(*of: object) -> float:
        asked.append(of)
        return 8.0

    monkeypatch.setattr(photometry, "unexplained_border_px", eight_px)
    tracked = seen()
    estimated = Illumination((ESTIMATED,), RATIO, GROUND, CARTON, tracked)
    by_hand = estimated.relit((Light((0.0, 0.2, 0.9), shadow_rgb_ratio=RATIO),), RATIO)
    read = Photometry(replace(FAST.render, matches_blur=True))
    assert [read.border_share(each) for each in (estimated, by_hand, estimated)] == [8 / 320] * 3
    assert asked == [(tracked, CARTON, read.lighting(estimated).lights[0])]
    nothing = [replace(estimated, seen_in=None), replace(estimated, real_object=None), replace(estimated, lights=())]
    assert [read.border_share(each) for each in nothing] == [0] * 3
    assert Photometry(replace(FAST.render, matches_blur=False)).border_share(estimated) == 0
    assert len(asked) == 1
    assert read.border_share(replace(estimated, seen_in=seen())) == 8 / 320
    assert len(asked) == 2
