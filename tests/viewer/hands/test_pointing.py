"""Where somebody points, through letterbox and lens."""

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.render.beside import picture_axes
from ashe_live.tracking.edges.lens import source_from_ideal
from ashe_live.viewer.hands.pointing import ground_at, in_mirror, in_video, pixel_of, source_pixel
from ashe_live.viewer.hands.requests import Command, Drag, Files, Request
from tests.camera_poses import looking_at

SIZE = (640, 480)
PINHOLE = Camera.from_focal(SIZE, 600.0)
BENT = Camera(SIZE, PINHOLE.K, np.array((-0.25, 0.08, 0.001, -0.001, 0.0)), "file")


def seen_from(eye: tuple[float, float, float], camera: Camera = PINHOLE, roll_rad: float = 0.0) -> TrackedFrame:
    """A marker at which a camera looks from `eye`."""
    cosine, sine = np.cos(roll_rad), np.sin(roll_rad)
    rolled = rigid([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]], (0, 0, 0))
    pose = MarkerPose(rolled @ looking_at((0, 0, 0), eye), np.zeros((4, 2)), 0.08, 0.1, None)
    return TrackedFrame(Frame(np.zeros((SIZE[1], SIZE[0], 3), np.uint8), 0, 0.0), camera, pose)


def test_the_letterbox_is_left_out():
    assert source_pixel((0, 0), SIZE, SIZE) == (-0.5, -0.5)  # the picture's very corner
    assert source_pixel((320.5, 240.5), SIZE, SIZE) == (320, 240)
    # Wider by 160 on each side, and twice as large.
    assert source_pixel((160 + 641, 481), (1600, 960), SIZE) == (320, 240)
    assert source_pixel((320.5, 60 + 240.5), (640, 600), SIZE) == (320, 240)


def test_a_drag_is_one_in_the_video():
    shown = seen_from((0.2, -0.4, 0.3))
    request = Request(Command.MOVE_LIGHT, Drag((161, 1), (163, 5), True))
    assert in_video(request, (1600, 960), shown) == Request(Command.MOVE_LIGHT, Drag((0, 0), (1, 2), True))
    assert in_video(request, (1600, 960), None) is in_video(request, (0, 0), shown) is request
    other = Request(Command.SCALE_MODEL, 1.0)
    assert in_video(other, (1600, 960), shown) is other


def test_in_a_mirror_right_is_left():
    drag = Request(Command.MOVE_MODEL, Drag((10, 20), (13, 25), False))
    assert in_mirror(drag, (640, 480)) == Request(Command.MOVE_MODEL, Drag((630, 20), (627, 25), False))
    assert in_mirror(Request(Command.MOVE_LIGHT, (1, -2)), (640, 480)) == Request(Command.MOVE_LIGHT, (-1, -2))
    for same in (Request(Command.SCALE_MODEL, 2), Request(Command.OPEN, Files(("a.glb",))), Request(Command.HELP)):
        assert in_mirror(same, (640, 480)) is same


@pytest.mark.parametrize("camera", [PINHOLE, BENT], ids=["pinhole", "lens"])
def test_ground_and_pixel_are_each_others_inverse_and_opencvs(camera):
    tracked = seen_from((0.2, -0.4, 0.3), camera)
    for point in ((0.0, 0.0), (0.08, -0.05), (-0.1, 0.12)):
        ideal = project(camera, tracked.marker.T_cam_marker, [(*point, 0.0)])
        pixel = tuple(source_from_ideal(camera, ideal)[0])
        assert pixel_of(tracked, np.array(point)) == pytest.approx(pixel, abs=1e-9)
        np.testing.assert_allclose(ground_at(tracked, pixel), point, atol=1e-5)


def test_where_no_plane_is_there_is_no_point():
    grazing = seen_from((0.0, -0.5, 0.02))
    assert ground_at(grazing, (320, 400)) is not None
    assert ground_at(grazing, (320, 20)) is None  # above the horizon
    edge_on = seen_from((0.0, -0.5, 0.0))
    assert all(ground_at(edge_on, (320, row)) is None for row in (0, 100, 240, 400))
    assert pixel_of(grazing, np.array((0.0, -3.0))) is None  # behind the camera
    assert pixel_of(grazing, np.array((9.0, 0.0))) is None  # beside the picture
    assert pixel_of(seen_from((0.0, -0.5, 0.3)), np.array((0.0, -0.45))) is None  # below it
    nowhere = TrackedFrame(grazing.frame, PINHOLE, None)
    assert ground_at(nowhere, (320, 400)) is pixel_of(nowhere, np.zeros(2)) is None


@pytest.mark.parametrize("eye", [(0.0, -0.5, 0.3), (0.4, 0.1, 0.3), (-0.2, 0.3, 0.6)])
@pytest.mark.parametrize("roll_deg", [0, 20])
def test_to_the_right_is_to_the_right_in_the_picture_and_away_is_up(eye, roll_deg):
    tracked = seen_from(eye, roll_rad=np.radians(roll_deg))
    centre = np.array(pixel_of(tracked, np.zeros(2)))
    right, away = (np.array(pixel_of(tracked, 0.01 * axis)) - centre for axis in picture_axes(tracked))
    assert right[0] > 3 * abs(right[1]) * (roll_deg == 0)
    assert right[0] > 0
    assert away[1] < 0
    for axis in picture_axes(tracked):
        assert np.linalg.norm(axis) == pytest.approx(1)


def test_axes_are_there_for_every_pose():
    sideways = seen_from((0.0, -0.5, 0.0), roll_rad=np.pi / 2)  # the picture's right is the marker's z
    assert np.isfinite(picture_axes(sideways)).all()
