"""The ways of a call through the estimator's rooms are as short as docs/contributing.md draws them."""

import ast
import re
from collections.abc import Iterator
from functools import cache

import pytest

from tests.checkout import CHECKOUT

LIGHT = CHECKOUT / "ashe_live" / "light"
MOST_ROOMS = 6

Name = tuple[str, str]  # a module of light, and a function or class at its top level


@cache
def called_by_name() -> dict[Name, set[Name]]:
    """What each function and class of `light` calls or hands on by name; methods of objects are not followed."""
    calls: dict[Name, set[Name]] = {}
    for path in sorted(LIGHT.rglob("*.py")):
        module = ".".join(path.relative_to(LIGHT).with_suffix("").parts)
        tree = ast.parse(path.read_text(encoding="utf-8"))
        tops = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
        known = {name: (module, name) for name in tops}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("ashe_live.light."):
                home = (node.module or "").removeprefix("ashe_live.light.")
                known |= {name.asname or name.name: (home, name.name) for name in node.names}
        for name, top in tops.items():
            calls[module, name] = {known[used] for used in names_called(top) if used in known} - {(module, name)}
    return calls


def names_called(top: ast.AST) -> Iterator[str]:
    for node in ast.walk(top):
        if isinstance(node, ast.Call):
            called = node.func
            while isinstance(called, ast.Attribute):
                called = called.value
            for each in (called, *node.args):
                if isinstance(each, ast.Name):
                    yield each.id


def room(name: Name) -> str:
    return name[0].split(".")[0]


def ways_from(name: Name, before: tuple[Name, ...] = ()) -> tuple[str, ...]:
    """The rooms of the way that passes through the most of them."""
    here = (room(name),)
    further = [ways_from(called, (*before, name)) for called in called_by_name().get(name, ()) if called not in before]
    return max((way if way[:1] == here else here + way for way in further), key=len, default=here)


def drawn() -> list[str]:
    text = (CHECKOUT / "docs" / "contributing.md").read_text(encoding="utf-8")
    return re.findall(r"sequenceDiagram\n(.*?)```", text, re.DOTALL)


def test_the_longest_way_of_a_call_is_drawn() -> None:
    longest = ways_from(("estimators.proxy", "ProxyEstimator"))
    assert len(longest) <= MOST_ROOMS
    # There may be several as long; that what is drawn is called is the next test's.
    assert max(len(re.findall(r"participant (\w+)", each)) for each in drawn()) == len(longest)


@pytest.mark.parametrize("diagram", drawn())
def test_what_is_drawn_is_called_and_comes_back(diagram: str) -> None:
    calls = called_by_name()
    arrows = re.findall(r"(\w+)(-?->>)(\w+): (.*)", diagram)
    assert len(arrows) > 3
    for sender, arrow, receiver, text in arrows:
        if arrow == "->>":
            for function in re.findall(r"(\w+)\(", text):
                homes = [name for name in calls if name[1] == function and room(name) == receiver]
                callers = [name for name in calls if room(name) == sender and calls[name] & set(homes)]
                assert callers, f"{sender} does not call {function} of {receiver}"
        elif value := re.match(r"([A-Z]\w+):", text):
            assert any(name[1] == value[1] and room(name) == sender for name in calls), value[1]
