"""The settings: a TOML file in the platform's configuration folder, for flags that one does not want to repeat.

A setting acts as the long flag of the same name, given before all others, so that flags win (docs/settings.md).
"""

import difflib
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ashe_live.errors import UserError
from ashe_live.files.kept import configuration_file
from ashe_live.files.reading import parsers_words, read_text
from ashe_live.process.messages import listed

Value = str | int | float

TEXT, NUMBER, EITHER = "text in quotes", "a number", "a number, or text in quotes"
KINDS: Mapping[str, tuple[type, ...]] = {TEXT: (str,), NUMBER: (int, float), EITHER: (int, str)}
# With the flags of option_groups.add_scene_options and add_view_options.
SCENE_COMMANDS = ("start", "webcam", "play", "estimate")
VIEW_COMMANDS = ("start", "demo", "webcam", "play")


@dataclass(frozen=True, slots=True)
class Setting:
    """One key of the file."""

    kind: str  # TEXT, NUMBER or EITHER; also the word for it in messages
    commands: tuple[str, ...]  # the commands that have this flag
    example: str  # as it is written in the file


SETTINGS: Mapping[str, Setting] = {
    "camera": Setting(EITHER, ("start", "webcam"), "2"),
    "marker": Setting(TEXT, SCENE_COMMANDS, '"aruco:4x4_50:7"'),
    "marker-size": Setting(NUMBER, SCENE_COMMANDS, "0.1"),
    "camera-file": Setting(TEXT, SCENE_COMMANDS, '"webcam.json"'),
    "focal-px": Setting(NUMBER, SCENE_COMMANDS, "615"),
    "hfov": Setting(NUMBER, SCENE_COMMANDS, "60"),
    "model": Setting(TEXT, VIEW_COMMANDS, '"mug"'),
    "size": Setting(TEXT, VIEW_COMMANDS, '"1280x720"'),
    "quality": Setting(TEXT, ("demo", *SCENE_COMMANDS), '"fast"'),
    "estimator": Setting(TEXT, ("demo", *SCENE_COMMANDS), '"proxy"'),
    "light": Setting(TEXT, ("demo", *SCENE_COMMANDS), '"sun"'),
}
MOST_BITS = 64  # of a whole number: TOML promises no more
# Alternatives of each other: a flag replaces whichever of them the file has.
ONE_OF = ("camera-file", "focal-px", "hfov")
COMMANDS = frozenset(command for setting in SETTINGS.values() for command in setting.commands)


def settings_path() -> Path:
    """Where the file is, or would be."""
    return configuration_file("settings.toml")


def read_settings(path: Path) -> dict[str, Value]:
    """The file's values by key; none when there is no file.

    Raises UserError for a file that cannot be read or is not TOML, a key that is not there, a value of another kind.
    """
    if not os.path.lexists(path):  # also if its folder must not be entered
        return {}
    text = read_text(path)
    try:
        content = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise UserError(
            f"{path} is not TOML ({parsers_words(error)})", 'write lines such as: quality = "fast"'
        ) from None
    for key, value in content.items():
        _check(path, key, value)
    several = [key for key in ONE_OF if key in content]
    if len(several) > 1:
        raise UserError(f"{path} has {listed(several)}", "keep one of them, as they say the same thing")
    if "camera-file" in content:
        # Paths are relative to the settings' folder, not to the current one.
        try:
            content["camera-file"] = str(path.parent / Path(content["camera-file"]).expanduser())
        except RuntimeError as error:  # from "~user" without such a user
            raise UserError(f"{path}: camera-file names nobody's folder ({error})", "write the whole path") from None
    return content


def flags_of(settings: Mapping[str, Value], command: str) -> list[str]:
    """The settings for which `command` has a flag, as flags."""
    return [f"--{key}={value}" for key, value in settings.items() if command in SETTINGS[key].commands]


def _check(path: Path, key: str, value: Any) -> None:
    if key not in SETTINGS:
        near = difflib.get_close_matches(key.replace("_", "-"), SETTINGS, 1)
        remedy = f"did you mean {near[0]}?" if near else f"the settings are {', '.join(SETTINGS)}"
        raise UserError(f"{path}: there is no setting {key!r}", remedy)
    kind = SETTINGS[key].kind
    if isinstance(value, bool) or not isinstance(value, KINDS[kind]):
        raise UserError(f"{path}: {key} is not {kind}", f"write it like this: {key} = {SETTINGS[key].example}")
    if isinstance(value, str) and "\0" in value:
        raise UserError(f"{path}: {key} has a NUL in it", "write it without")
    # Python reads hexadecimal ones of any length, and refuses to write them as a flag has them.
    if isinstance(value, int) and value.bit_length() > MOST_BITS:
        raise UserError(f"{path}: {key} is too large a number", f"write it like this: {key} = {SETTINGS[key].example}")
