"""`ashe-live bench`: every flag reaches the bench that it is for, and what nobody says has the documented default."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from ashe_live.bench.bench import Bench
from ashe_live.cli import run
from ashe_live.quality import QUALITIES

A, B = Path("a").absolute(), Path("b").absolute()
# Bench and the fields that its flags set.
GIVEN: dict[str, tuple[str, dict[str, Any]]] = {
    "viewer --frames 7 --size 320x240 --quality accurate --estimator paper": (
        "ViewerBench",
        {"frames": 7, "size": (320, 240), "quality": QUALITIES["accurate"], "estimator": "paper"},
    ),
    "viewer": ("ViewerBench", {"frames": 600, "size": None, "quality": QUALITIES["fast"], "estimator": "proxy"}),
    "soak --frames 7 --quality balanced": ("SoakBench", {"frames": 7, "quality": QUALITIES["balanced"]}),
    "soak": ("SoakBench", {"frames": 100_000, "quality": QUALITIES["fast"]}),
    "render --frames 7 --pairs a": ("RenderBench", {"frames": 7, "pairs": A}),
    "render": ("RenderBench", {"frames": 100, "pairs": None}),
    "render --budget a": ("BudgetBench", {"pairs": A}),
    "light --scenes a b --limit 5 --casters --tracked --empty b": (
        "LightBench",
        {
            "scenes": [A, B],
            "limit": 5,
            "casters": True,
            "tracked": True,
            "empty": B,
            "quick": False,
            "sweeps": True,
            "presets": tuple(QUALITIES),
        },
    ),
    "light --scenes a --quick": ("LightBench", {"quick": True, "presets": ("balanced",), "sweeps": False}),
    "light --scenes a --estimator paper": (
        "LightBench",
        {"estimator": "paper", "presets": ("balanced",), "sweeps": False, "quick": False},
    ),
    "fit-judge --scenes a b --limit 9 --every 3 --jobs 2": (
        "JudgeBench",
        {"scenes": [A, B], "limit": 9, "every": 3, "jobs": 2},
    ),
    "fit-judge --scenes a": ("JudgeBench", {"limit": None, "every": 1, "jobs": 1}),
    "fit-judge --scenes a --casters": ("KnownBodiesBench", {"scenes": [A]}),
    "fit-judge --scenes a --confidence": ("RecalibrationBench", {"scenes": [A]}),
    "fit-judge --scenes a --sheets --limit 4": ("SheetsBench", {"scenes": [A], "limit": 4}),
    "fit-lamps --scenes a --limit 4": ("LampBench", {"scenes": [A], "limit": 4}),
    "fit-seconds --scenes a --limit 4 --every 2": ("SecondLightsBench", {"scenes": [A], "limit": 4, "every": 2}),
    "cube --count 7 --seed 3 --quality fast --scenes a": (
        "CubeBench",
        {"count": 7, "seed": 3, "quality": QUALITIES["fast"], "scenes": [A]},
    ),
    "cube": ("CubeBench", {"count": 40, "seed": 0, "quality": QUALITIES["balanced"]}),
    "track --real a --photos b --scenes a b --quick --quality fast": (
        "TrackBench",
        {"real": A, "photos": B, "scenes": (A, B), "quick": True, "preset": QUALITIES["fast"].tracking},
    ),
    "track": ("TrackBench", {"real": None, "photos": None, "scenes": (), "quick": False}),
}


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[tuple[Bench, Path | None, bool]]:
    """What would have been run: the bench, where its results go, and whether they replace others."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    benches: list[tuple[Bench, Path | None, bool]] = []
    monkeypatch.setattr(Bench, "run", lambda bench, out, overwrite: benches.append((bench, out, overwrite)))
    return benches


@pytest.mark.parametrize("arguments", GIVEN)
def test_flags_are_the_settings_of_the_bench(ran: list[tuple[Bench, Path | None, bool]], arguments: str) -> None:
    name, expected = GIVEN[arguments]
    for more, out, overwrite in (((), None, False), (("--out", "b", "--overwrite"), B, True)):
        assert run(["bench", *arguments.split(), *more]) == 0
        bench, *where = ran.pop()
        assert type(bench).__name__ == name
        settings = {field.name: getattr(bench, field.name) for field in fields(bench)}
        for setting, value in expected.items():
            found = settings[setting]
            assert absolute(found) == value
        assert (absolute(where[0]), where[1]) == (out, overwrite)


def absolute(value: Any) -> Any:
    """Paths are told apart by where they lead."""
    if isinstance(value, Path):
        return value.absolute()
    if isinstance(value, list | tuple) and value and isinstance(value[0], Path):
        return type(value)(each.absolute() for each in value)
    return value


@pytest.mark.parametrize("bench", ["viewer", "soak", "cube", "track"])
def test_what_is_not_measured_is_neither_offered_nor_taken(
    ran: list[tuple[Bench, Path | None, bool]], capsys: pytest.CaptureFixture[str], bench: str
) -> None:
    """A quality that changes as it runs, and what lights are taken for, which these benches say nothing of."""
    for asked, named in ((("--quality", "auto"), "--quality: invalid choice"), (("--light", "lamp"), "--light")):
        with pytest.raises(SystemExit, match="2"):
            run(["bench", bench, *asked])
        assert named in capsys.readouterr().err
    assert ran == []
    with pytest.raises(SystemExit, match="0"):
        run(["bench", bench, "--help"])
    offered = capsys.readouterr().out
    assert "auto" not in offered
    assert "--light" not in offered
