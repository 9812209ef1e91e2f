"""What the cover of a marker is made of."""

from dataclasses import replace

import numpy as np

from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.render.cover import ground_cover as ground_cover_module
from ashe_live.render.cover.ground_cover import ground_cover
from ashe_live.render.cover.rectified import Rectified, rectified

SIDE = 0.08
PAPER = 0.7  # linear light


def _on_page(stage) -> TrackedFrame:
    """A marker on a page on a dark table with strong grain. The page goes on beyond reach on the left."""
    camera, T = stage.camera(), stage.pose(-80, 70, 0.55, target=(-0.08, 0, 0))
    rows, columns = np.mgrid[0:360, 0:480]
    x, y, _ = raycast_to_plane(camera, T, np.column_stack([columns.ravel(), rows.ravel()]).astype(float)).T
    linear = 0.1 + 0.06 * np.sin(300 * y + 150 * x)
    linear[(x > -0.5) & (x < 0.066) & (y > -0.12) & (y < 0.07)] = PAPER
    linear[np.maximum(np.abs(x), np.abs(y)) < SIDE / 2] = 0.03
    grey = np.round(255 * srgb_from_linear(linear)).astype(np.uint8).reshape(360, 480)
    frame = Frame(np.repeat(grey[..., None], 3, axis=2), 0, 0.0)
    marker = MarkerPose(T, project(camera, T, square_corners(SIDE)), SIDE, 0.0, None)
    return TrackedFrame(frame, camera, marker)


def test_what_covers_a_marker_on_a_page_is_paper_and_nothing_of_the_grain_beyond(stage) -> None:
    cover = ground_cover(_on_page(stage), Illumination())
    assert cover is not None
    colours = cover.image_rgba[cover.image_rgba[..., 3] == 255][:, :3].astype(float)
    assert np.abs(colours - 255 * srgb_from_linear(np.array(PAPER))).max() < 5


def test_a_marker_is_covered_also_where_the_real_object_hides_the_rest_of_its_page(stage, monkeypatch) -> None:
    def with_page_hidden(*asked) -> Rectified:
        plane = rectified(*asked)
        return replace(plane, is_seen=plane.is_seen & (plane.linear.max(axis=2) < PAPER / 2))

    monkeypatch.setattr(ground_cover_module, "rectified", with_page_hidden)
    assert ground_cover(_on_page(stage), Illumination()) is not None
