"""The printed tables: each figure is that of its heading, of the pictures of its row."""

from dataclasses import replace
from typing import Any

from ashe_live.bench.light.clips import ClipResult
from ashe_live.bench.light.known_casters import print_known_casters
from ashe_live.bench.light.lamps import LampFigures
from ashe_live.bench.light.preset_tables import WORST, print_preset
from ashe_live.bench.light.results import CaseResult, grouped, stage_times, summarise
from ashe_live.bench.light.set_tables import (
    print_clips,
    print_lamp_takes,
    print_lamps,
    print_places,
    print_risk,
    print_takes,
)
from ashe_live.bench.light.takes import TakeResult
from tests.bench.printed import Printed, printed

Rows = dict[tuple[str, ...], dict[str, str]]


def result(error_deg: float | None, confidence: float | None = 0.9, **others: Any) -> CaseResult:
    """Of a lit picture that is answered, unless `error_deg` is None."""
    given = {
        "preset": "fast",
        "folder": "set",
        "case": "a",
        "category": "clean",
        "caster": "box",
        "true_lights": 1,
        "lights": () if error_deg is None else ({},),
        "reason": "no shadow" if error_deg is None else None,
        "error_deg": error_deg,
        "sigma_deg": None if error_deg is None else 3.0,
        "squared_sigmas": None if error_deg is None else error_deg,
        "confidence": None if error_deg is None else confidence,
        "object_iou": 0.9,
        "shadow_iou": 0.8,
        "true_labels_deg": None,
        "wall_ms": {"total": 20.0},
        "cpu_ms": 30.0,
        "lamp": None,
    }
    return CaseResult(**{**given, **others})


def unlit(confidence: float) -> CaseResult:
    """Answered, where there is no light."""
    return replace(result(0.0, confidence), true_lights=0, error_deg=None, sigma_deg=None, squared_sigmas=None)


def test_risk_is_that_of_the_surest_answers_which_cover_so_many_pictures_with_a_light() -> None:
    fast = [
        result(2.0, 0.9),
        result(3.0, 0.8),
        result(40.0, 0.7),
        result(None),
        unlit(0.6),
    ]
    slow = [result(1.0, 0.75, preset="slow"), result(1.0, 0.75, preset="slow", folder="other")]
    (rows,) = printed(print_risk, fast + slow, keys=2).tables
    assert list(rows) == [("set", "fast"), ("set", "slow"), ("other", "fast"), ("other", "slow")]
    assert rows["set", "fast"] == {
        "lit": "4",
        "answered": "75%",
        "risk at 50%": "0%",
        "risk at 60%": "33%",
        "risk at 70%": "33%",
        "risk at 80%": "-",
        "risk at 90%": "-",
        "calibration error": f"{(0.1 + 0.2 + 0.7 + 0.6) / 4:.2f}",
    }
    assert rows["set", "slow"]["calibration error"] == rows["other", "slow"]["calibration error"] == "0.25"
    assert rows["other", "fast"]["lit"] == "0"


def test_takes_are_summed_up_by_their_span_and_the_number_of_views() -> None:
    def take(span_deg: float, views: int, *given: Any, **others: Any) -> TakeResult:
        return TakeResult(span_deg, views, views, result(*given, case=f"{span_deg}", **others))

    takes = [
        take(6.0, 1, 2.0, 0.9),
        take(6.0, 1, 4.0, 0.6),
        take(6.0, 1, 30.0, 0.6),
        take(6.0, 1, None),
        TakeResult(6.0, 1, 1, unlit(0.9)),
        take(6.0, 2, 1.0, 0.8),
        take(40.0, 1, 6.0, 0.9),
        take(40.0, 1, 3.0, 0.9, preset="slow", wall_ms={"total": 50.0}),
    ]
    found = printed(print_takes, takes, keys=2)
    fast, slow = found.tables
    assert [title.partition(":")[0] for title in found.titles] == ["fast", "slow"]
    assert list(fast) == [("6°", "1"), ("6°", "2"), ("40°", "1"), ("all", "1"), ("all", "2")]
    assert fast["6°", "1"] == {
        "lit": "4",
        "answered": "75%",
        "median": "4.0°",
        "p95": "27.4°",
        "within 1 σ": "33%",
        "95 % ellipse": "67%",
        "sure and wrong": "40%",  # of all five
        "confidence": "0.70",
        "ms": "20",
    }
    assert (fast["6°", "2"]["median"], fast["all", "1"]["lit"], slow["40°", "1"]["ms"]) == ("1.0°", "5", "50")
    # The take of 6° is surer in one view, where it is right; the others have no second number of views.
    assert [line.rpartition(": ")[2] for line in found.lines] == ["1 of 2", "0 of 0"]


def lamp(distance_m: float | None, error_deg: float = 2.0, is_stated: bool = True, **others: Any) -> CaseResult:
    off = {
        "beside_deg": 2 * error_deg,
        "distance_error": 0.1,
        "sigmas": 0.5,
        "squared_sigmas": 9.0,
        "radius_error": 0.4,
    }
    figures = LampFigures(distance_m, is_stated, **(off if is_stated else {"beside_deg": 2 * error_deg}))
    return result(error_deg, **{"lamp": figures, **others})


LAMPS = [
    lamp(None, 1.0, is_stated=False),
    lamp(0.4, 2.0),
    lamp(0.6, 4.0, is_stated=False),
    lamp(1.1, 3.0),
    lamp(1.2, 5.0),
    result(None, lamp=LampFigures(1.2, is_stated=False)),
    result(7.0),  # of two lights
]


def test_lamps_are_summed_up_by_their_distance() -> None:
    found = printed(print_lamps, [*LAMPS, lamp(0.5, 9.0, preset="slow")], keys=2)
    (rows,) = found.tables
    of_fast = {light: row for (name, light), row in rows.items() if name == "set, fast"}
    assert {light: row["lit"] for light, row in of_fast.items()} == {
        "sun": "1",
        "lamp up to 60 cm": "2",
        "up to 110 cm": "1",
        "farther": "2",
        "all lamps": "5",
    }
    assert of_fast["lamp up to 60 cm"] == {
        "lit": "2",
        "answered": "100%",
        "as a lamp": "50%",
        "median": "3.0°",
        "p90": "3.8°",
        "beside the object": "6.0°",
        "distance off": "10%",
        "q within 1 σ": "100%",
        "95 % ellipsoid": "0%",
        "radius told": "100%",
        "radius off": "40%",
    }
    assert (of_fast["farther"]["answered"], of_fast["sun"]["as a lamp"]) == ("50%", "0%")
    assert set(rows) - {("set, fast", light) for light in of_fast} == {
        ("set, slow", "lamp up to 60 cm"),
        ("set, slow", "all lamps"),
    }
    assert (
        printed(print_lamps, [each for each in LAMPS if each.lamp is None or not each.lamp.true_distance_m]).tables
        == []
    )


def test_lamps_in_takes_are_summed_up_by_the_number_of_views_and_those_of_a_wide_span_once_more() -> None:
    takes = [TakeResult(span, views, views, lamp(0.5)) for span, views in ((6.0, 2), (6.0, 1), (12.0, 1), (40.0, 2))]
    every, wide = printed(print_lamp_takes, takes, keys=2).tables
    groups = [("fast, 1 views", "lamp up to 60 cm"), ("fast, 1 views", "all lamps")]
    groups += [(name.replace("1", "2"), light) for name, light in groups]
    assert list(every) == list(wide) == groups
    assert {row["lit"] for row in every.values()} == {"2"}
    assert {row["lit"] for row in wide.values()} == {"1"}


def test_categories_with_lamps_have_their_median_and_their_largest_errors() -> None:
    near = [lamp(0.5, error, category="near") for error in (1.0, 2.0, 30.0)]
    (rows,) = printed(print_places, [*near, *LAMPS, lamp(0.5, 4.0, preset="slow")], keys=2).tables
    assert list(rows) == [("fast", "near"), ("fast", "clean"), ("slow", "clean")]
    assert rows["fast", "near"] == {
        "q 1/m": "2.00",
        "lit": "3",
        "answered": "100%",
        "as a lamp": "100%",
        "median": "2.0°",
        "largest": "30.0°",
        "sure and wrong": "1",
        "distance off": "10%",
        "q off, σ": "0.50",
    }
    # Of a sun, which is infinitely far, and of lamps at 0.4, 0.6, 1.1 and twice 1.2 m.
    assert rows["fast", "clean"]["q 1/m"] == f"{(1 / 1.1 + 1 / 1.2) / 2:.2f}"
    assert printed(print_places, near).tables == [], "a single category"
    assert printed(print_places, [lamp(None, category=name) for name in "ab"]).tables == [], "suns alone"


def test_known_casters_are_compared_on_the_same_pictures() -> None:
    """Of three boxes and a ball; pictures of what is not known are left out, and presets are apart."""
    kinds = {"a": "box", "b": "box", "c": "box", "d": "sphere"}
    by = {"free": {"a": 2.0, "b": None, "c": 20.0, "d": 5.0}, "known": {"a": 1.0, "b": 3.0, "c": None, "d": 4.0}}
    free, known = (
        [result(error, case=case, caster=kinds[case]) for case, error in each.items()] for each in by.values()
    )
    free += [result(90.0, case="e", caster="mug"), result(90.0, case="a", folder="other")]
    free += [result(8.0, case=case, preset="slow") for case in "ab"]
    known.append(result(7.0, case="a", caster="box", preset="slow"))
    console = Printed(keys=3)
    print_known_casters(console, free, known)
    (rows,) = console.tables
    assert [key[0] for key in rows] == ["all"] * 4 + ["box"] * 4 + ["sphere"] * 4
    assert rows["box", "fast", "any object"] == {
        "pictures": "3",
        "answered": "67%",
        "median": "11.0°",
        "of those answered both ways": "2.0°",
        "p90": "18.2°",
        "95 % ellipse": "50%",
        "sure and wrong": "33%",
    }
    assert rows["box", "fast", "known"] == {
        "pictures": "3",
        "answered": "67%",
        "median": "2.0°",
        "of those answered both ways": "1.0°",
        "p90": "2.8°",
        "95 % ellipse": "100%",
        "sure and wrong": "0%",
    }
    assert [rows["all", "fast", name]["of those answered both ways"] for name in ("any object", "known")] == [
        "3.5°",
        "2.5°",
    ]
    assert [rows["all", "slow", name]["pictures"] for name in ("any object", "known")] == ["2", "1"]


def test_clips_have_a_row_each() -> None:
    (rows,) = printed(print_clips, [ClipResult("fast", "a.mp4", "truth", 9, 2, 3, 1.25, 2.5)], keys=2).tables
    counts = {"frames": "9", "no marker": "2", "none": "3"}
    assert rows == {("a.mp4", "fast"): {**counts, "about": "truth", "RMS": "1.2°", "max": "2.5°"}}


def test_a_preset_has_its_errors_their_origin_their_honesty_its_times_and_its_worst() -> None:
    results = [
        result(float(error), case=f"{error}", true_labels_deg=error / 2, wall_ms={"fit": 5.0, "total": 10.0 + error})
        for error in range(12)
    ]
    results += [
        result(None, category="hard"),
        result(None, category="hard"),
        result(None, category="hard", reason="dark"),
    ]
    results.append(unlit(0.9))
    console = Printed()
    summaries = {name: summarise(group) for name, group in grouped(results).items()}
    print_preset(console, "fast", summaries, stage_times(results), results)
    errors, origins, honesty, times, worst = console.tables
    assert list(errors) == list(origins) == list(honesty) == [("clean",), ("hard",), ("all lit",), ("all",)]
    assert errors["all lit",] == {
        "cases": "15",
        "none": "3",
        "mean": "5.5°",
        "median": "5.5°",
        "p90": "9.9°",
        "max": "11.0°",
        "< 5°": "33%",
        "count right": "80%",
        "ms": "17",
        "p95": "20",
    }
    assert errors["hard",] == dict.fromkeys(errors["hard",], "-") | {
        "cases": "3", "none": "3", "< 5°": "0%", "count right": "0%", "ms": "20", "p95": "20"
    }  # fmt: skip
    assert origins["clean",] == {
        "IoU object": "0.90",
        "IoU shadow": "0.80",
        "mean": "5.5°",
        "from true labels: mean": "2.8°",
        "median": "2.8°",
        "max": "5.5°",
    }
    assert honesty["clean",] == {
        "within 1 σ": f"{4 / 12:.0%}",
        "2 σ": f"{7 / 12:.0%}",
        "95 % ellipse": f"{6 / 12:.0%}",
        "Brier": f"{(10 * 0.1**2 + 3 * 0.9**2) / 13:.2f}",
        "wrong with confidence": f"{1 / 13:.0%}",
    }
    assert times == {
        ("fit",): {"median": "5.0", "p95": "5.0"},
        ("total",): {"median": "17.5", "p95": "20.2"},
        ("total, CPU of all threads",): {"median": "30.0", "p95": "30.0"},
    }
    assert list(worst) == [(f"set/{error}",) for error in range(11, 11 - WORST, -1)]
    assert worst["set/11",] == {
        "caster": "box",
        "error": "11.0°",
        "σ": "3.0°",
        "confidence": "0.90",
        "from true labels": "5.5°",
        "IoU object": "0.90",
        "IoU shadow": "0.80",
    }
    assert [line.split(" x ") for line in console.lines] == [["   2", "no shadow"], ["   1", "dark"]]
