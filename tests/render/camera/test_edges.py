import numpy as np

from ashe_live.render.camera.edges import edge_blur_px, profile_at


def test_a_sharp_edge_has_no_blur() -> None:
    grey = np.full((80, 80), 200, np.uint8)
    grey[20:60, 20:60] = 30
    assert edge_blur_px(grey, np.array([(19.5, 19.5), (59.5, 19.5), (59.5, 59.5), (19.5, 59.5)])) < 0.3


def test_places_without_an_edge_do_not_count_where_most_edges_are_the_other_way_round() -> None:
    """From dark to light is asked for; of 60 rows 33 go from light to dark, and three are all of one grey."""
    grey = np.zeros((60, 40), np.uint8)
    grey[:24, 20:] = 200
    grey[24:57, :20] = 200
    grey[57:] = 90
    rows = np.arange(1.0, 59.0)
    points = np.column_stack([np.full(len(rows), 19.5), rows])
    profile = profile_at(grey, points, np.tile((1.0, 0.0), (len(rows), 1)), 7.0)
    assert profile is not None
    assert (rows[profile.used] < 24).all()
