"""The viewer bench's tables: each figure under its heading."""

from ashe_live.bench.viewer.tables import print_viewer_figures
from tests.bench.printed import printed


def percentiles(of: float) -> dict[str, float]:
    return {"p50": of, "p95": of + 1, "p99": of + 2}


def test_stages_rates_and_states_stand_under_their_headings() -> None:
    states = {
        state: {
            "work_ms": percentiles(at),
            "interval_ms": percentiles(at + 5),
            "estimates_ms": [1.0] * count,
            "p99_ratio": ratio,
        }
        for state, at, count, ratio in (("idle", 10, 0, 1.0), ("estimating", 20, 4, 1.5), ("sharpening", 30, 7, 1.25))
    }
    stages = {"whole": percentiles(8) | {"mean_cpu": 3.0}, "blit": percentiles(2) | {"mean_cpu": 0.5}}
    record = {
        "clip": "a.mp4",
        "size": [640, 480],
        "quality": "fast",
        "frames": 50,
        "first_picture": {"headless": {"wall_s": 1.25, "cpu_s": 0.75}, "window": None},
        "unpaced": {"fps": 99.6, "stages_ms": stages},
        "paced": {"rate_hz": 60.0, **states},
        "key_views": {"mean_ms": 0.1234, "mib": 5.25},
    }
    found = printed(print_viewer_figures, record)
    unpaced, paced = found.tables
    assert unpaced == {
        ("whole",): {"median": "8.00", "p95": "9.00", "p99": "10.00", "CPU": "3.00"},
        ("(the bare video)",): {"median": "2.00", "p95": "3.00", "p99": "4.00", "CPU": "0.50"},
    }
    assert {name: row["median"] for (name,), row in paced.items()} == {
        "idle, work": "10.00",
        "idle, interval": "15.00",
        "estimating, work": "20.00",
        "estimating, interval": "25.00",
        "sharpening, work": "30.00",
        "sharpening, interval": "35.00",
    }
    assert paced["idle, work",] == {"median": "10.00", "p95": "11.00", "p99": "12.00"}
    assert "first picture, headless: 1.25 s (0.75 s of processor time)" in found.lines
    assert not any("window" in line for line in found.lines)
    assert "100 fps\n" in found.lines
    assert "p99 of the work while estimating is 1.50 times idle; 4 estimates ended" in found.lines
    assert "p99 of the work while sharpening is 1.25 times idle; 7 estimates ended" in found.lines
    assert found.lines[-1] == "key views: 0.123 ms a frame to choose them, 5.2 MiB"
