"""`ashe-live settings`: where the settings are, and the values in force; the output is itself a settings file."""

import argparse
import json
import os
from pathlib import Path

from ashe_live.commands.flags.option_groups import DEFAULT_MARKER
from ashe_live.commands.flags.options import parsed
from ashe_live.commands.flags.settings_file import SETTINGS, read_settings, settings_path
from ashe_live.errors import ExitStatus
from ashe_live.files.kept import NOWHERE
from ashe_live.process.messages import print_answer, print_exactly

NOTE_AT = 36
# What holds where a file that named it would change it.
UNSET = {"marker": f"the one in view, or {DEFAULT_MARKER}", "camera": "0, or without a command the first one"}


def run(_options: argparse.Namespace) -> int:
    path = settings_path()
    settings = read_settings(path)
    # This command has all the flags that settings stand for.
    effective = vars(parsed(["webcam"]))
    (effective["model"],) = effective["model"]  # the flag may be repeated, a setting names one model
    effective.update(dict.fromkeys(UNSET.keys() - settings.keys()))
    print_answer(f"# {path}{_where_it_is(path)}")
    for key in SETTINGS:
        value = effective[key.replace("-", "_")]
        line = f"# {key} =" if value is None else f"{key} = {_toml(value)}"
        note = "set here" if key in settings else UNSET.get(key, "not set") if value is None else "default"
        print_exactly(f"{line:<{NOTE_AT}} # {note}")
    return ExitStatus.ANSWERED


def _where_it_is(path: Path) -> str:
    """What is to be said of a file that is not read."""
    if path.parent == NOWHERE:
        return " (HOME or XDG_CONFIG_HOME names no folder: set it to one)"
    try:
        os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        return " (not there: ashe-live settings > FILE is a start)"
    except OSError as error:
        return f" (not read: {error.strerror})"
    return ""


def _toml(value: str | Path | float | tuple[int, int]) -> str:
    """A size is written as its flag takes it; JSON's strings are TOML's."""
    if isinstance(value, tuple):
        value = f"{value[0]}x{value[1]}"
    if isinstance(value, float):
        return repr(value)
    text = json.dumps(str(value), ensure_ascii=False)
    return "".join(letter if letter.isprintable() else f"\\U{ord(letter):08x}" for letter in text)
