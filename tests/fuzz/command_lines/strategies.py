"""Cases drawn at random: a command line, what lies around, and mostly one or two odd circumstances."""

from hypothesis import strategies as st

from tests.fuzz.command_lines.arguments import COMMANDS, Words
from tests.fuzz.command_lines.case import HOME, INNER, WORK, Case
from tests.fuzz.command_lines.surroundings import (
    always_there,
    environments,
    permissions,
    planted_strategy,
    rarely,
    resource_limits,
    signals,
    written,
)


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """A command line with what lies around, and mostly one or two odd circumstances."""
    planted = always_there + tuple(draw(st.lists(planted_strategy, max_size=4)))
    lying = tuple(each.path.removeprefix(f"{WORK}/") for each in planted if each.path.startswith(f"{WORK}/"))
    words = Words(draw, (*lying, "clip.mp4", "clip.mp4", "clip.mp4", "."))
    draw(st.sampled_from(COMMANDS))(words)
    modes = draw(rarely(permissions, {}, 8))
    has_code = any(each.kind == "code" for each in planted)
    second_after_ms = draw(rarely(st.integers(0, 300), None, 40))
    start = draw(st.sampled_from(["forked"] * 38 + ["script", "module"]))
    return Case(
        tuple(word.replace("\0", "") for word in words.words),
        planted,
        tuple(words.outputs),
        draw(rarely(environments, {}, 4)),
        {} if second_after_ms is not None else modes,
        draw(rarely(st.sampled_from(["deleted", HOME, INNER]), WORK, 15)),
        draw(rarely(st.sampled_from(["closed", "file", "terminal"]), "null", 10)),
        draw(written),
        draw(rarely(written, "file", 4)),
        draw(rarely(resource_limits, {}, 10)),
        # Python itself puts the folder in which -m is given before all others.
        "script" if start == "module" and has_code else start,
        second_after_ms,
        draw(rarely(signals, (), 25)),
    )
