"""The trade of error against time: its front, and its picture."""

import subprocess
import sys
import xml.etree.ElementTree as ET

import PIL.Image
import pytest

from ashe_live.bench.plots import TradePoint, check_can_draw, draw_trade, pareto_front
from ashe_live.errors import UserError

MEASURE = "error"


def point(name, cost, error, is_preset=False):
    return TradePoint(name, "size", cost, {MEASURE: error, "other": 1.0}, is_preset)


def names(points):
    return [point.name for point in points]


def test_the_front_is_what_nothing_beats():
    points = [point("slow", 90, 1), point("beaten", 50, 4), point("middle", 40, 3), point("fast", 10, 8)]
    assert names(pareto_front(points, MEASURE)) == ["fast", "middle", "slow"]
    assert names(pareto_front(points, "other")) == ["fast"]


def test_of_equal_errors_only_the_cheapest_and_of_equal_costs_only_the_best_is_on_the_front():
    points = [point("dear", 20, 2), point("cheap", 10, 2), point("worse", 10, 3)]
    assert names(pareto_front(points, MEASURE)) == ["cheap"]


def test_both_pictures_are_written_and_name_every_setting(tmp_path):
    pytest.importorskip("matplotlib", reason="only needed for plots")
    points = [point("small", 10, 4), point("large", 40, 3), point("balanced", 20, 3.5, is_preset=True)]
    draw_trade(points, "the trade", "ms", "a note", tmp_path / "trade")
    svg = (tmp_path / "trade.svg").read_text()
    texts = {element.text for element in ET.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")}
    assert {"small", "large", "balanced", "the trade", "ms", "a note", MEASURE, "other", "Pareto front"} <= texts
    with PIL.Image.open(tmp_path / "trade.png") as picture:
        assert picture.width > picture.height > 400
    draw_trade(points, "the trade", "ms", "a note", tmp_path / "again")
    assert (tmp_path / "again.svg").read_text() == svg


def test_nothing_cannot_be_drawn(tmp_path):
    with pytest.raises(ValueError, match="nothing"):
        draw_trade([], "", "", "", tmp_path / "trade")


def test_without_matplotlib_it_is_said_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(UserError, match="bench"):
        check_can_draw()


def test_what_lies_in_the_current_folder_has_no_say_in_how_plots_look(tmp_path):
    pytest.importorskip("matplotlib", reason="only needed for plots")
    (tmp_path / "matplotlibrc").write_text("font.size: 99\n")
    code = (
        "from ashe_live.bench.plots import check_can_draw\n"
        "check_can_draw()\n"
        "import matplotlib\n"
        "print(matplotlib.rcParams['font.size'])"
    )
    done = subprocess.run([sys.executable, "-P", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert float(done.stdout) != 99
