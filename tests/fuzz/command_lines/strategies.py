"""Command lines, folders and circumstances drawn at random: mostly such that the program comes far before it notices."""

from typing import Any

from hypothesis import strategies as st

from tests.fuzz.command_lines.case import HOME, INNER, OUTSIDE, TEMPORARY, WORK, Case, Kind, Planted
from tests.fuzz.command_lines.names import (
    ADDRESSES,
    FLOATS,
    INTEGERS,
    LARGE,
    MARKERS,
    PROTOCOLS,
    SEQUENCE,
    SIZES,
    free_names,
    hostile_names,
)

CLIPS = ("clip.mp4", "blank.mp4", "jumps-back.ts", "grows.mkv", "cut.mp4")
PHOTOS = ("photo.png", "photo.jpg", "blank.png", "dot.png")
MODELS = ("model.gltf", "model.obj", "wordy.gltf")
LONG = ("deep", "long", "digits", "name")
OUTPUTS = ("r.mp4", "report.json", "sheet.html", "marker.png", "marker.pdf", "R.MP4", "steps")
# As modules of the standard library and of ours are called.
ENOUGH_FOR_MESSAGES = 4096  # bytes: what is written to stderr is a file, too
CODE = (
    "pickle",
    "signal",
    "selectors",
    "json",
    "numpy",
    "cv2",
    "av",
    "ashe_live",
    "sitecustomize",
    "__main__",
    "random",
)
CONFIG = f"{HOME}/.config/ashe-live/settings.toml"
SETTINGS = (
    'quality = "fast"\n',
    "hfov = 1e300\n",
    "hfov = 55\nfocal-px = 3\n",
    'camera-file = "~nouser/x.json"\n',
    'camera-file = "\\u0000"\n',
    f'model = "{SEQUENCE.encode("unicode_escape").decode().replace(chr(92) + "x1b", chr(92) + "u001b")}"\n',
    "camera = 99999999999999999999999999\n",
    "camera = -1\n",
    "marker-size = nan\n",
    "marker-size = 1e-320\n",
    'size = "16385x1"\n',
    'marker = "grid:4x4_50:9x9"\n',
    'estimator = "nonsense"\n',
    '"\\u001b[31m" = 1\n',
    "a.b.c = 1\n",
    "hfov = 1979-05-27\n",
    "\udcff\udcfe",
    "\ufeffhfov = 55\n",
    "",
)
CAMERAS = (
    '{"size": [64, 48], "K": [[1e300, 0, 3], [0, 1e300, 2], [0, 0, 1]]}',
    '{"size": [1e400, 48], "K": 1}',
    '{"size": [64, 48], "K": [[50, 0, 31], [0, 50, 24], [0, 0, 1]], "dist": [1e300, 1e300]}',
    '{"size": [9223372036854775808, 48], "K": [[5, 0, 3], [0, 5, 2], [0, 0, 1]]}',
    '{"size": [NaN, -Infinity], "K": []}',
    f'{{"{SEQUENCE}": 1}}',
    "null",
    "\udcff",
)


def _lying(path: str, kind: Kind = "text", content: str = "", is_old: bool = False) -> Planted:
    return Planted(f"{WORK}/{path}", kind, content, is_old)


def _of_material(names: tuple[str, ...]) -> st.SearchStrategy[Planted]:
    """Under its own name or under a hostile one."""
    return st.builds(
        lambda material, name: _lying(name or material, "material", material),
        st.sampled_from(names),
        st.one_of(st.none(), st.none(), hostile_names),
    )


def _partial(name: str, what: tuple[Kind, str]) -> Planted:
    return _lying(name, *what, is_old=True)


others_partials = st.builds(
    _partial,
    st.sampled_from(
        [
            ".r.partial.mp4",
            ".r.01234567.partial.mp4",
            ".movie.89abcdef.partial.mp4",
            ".A.89abcdef.partial.MP4",
            ".report.partial.json",
            ".report.01234567.partial.json",
            ".r.finished.mp4",
        ]
    ),
    st.sampled_from(
        [
            ("text", "another program's"),
            ("text", ""),
            ("material", "foreign.mp4"),
            ("link", f"../{OUTSIDE}/thesis.txt"),
            ("link", "nowhere"),
            ("fifo", ""),
            ("folder", ""),
        ]
    ),
)
existing_outputs = st.builds(
    _partial,
    st.sampled_from(OUTPUTS),
    st.sampled_from(
        [
            ("text", "an older one"),
            ("link", f"../{OUTSIDE}/thesis.txt"),
            ("link", "nowhere"),
            ("fifo", ""),
            ("folder", ""),
            ("node", "3"),
        ]
    ),
)
odd_places = st.sampled_from(
    [
        _lying("fifo", "fifo"),
        _lying("fifo.mp4", "fifo"),
        _lying("fifo.png", "fifo"),
        _lying("zero", "node", "5"),
        _lying("zero.mp4", "node", "5"),
        _lying("huge.mp4", "sparse", str(10 << 30)),
        _lying("huge.json", "sparse", str(10 << 30)),
        _lying("huge.gltf", "sparse", str(10 << 30)),
        _lying("loop", "link", "loop"),
        _lying("a/up", "link", ".."),
        _lying("a/round", "link", "../a"),
        _lying("dangling.mp4", "link", "nowhere"),
        _lying("link.mp4", "link", "clip.mp4"),
        _lying("thesis.mp4", "link", f"../{OUTSIDE}/thesis.txt"),
        _lying("empty.mp4"),
        _lying("empty.png"),
        Planted(CONFIG, "fifo"),
        Planted(CONFIG, "folder"),
        Planted(CONFIG, "node", "5"),
        Planted(CONFIG, "sparse", str(10 << 30)),
        Planted(CONFIG, "link", "settings.toml"),
        Planted(f"{HOME}/.config", "text", "a file"),
    ]
)
foreign_code = st.sampled_from([_lying(f"{name}.py", "code") for name in CODE])
damaged_settings = st.one_of(
    st.sampled_from(SETTINGS).map(lambda text: Planted(CONFIG, "text", text)),
    st.sampled_from(LONG).map(lambda name: Planted(CONFIG, "material", name)),
)
odd_cameras = st.one_of(
    st.sampled_from(CAMERAS).map(lambda text: _lying("odd.json", "text", text)),
    st.sampled_from(LONG).map(lambda name: _lying("odd.json", "material", name)),
)
planted_strategy = st.one_of(
    _of_material(CLIPS),
    _of_material(PHOTOS),
    _of_material(MODELS),
    others_partials,
    existing_outputs,
    odd_places,
    foreign_code,
    damaged_settings,
    odd_cameras,
    st.builds(lambda name: _lying(name, "text", "x"), st.sampled_from(ADDRESSES + PROTOCOLS)),
)
always_there = (_lying("clip.mp4", "material", "clip.mp4"), _lying("photo.png", "material", "photo.png"))

environments = st.fixed_dictionaries(
    {},
    optional={
        "HOME": st.sampled_from([None, "{base}/missing", f"{{base}}/{OUTSIDE}/thesis.txt", "", "relative", "/\udcff"]),
        "XDG_CONFIG_HOME": st.sampled_from(["", "{base}/missing", f"{{base}}/{OUTSIDE}/thesis.txt", "x\ny", "{base}"]),
        "LANG": st.sampled_from([None, "C", "de_DE.ISO-8859-1", "nonsense", "\udcff"]),
        "PYTHONIOENCODING": st.sampled_from(["ascii", "ascii:strict", "latin-1", "utf-16"]),
        "TMPDIR": st.sampled_from(["{base}/missing", "", f"{{base}}/{OUTSIDE}/thesis.txt"]),
        "COLUMNS": st.sampled_from(["1", "0", "-5", "99999999", "x"]),
        "TERM": st.sampled_from(["dumb", "xterm-256color", "", "\x1b"]),
        "FORCE_COLOR": st.just("1"),
        "DISPLAY": st.sampled_from([":77", "", "127.0.0.1:{port}", "\udcff"]),
        "WAYLAND_DISPLAY": st.just("nothing-0"),
    },
)
permissions = st.dictionaries(
    st.sampled_from([WORK, HOME, TEMPORARY, f"{WORK}/clip.mp4", INNER]),
    st.sampled_from([0o555, 0o000, 0o311, 0o444]),
    max_size=2,
)
written = st.sampled_from(["file"] * 6 + ["closed", "full", "broken pipe", "terminal"])
resource_limits = st.dictionaries(
    st.sampled_from(["RLIMIT_FSIZE", "RLIMIT_NOFILE"]), st.sampled_from([20, 64, 4096, 20_000]), max_size=2
).map(
    lambda limits: {
        name: max(ENOUGH_FOR_MESSAGES, value) if "FSIZE" in name else value for name, value in limits.items()
    }
)
signals = st.lists(
    st.tuples(st.integers(0, 700), st.sampled_from([1, 2, 15]), st.booleans()), min_size=1, max_size=2
).map(tuple)


def rarely(strategy: st.SearchStrategy[Any], otherwise: Any, one_in: int) -> st.SearchStrategy[Any]:
    """`otherwise` in most cases, so that few things are odd at a time; the simpler one when it is made smaller."""
    return st.integers(1, one_in).flatmap(lambda at: strategy if at == one_in else st.just(otherwise))


integers = st.sampled_from(INTEGERS + LARGE)
floats = st.sampled_from(FLOATS)
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


def _view(words: Words) -> None:
    if words.draw(st.integers(1, 8)) < 8:
        words.words.append("--headless")
    words.words += ["--frames", words.draw(frame_counts), "--quality", "fast"]
    models = st.sampled_from(["cube", "model.gltf", "model.obj", "wordy.gltf", "huge.gltf", "fifo", "zero", "a"])
    words.maybe("--model", st.one_of(models, hostile_names), 4)
    words.maybe("--size", st.sampled_from(SIZES), 4)
    words.maybe("--estimate-at", integers, 8)
    words.maybe("--no-filter", None, 8)
    words.maybe("--loop", None, 8)
    words.written("--out", ".mp4")
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
    words.written("--sheet", ".html", 4)
    words.written("--debug", "", 6)
    words.maybe("--overwrite", None, 4)
    _scene(words)


def _marker(words: Words) -> None:
    words.words.append("marker")
    words.written("--out", words.draw(st.sampled_from([".png", ".pdf", ".txt", ""])), 1)
    words.maybe("--marker", st.one_of(st.sampled_from(MARKERS), hostile_names), 2)
    words.maybe("--size-mm", floats, 3)
    words.maybe("--overwrite", None, 3)


def _board(words: Words) -> None:
    words.words.append("board")
    words.written("--out", words.draw(st.sampled_from([".png", ".pdf", ".txt"])), 1)
    words.maybe("--square-mm", floats, 2)
    words.maybe("--overwrite", None, 3)


def _calibrate(words: Words) -> None:
    words.words += ["calibrate", "--camera", words.file(), "--headless"]
    words.written("--out", ".json", 1)
    words.maybe("--size", st.sampled_from(SIZES))
    words.maybe("--overwrite", None, 3)


def _small(words: Words) -> None:
    words.words += words.draw(
        st.sampled_from(
            [["settings"], ["--help"], ["--version"], ["cameras"], ["cameras", "--fast"], ["doctor"], ["play", "--help"],
             ["bench", "--help"], ["bench"], ["estimate", "--help"], ["nonsense"]]
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


def _anything(words: Words) -> None:
    words.words += words.draw(st.lists(st.one_of(hostile_names, st.sampled_from(["play", "--out", "-h"])), max_size=4))
    # The demo would play all of its clip.
    words.words = [word for word in words.words if word not in ("demo", "webcam", "start")] or ["--help"]


COMMANDS = (_play, _play, _play, _estimate, _estimate, _marker, _board, _calibrate, _demo, _webcam, _small, _small, _bench,
            _anything)  # fmt: skip


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """A command line with what lies around, and mostly one or two odd circumstances."""
    planted = always_there + tuple(draw(st.lists(planted_strategy, max_size=4)))
    lying = tuple(each.path.removeprefix(f"{WORK}/") for each in planted if each.path.startswith(f"{WORK}/"))
    words = Words(draw, (*lying, "clip.mp4", "clip.mp4", "clip.mp4", "."))
    draw(st.sampled_from(COMMANDS))(words)
    modes = draw(rarely(permissions, {}, 8))
    has_code = any(each.kind == "code" for each in planted)
    second_after_ms = draw(rarely(st.integers(0, 300), None, 25))
    start = draw(st.sampled_from(["forked"] * 22 + ["script", "script", "module"]))
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
        draw(rarely(signals, (), 15)),
    )
