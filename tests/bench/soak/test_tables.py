"""The soak bench's tables: each figure under its heading, and a verdict for what grows."""

from typing import Any

from ashe_live.bench.soak.tables import print_soak_figures
from tests.bench.printed import printed


def record(**others: Any) -> dict[str, Any]:
    flat = {"first": 100.0, "last": 101.25, "per_1000_frames": 0.5, "is_flat": True}
    unknown = dict.fromkeys(flat)
    held = {"rss_mib": flat, "children_rss_mib": unknown, "gl_objects": flat | {"is_flat": False}}
    median_ms = {"drawn": {"first_tenth": 10.0, "last_tenth": 12.5}}
    soak = {
        "frames": 900,
        "seconds": 12.4,
        "model_switches": 9,
        "estimates": 3,
        "key_views_mib": 7.25,
        "held": held | {"open_files": unknown, "threads": unknown},
        "drift": {"median_ms": median_ms, "is_steady": False},
        "left_running": [],
    }
    unread = {"camera_hz": 60.0, "pictures": 0, "age_ms": None, "over_bound_ms": None}
    age = {
        "camera_hz": 30.0,
        "pictures": 50,
        "age_ms": {"p50": 41.0, "p95": 42.0, "p99": 43.0},
        "over_bound_ms": {"p50": -9.0, "p95": -8.0, "p99": -7.0},
        "longest_over_bound_ms": 6.5,
        "within_bound_share": 0.985,
    }
    return {"display_hz": 60.0, "age": [age, unread], "soak": soak | others}


def test_ages_and_what_is_held_stand_under_their_headings_and_what_is_not_known_is_left_out() -> None:
    found = printed(print_soak_figures, record(left_running=["forgotten"]))
    ages, held, times = found.tables
    assert ages == {
        ("30 Hz",): {
            "pictures": "50",
            "median": "41.0",
            "p95": "42.0",
            "p99": "43.0",
            "beyond the bound: p99": "-7.0",
            "longest": "6.5",
            "within": "98.5%",
        }
    }
    numbers = {"first": "100.0", "last": "101.2", "in 1000 frames": "+0.5000"}
    assert held == {("memory, MiB",): numbers | {"": "flat"}, ("OpenGL objects",): numbers | {"": "GROWS"}}
    assert times == {("drawn",): {"first tenth": "10.00", "last tenth": "12.50", "ratio": "1.250"}}
    summary, verdict, left = found.lines
    assert summary == "900 frames in 12 s, 9 switches of the model, 3 estimates, key views of at most 7.2 MiB"
    assert verdict.startswith("SLOWER")
    assert left == "left running at the end: forgotten"


def test_too_few_frames_tell_no_drift_and_a_steady_run_has_none() -> None:
    steady = {"median_ms": {}, "is_steady": True}
    for drift, said in ((None, "too few frames to tell"), (steady, "no drift")):
        assert printed(print_soak_figures, record(drift=drift)).lines[1].startswith(said)
