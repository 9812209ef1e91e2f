"""The renderer bench's tables: each figure under its heading."""

import math
from typing import Any

from ashe_live.bench.render.tables import pairs_table, print_render_figures, scene_table
from tests.bench.printed import Printed, printed


def test_scenes_are_listed_by_their_light_with_a_mean() -> None:
    errors = {
        name: {"kind": kind, "shadow_iou": iou, "shadow_de": 1.0, "model_de": 2.0, "ground": 0.05}
        for name, kind, iou in (("a", "lamp", 0.9), ("b", "directional", 0.7), ("c", "lamp", 0.8))
    }
    table = scene_table([{"name": "fast", "scenes": {}}, {"name": "balanced", "scenes": errors}])
    columns = [list(column.cells) for column in table.columns]
    assert columns[0] == ["b", "mean, directional", "a", "c", "mean, lamp"]
    assert columns[1] == ["0.700", "0.700", "0.900", "0.800", "0.850"]
    assert columns[-1][-1] == "5.0 %"


def pair(**others: Any) -> dict[str, Any]:
    figures = {"flip": 0.1, "border_ratio": 1.0, "ground_de": 1.0, "paper_de": 2.0, "model_de": 3.0, "hidden_de": 4.0}
    reliefs = {"relief_ratio": 0.5, "hidden_relief_ratio": 0.6, "seam_px": 1, "forced_choice": 0.75}
    return {"preset": "fast", **figures, **reliefs, **others}


def test_pairs_are_summed_up_over_the_scenes_in_which_each_figure_is_measured() -> None:
    rows = [
        pair(),
        pair(flip=0.4, border_ratio=1.25, ground_de=5.0, relief_ratio=0.75, seam_px=10),
        pair(flip=0.1, border_ratio=9.0, ground_de=math.nan, relief_ratio=math.nan, hidden_de=10.0),
        pair(preset="slow", flip=0.9, forced_choice=0.5),
    ]
    console = Printed()
    console.print(pairs_table(rows))
    (table,) = console.tables
    assert table["fast, 3 scenes",] == {
        "FLIP": "0.200",
        "border": "1.25",
        "dE ground": "3.0",
        "dE paper": "2.0",
        "dE model": "3.0",
        "dE hidden": "6.0",
        "relief, of hidden": "0.62, 0.60",
        "seam px": "12",
        "classified": "75 %",
    }
    assert (table["slow, 1 scenes",]["FLIP"], table["slow, 1 scenes",]["classified"]) == ("0.900", "50 %")


def test_costs_errors_and_memory_stand_under_their_headings() -> None:
    cost = {"p50": 5.0, "p99": 6.0, "gpu_p50": 1.0, "gpu_p99": None}
    record = {
        "loop": [{"size": [640, 480], "decode": 1.0, "track": 2.0, "render": 6.0, "whole": 9.5, "video_drawn": 1.5}],
        "large": {"size": [1920, 1080], "triangles": 100_000, **cost},
        "sweeps": {"lights": [{"value": 4, **cost, "p50": 7.0}]},
        "errors": [
            {
                "series": "presets", "name": "fast", "ms": 3.0, "shadow_iou_mean": 0.9, "shadow_iou_least": 0.8,
                "shadow_de": 1.5, "model_de": 2.5, "scenes": {},
            }
        ],
        "lamps": {"fast": {"sun": 4.0, "lamp": 5.0, "sun_cpu": 8.0, "lamp_cpu": 12.0}},
        "memory": {"frames": 50, "start_mib": 100.0, "end_mib": 101.5, "start_gl_objects": 7, "end_gl_objects": 9},
        "pairs": [],
    }  # fmt: skip
    found = printed(print_render_figures, record)
    loop, costs, lamps, errors, scenes = found.tables
    assert loop["640x480",] == {
        "decode": "1.00",
        "track": "2.00",
        "render": "6.00",
        "whole": "9.50",
        "video drawn": "1.50",
        "render / video": "4.0",
    }
    headings = ("median", "p99", "GPU median", "GPU p99")
    assert costs == {
        ("1920x1080, 100000 triangles",): dict(zip(headings, ("5.00", "6.00", "1.00", "-"), strict=True)),
        ("lights 4",): dict(zip(headings, ("7.00", "6.00", "1.00", "-"), strict=True)),
    }
    assert errors["presets: fast",] == {
        "ms": "3.0",
        "shadow IoU": "0.900",
        "least": "0.800",
        "dE in shadow": "1.5",
        "dE on model": "2.5",
    }
    # Two ratios, of time and of processor time, of which the last is kept under their common heading.
    assert lamps["fast",] == {
        "sun": "4.00",
        "lamp": "5.00",
        "sun, processor": "8.00",
        "lamp, processor": "12.00",
        "ratio": "1.50",
    }
    assert scenes == {}
    assert found.lines == ["50 pictures, a model switch every ten: 100.0 to 101.5 MiB, 7 to 9 OpenGL objects"]
