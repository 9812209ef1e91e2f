"""Cases drawn at random: command lines with which the program mostly comes far before it notices."""

from itertools import pairwise
from typing import Any

from hypothesis import strategies as st

from tests.fuzz.command_lines.case import HOME, INNER, WORK, Case
from tests.fuzz.command_lines.names import FLOATS, INTEGERS, LARGE, MARKERS, SEQUENCE, SIZES, free_names, hostile_names
from tests.fuzz.command_lines.surroundings import (
    OUTPUTS,
    always_there,
    environments,
    permissions,
    planted_strategy,
    rarely,
    resource_limits,
    signals,
    written,
)

integers = st.sampled_from(INTEGERS + LARGE)
floats = st.sampled_from(FLOATS)
papers = st.sampled_from(("a4", "letter", "a3", "A4", "a0", ""))
casters = st.one_of(
    st.sampled_from(["model.gltf", "model.obj", "cube", "fifo", "zero", "huge.gltf", "clip.mp4", "", ":", "sphere"]),
    st.builds(lambda kind, sizes: f"{kind}:{'x'.join(sizes)}", st.sampled_from(["box", "cylinder", "sphere"]),
              st.lists(floats, max_size=4)),
)  # fmt: skip
frame_counts = st.sampled_from(("1", "2", "3", "3", *INTEGERS[:14]))


class Words:
    """Draws the arguments of one command line, and remembers which of them are to be written."""

    def __init__(self, draw: st.DrawFn, names: tuple[str, ...]) -> None:
        self._draw, self._names = draw, names
        self.words: list[str] = []
        self.outputs: list[str] = []

    def draw(self, strategy: st.SearchStrategy[Any]) -> Any:
        return self._draw(strategy)

    def file(self) -> str:
        """Mostly one that is there."""
        return str(self.draw(rarely(hostile_names, None, 6)) or self.draw(st.sampled_from(self._names)))

    def maybe(self, option: str, value: st.SearchStrategy[str] | None = None, one_in: int = 6) -> None:
        if self.draw(st.integers(1, one_in)) == one_in:
            self.words.append(option)
            if value is not None:
                self.words.append(self.draw(value))

    def written(self, option: str, suffix: str, one_in: int = 2) -> None:
        """Names in the sandbox only: what is written there cannot harm the machine."""
        if self.draw(st.integers(1, one_in)) != one_in:
            return
        plain = [name for name in OUTPUTS if name.lower().endswith(suffix)] or [f"new{suffix}"]
        name = self.draw(
            st.one_of(
                st.sampled_from(plain),
                st.sampled_from(plain),
                free_names.map(lambda name: name + suffix),
                hostile_names.map(lambda name: name + suffix),
                st.sampled_from(
                    [f"missing/x{suffix}", f"clip.mp4/x{suffix}", f"{'a' * 245}{suffix}", "photo.png", "clip.mp4"]
                ),
            ).filter(lambda name: not name.startswith("/") and ".." not in name.split("/"))
        )
        self.words += [f"{option}={name}"] if self.draw(st.booleans()) else [option, name]
        self.outputs.append(name)


def _scene(words: Words) -> None:
    words.maybe("--marker", st.one_of(st.sampled_from(MARKERS), hostile_names))
    words.maybe("--marker-size", floats, 10)
    names = st.one_of(
        st.sampled_from(["odd.json", "huge.json", "fifo", "zero", "photo.png", "settings.toml"]), hostile_names
    )
    words.maybe("--camera-file", names)
    words.maybe("--focal-px", floats, 10)
    words.maybe("--hfov", floats, 8)
    words.maybe("--light", st.sampled_from(["sun", "lamp", "auto", "Sun", ""]), 10)
    words.maybe("--caster", casters, 8)


def _view(words: Words) -> None:
    if words.draw(st.integers(1, 8)) < 8:
        words.words.append("--headless")
    words.words += ["--frames", words.draw(frame_counts), "--quality", "fast"]
    models = st.sampled_from(["cube", "model.gltf", "model.obj", "wordy.gltf", "huge.gltf", "fifo", "zero", "a"])
    words.maybe("--model", st.one_of(models, models.map(lambda name: f"7={name}"), hostile_names), 4)
    words.maybe("--up", st.sampled_from(["z", "-x", "y", "q", ""]), 8)
    words.maybe("--mirror", None, 10)
    words.maybe("--as-shown", st.sampled_from(["shown.json", "odd.json", "fifo", "huge.json", "zero"]), 8)
    words.maybe("--layers", st.sampled_from(["both", "model", "shadow", "all"]), 8)
    words.maybe("--size", st.sampled_from(SIZES), 4)
    words.maybe("--estimate-at", integers, 8)
    words.maybe("--no-filter", None, 8)
    words.maybe("--hide-marker", None, 8)
    if "--hide-marker" not in words.words:
        words.words.append("--no-hide-marker")  # most of what a short run takes
    words.maybe("--loop", None, 8)
    words.written("--out", words.draw(st.sampled_from([".mp4"] * 4 + [".png", ".mov", ".webm"])))
    words.written("--report", ".json", 4)
    words.maybe("--overwrite", None, 4)
    words.maybe("--estimator", st.one_of(st.sampled_from(["proxy", "Proxy", SEQUENCE]), hostile_names), 12)


def _play(words: Words) -> None:
    words.words += ["play", words.file()]
    _scene(words)
    _view(words)


def _demo(words: Words) -> None:
    words.words += words.draw(st.sampled_from([["demo"], []]))
    _view(words)


def _webcam(words: Words) -> None:
    words.words.append("webcam")
    words.maybe("--camera", st.one_of(integers, hostile_names), 1)
    _scene(words)
    _view(words)


def _estimate(words: Words) -> None:
    words.words.append("estimate")
    words.words += [words.file() for _ in range(words.draw(st.integers(1, 3)))]
    words.words += ["--quality", words.draw(st.sampled_from(["fast", "fast", "auto", "nonsense"]))]
    words.maybe("--json", None, 2)
    words.maybe("--repeat", st.sampled_from(["1", "0", "-1", "x", ""]), 8)
    words.maybe("--estimate-at", integers, 8)
    words.maybe("--views", integers, 8)
    words.maybe("--frames", st.sampled_from(["0:3", "2:", ":1", ":", "3:2", "7", "999999:", "-1:4", "x:y", ""]), 8)
    words.maybe("--together", None, 4)
    words.written("--sheet", ".html", 4)
    words.written("--debug", "", 6)
    words.maybe("--overwrite", None, 4)
    _scene(words)


def _marker(words: Words) -> None:
    words.words.append("marker")
    words.written("--out", words.draw(st.sampled_from([".png", ".pdf", ".txt", ""])), 1)
    words.maybe("--marker", st.one_of(st.sampled_from(MARKERS), hostile_names), 2)
    words.maybe("--size-mm", floats, 3)
    words.maybe("--cube", None, 4)
    words.maybe("--side", floats, 6)
    words.maybe("--paper", papers, 6)
    words.maybe("--overwrite", None, 3)


def _board(words: Words) -> None:
    words.words.append("board")
    words.written("--out", words.draw(st.sampled_from([".png", ".pdf", ".txt"])), 1)
    words.maybe("--square-mm", floats, 2)
    words.maybe("--paper", papers, 6)
    words.maybe("--overwrite", None, 3)


def _calibrate(words: Words) -> None:
    words.words += ["calibrate", "--camera", words.file(), "--headless"]
    words.written("--out", ".json", 1)
    words.maybe("--size", st.sampled_from(SIZES))
    words.maybe("--overwrite", None, 3)


def _small(words: Words) -> None:
    words.words += words.draw(
        st.sampled_from(
            [["settings"], ["--help"], ["--version"], ["cameras"], ["cameras", "--fast"], ["doctor"],
             ["play", "--help"], ["bench", "--help"], ["bench"], ["estimate", "--help"], ["nonsense"]]
        )
    )  # fmt: skip
    words.maybe("--nonsense", hostile_names, 10)


def _bench(words: Words) -> None:
    """Only such as cannot begin: those that do take minutes."""
    what = words.draw(st.sampled_from(["light", "viewer"]))
    words.words += ["bench", what]
    if what == "track":
        words.words += ["--quick", "--real", words.draw(st.sampled_from(["nowhere", "clip.mp4", "\udcff", "fifo"]))]
    elif what == "light":
        words.words += ["--quick", "--scenes", words.draw(st.one_of(st.sampled_from([".", "clip.mp4"]), hostile_names))]
    else:
        words.words += ["--frames", words.draw(st.sampled_from(["0", "-1", "x", ""]))]
    words.written("--out", "", 3)


def outputs_in(words: list[str]) -> list[str]:
    """What a command line of arbitrary words asks to be written: without a command, that of the demo."""
    named = [after for word, after in pairwise(words) if word == "--out"]
    return named[-1:]


def _anything(words: Words) -> None:
    words.words += words.draw(st.lists(st.one_of(hostile_names, st.sampled_from(["play", "--out", "-h"])), max_size=4))
    # The demo would play all of its clip.
    words.words = [word for word in words.words if word not in ("demo", "webcam", "start")] or ["--help"]
    words.outputs = outputs_in(words.words)


COMMANDS = (_play, _play, _play, _estimate, _estimate, _estimate, _marker, _board, _calibrate, _calibrate, _demo,
            _webcam, _webcam, _small, _small, _small, _bench, _anything, _anything)  # fmt: skip


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
