"""One attack on the command line, as a value: what lies around, how the program is started, what happens meanwhile."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

# The folders of a sandbox (sandbox.py); paths of a case start with one of them.
WORK, HOME, OUTSIDE, TEMPORARY = "work", "home", "outside", "tmp"
INNER = f"{WORK}/a"

Start = Literal["forked", "script", "module"]
Stream = Literal["file", "closed", "full", "broken pipe", "terminal", "null"]
Kind = Literal["material", "holes", "text", "link", "fifo", "folder", "node", "sparse", "code"]


@dataclass(frozen=True)
class Planted:
    """Something that lies there before the program starts, and that it must leave as it is."""

    path: str  # from the sandbox's folder on; file names with bytes that are no UTF-8 as Python has them (PEP 383)
    kind: Kind = "text"
    # The text; the link's target; which material (materials.py), alone or with gigabytes of holes behind it; a sparse
    # file's length; a node's minor number (3: null, 5: zero). Code needs none: it says that it ran.
    content: str = ""
    is_old: bool = False  # last written to in 1970


@dataclass(frozen=True)
class Case:
    """`{port}` and `{base}` in arguments, paths, contents and environment: the listener's port, the sandbox."""

    arguments: tuple[str, ...]
    planted: tuple[Planted, ...] = ()
    outputs: tuple[str, ...] = ()  # paths that the arguments name to be written, from the working folder on
    environment: Mapping[str, str | None] = field(default_factory=dict)  # None: not there
    modes: Mapping[str, int] = field(default_factory=dict)  # permissions, set when all is planted
    folder: str = WORK  # where it is started; "deleted": one that is gone by then
    stdin: Stream = "null"
    stdout: Stream = "file"
    stderr: Stream = "file"
    limits: Mapping[str, int] = field(default_factory=dict)  # of module resource, e.g. {"RLIMIT_FSIZE": 4096}
    start: Start = "forked"
    second_after_ms: int | None = None  # the same command once more, so much later
    # Milliseconds after the start, the signal's number, whether to the whole process group as a terminal does.
    signals: tuple[tuple[int, int, bool], ...] = ()

    @property
    def overwrites(self) -> bool:
        return "--overwrite" in self.arguments

    @property
    def is_repeatable(self) -> bool:
        """Whether the same happens again, whatever else the machine does."""
        return not self.signals and self.second_after_ms is None

    def to_json(self) -> str:
        """Without what is as by default, so that what matters can be read."""
        standard = asdict(Case(()))
        return json.dumps({key: value for key, value in asdict(self).items() if value != standard[key]}, indent=1)


def case_from(described: Mapping[str, Any]) -> Case:
    """What `Case.to_json` wrote; keys that start with `_` are for the reader."""
    values = {key: value for key, value in described.items() if not key.startswith("_")}
    values["planted"] = tuple(Planted(**planted) for planted in values.get("planted", ()))
    values["signals"] = tuple((int(at), int(number), bool(group)) for at, number, group in values.get("signals", ()))
    return Case(**{key: tuple(value) if isinstance(value, list) else value for key, value in values.items()})


def read_cases(folder: Path) -> dict[str, Case]:
    """The kept cases by their files' names."""
    return {
        path.stem: case_from(json.loads(path.read_text(encoding="utf-8"))) for path in sorted(folder.glob("*.json"))
    }
