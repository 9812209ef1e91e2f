"""The tracking bench's tables: each figure under its heading, beside its target."""

from ashe_live.bench.track.clips import ClipFigures
from ashe_live.bench.track.tables import Figure, print_clips, print_errors, print_figures
from tests.bench.printed import printed


def test_a_figure_stands_beside_its_target_and_whether_that_is_met() -> None:
    figures = [
        Figure("cost", "ms", 2.0, 1.0, 0.8),
        Figure("found", "%", 50.0, 75.0, None, least=50.0),
        Figure("ratio", "", None, 1.25, 1.4, 0.6),
        Figure("lag", "ms", 0.1234, None, None),
    ]
    (rows,) = printed(print_figures, figures).tables
    assert {name: [*row.values()] for (name,), row in rows.items()} == {
        "cost (ms)": ["2", "1", "≤ 0.8", "MISSED"],
        "found (%)": ["50", "75", "≥ 50", "met"],
        "ratio": ["-", "1.25", "0.6 to 1.4", "met"],
        "lag (ms)": ["0.123", "-", "", ""],
    }
    assert [*rows["ratio",]][:3] == ["OpenCV", "ours", "target"]


def test_a_clip_has_a_row() -> None:
    (rows,) = printed(print_clips, [ClipFigures("a.mp4", 200, 0.905, 3, 12.34, 0.0567, 0.0891, 4.56)]).tables
    assert rows["a.mp4",] == {
        "frames": "200",
        "found": "90.5 %",
        "bridged": "3",
        "largest turn": "12.3°",
        "jitter, px": "0.057",
        "unfiltered, px": "0.089",
        "median ms": "4.6",
    }


def test_errors_in_use_stand_beside_those_that_were_fitted() -> None:
    (rows,) = printed(lambda console, used: print_errors(console, used, {"end_px": 0.2}), {"end_px": 0.1}).tables
    assert rows == {("end_px",): {"in use": "0.1", "fitted to these pictures": "0.2"}}
