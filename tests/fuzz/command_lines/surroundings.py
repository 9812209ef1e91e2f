"""What lies around and holds when a command is given: files, folders, environment, streams, limits, signals."""

from typing import Any

from hypothesis import strategies as st

from tests.fuzz.command_lines.case import HOME, INNER, OUTSIDE, TEMPORARY, WORK, Kind, Planted
from tests.fuzz.command_lines.names import ADDRESSES, PROTOCOLS, SEQUENCE, hostile_names
from tests.fuzz.materials import ODD_CLIPS, ODD_PHOTOS

CLIPS = ("clip.mp4", "blank.mp4", "jumps-back.ts", "grows.mkv", "cut.mp4", *ODD_CLIPS)
PHOTOS = ("photo.png", "photo.jpg", "blank.png", "dot.png", *ODD_PHOTOS)
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
FOLDER = f"{HOME}/.config/ashe-live"
CONFIG = f"{FOLDER}/settings.toml"
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
# What is kept in the folder of the settings: damaged, an older version's, somebody else's.
KEPT = ("models.json", "focal_lengths.json")
KEPT_TEXTS = (
    '{"cube": {"up": 3, "places": {"0": {"scale": 1e308, "turn_deg": 1e308, "shift_sides": [1e308, 0]}}}}',
    '{"cube": {"places": {"0": {"scale": 2, "turn_deg": 30, "shift_sides": [1e6, -1e6]}}}}',
    '{"cube": null, "0, 64x48": {"focal_px": -1, "sigma_px": 0, "views": 1e9}}',
    "[" * 100_000,
    "{",
    "",
    "\udcff",
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
        _lying("photo.png.part", "holes", "photo.png"),
        _lying("photo.jpg", "holes", "photo.jpg"),
        _lying("clip.ts", "holes", "jumps-back.ts"),
        _lying("grows.mkv", "holes", "grows.mkv"),
        _lying("moving.gif", "holes", "moving.gif"),
        _lying("cut.mp4", "holes", "cut.mp4"),
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
damaged_memories = st.builds(
    lambda name, what: Planted(f"{FOLDER}/{name}", *what),
    st.sampled_from(KEPT),
    st.one_of(
        st.sampled_from(KEPT_TEXTS).map(lambda text: ("text", text)),
        st.sampled_from(
            [
                ("fifo", ""),
                ("folder", ""),
                ("node", "5"),
                ("sparse", str(10 << 30)),
                ("link", f"{{base}}/{OUTSIDE}/thesis.txt"),
            ]
        ),
    ),
)
odd_cameras = st.one_of(
    st.sampled_from(CAMERAS).map(lambda text: _lying("odd.json", "text", text)),
    st.sampled_from(LONG).map(lambda name: _lying("odd.json", "material", name)),
)
planted_strategy = st.one_of(
    _of_material(CLIPS),
    _of_material(PHOTOS),
    _of_material(MODELS),
    st.just(_lying("shown.json", "material", "shown.json")),
    others_partials,
    existing_outputs,
    odd_places,
    foreign_code,
    damaged_settings,
    damaged_memories,
    odd_cameras,
    st.builds(lambda name: _lying(name, "text", "x"), st.sampled_from(ADDRESSES + PROTOCOLS)),
)
always_there = (_lying("clip.mp4", "material", "clip.mp4"), _lying("photo.png", "material", "photo.png"))

environments = st.fixed_dictionaries(
    {},
    optional={
        "HOME": st.sampled_from([None, "{base}/missing", f"{{base}}/{OUTSIDE}/thesis.txt", "", "relative", "/\udcff"]),
        "XDG_CONFIG_HOME": st.sampled_from(["", "{base}/missing", f"{{base}}/{OUTSIDE}/thesis.txt", "x\ny", "{base}"]),
        "LANG": st.sampled_from([None, "C", "de_DE.ISO-8859-1", "tr_TR.UTF-8", "nonsense", "\udcff"]),
        "PYTHONIOENCODING": st.sampled_from(["ascii", "ascii:strict", "latin-1", "utf-16"]),
        "PATH": st.sampled_from(["", ".", ":/usr/bin:/bin", "/nowhere"]),
        "TMPDIR": st.sampled_from(["{base}/missing", "", f"{{base}}/{OUTSIDE}/thesis.txt"]),
        "TZ": st.sampled_from(["", "Nonsense/Zone", ":/dev/zero", "UTC-14", "\udcff"]),
        "PYTHONWARNINGS": st.just("error"),
        "PYTHONOPTIMIZE": st.just("2"),
        "COLUMNS": st.sampled_from(["1", "0", "-5", "99999999", "x"]),
        "TERM": st.sampled_from(["dumb", "xterm-256color", "", "\x1b"]),
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
