"""The options of a command: from its flags, else from the settings, else the defaults."""

import argparse
import re
from collections.abc import Sequence
from typing import NoReturn

from ashe_live.commands.flags.command_parser import CommandParser
from ashe_live.commands.flags.option_groups import DEFAULT_MODELS, UPS
from ashe_live.commands.flags.parser import build_parser, build_start_parser
from ashe_live.errors import UserError


def has_command(arguments: Sequence[str]) -> bool:
    """Whether the arguments name a command, or ask for help or the version."""
    return bool(arguments) and (not arguments[0].startswith("-") or arguments[0] in ("-h", "--help", "--version"))


def parsed(arguments: Sequence[str]) -> argparse.Namespace:
    """The options, with the settings where no flag says otherwise. Raises UserError for impossible settings."""
    arguments = _with_axes_joined(arguments)
    build, named = (build_parser, 1) if has_command(arguments) else (build_start_parser, 0)
    options = build().parse_args(arguments)
    # Imported here, as --help and wrong use end before this.
    from ashe_live.commands.flags.settings_file import COMMANDS, ONE_OF, flags_of, read_settings, settings_path

    if options.command not in COMMANDS:
        return options
    settings = read_settings(settings_path())
    if any(getattr(options, key.replace("-", "_")) is not None for key in ONE_OF):
        settings = {key: value for key, value in settings.items() if key not in ONE_OF}
    if getattr(options, "model", DEFAULT_MODELS) is not DEFAULT_MODELS:  # the setting would add another model
        settings.pop("model", None)
    flags = flags_of(settings, options.command)
    combined = build(_SettingsParser).parse_args([*arguments[:named], *flags, *arguments[named:]])
    combined.from_settings = settings
    return combined


def _with_axes_joined(arguments: Sequence[str]) -> Sequence[str]:
    """Joins `--up -z` into one word, as argparse would take the axis for a flag."""
    joined: list[str] = []
    for word in arguments:
        if joined and joined[-1] == "--up" and word in UPS:
            joined[-1] = f"--up={word}"
        else:
            joined.append(word)
    return joined


def with_origin(error: UserError, options: argparse.Namespace | None) -> UserError:
    """The error, with the settings file named where a value in it is what cannot be used. options: as `parsed`."""
    from ashe_live.commands.flags.settings_file import settings_path

    for key, value in getattr(options, "from_settings", {}).items():
        given = getattr(options, key.replace("-", "_"), ())
        holds = str(value) in map(str, given if isinstance(given, tuple) else (given,))  # no flag has replaced it
        # As a word of it, as a number may be a digit in another; of a camera's number, Linux names the device.
        if holds and re.search(rf"(?<!\w)(/dev/video)?{re.escape(str(value))}(?!\w)", error.message):
            return UserError(error.message, f"{error.remedy} (`{key}` is set in {settings_path()})")
    return error


class _SettingsParser(CommandParser):
    """A parser whose errors say that the fault is in the settings, not on the command line."""

    def error(self, message: str) -> NoReturn:
        from ashe_live.commands.flags.settings_file import settings_path

        raise UserError(f"{settings_path()}: {message.removeprefix('argument --')}", "mend that line, or remove it")
