"""A parser that says in one line what is wrong with a command line, and what may have been meant."""

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from typing import NoReturn

from ashe_live import __version__
from ashe_live.commands.flags import values
from ashe_live.errors import ExitStatus
from ashe_live.process.messages import print_exactly, print_message

# The same as in ashe_live.models.loading, whose imports --help must not wait for.
MODEL_SUFFIXES = (".glb", ".gltf", ".obj", ".ply", ".stl")
NEAR = 0.75  # likeness, from 0 to 1, of a word that may have been meant: one letter of six is wrong


class ShowVersion(argparse.Action):
    """As argparse's own action, which says nothing if the text cannot be written."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        print_exactly(f"ashe-live {__version__}")
        parser.exit()


class CommandParser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage that hides it."""

    _given: Sequence[str] = ()  # the words that are parsed

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        self._given = given = sys.argv[1:] if args is None else list(args)
        options, left = super().parse_known_args(given, namespace)
        # Behind "--" no word is a flag, whatever it begins with.
        flags = [word for word in left if word.startswith("-") and word in given[: _place(given, "--")]]
        if "files" in options and not flags:
            # Argparse takes those that stand together, and leaves what comes after the next flag.
            files = [word for index, word in enumerate(left) if index != _place(left, "--")]
            try:
                options.files = [*options.files, *map(values.path, files)]
            except argparse.ArgumentTypeError as error:
                self.error(f"argument FILE: {error}")
        elif left:  # here, where it is known of which command
            names = (word.partition("=")[0] for word in flags if word.startswith("--"))
            near = next((self._near(name, self._option_string_actions) for name in names), self._flag_for(left[0]))
            if "file" in options and not near and not any(word.startswith("-") for word in left):
                self.error(f"one FILE is shown, and {1 + len(left)} are given: ashe-live estimate takes several")
            self.error(f"unrecognized arguments: {' '.join(left)}{near}")
        return options, []

    def _get_values(self, action: argparse.Action, arg_strings: list[str]) -> object:
        # Argparse takes "--" for no value at all, and hands over an empty list in its place.
        if action.option_strings and arg_strings == ["--"]:
            raise argparse.ArgumentError(action, "'--' is no value")
        return super()._get_values(action, arg_strings)

    def _check_value(self, action: argparse.Action, value: object) -> None:
        near = "" if action.choices is None else self._near(str(value), map(str, action.choices))
        if near and value not in (action.choices or ()):
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}{near}")
        if action.metavar == "COMMAND" and {".", "/", "\\"} & set(str(value)):  # as in no command's name
            said = f"{value!r} is not one, but looks like a file: ashe-live {_shown_by(str(value))} shows it"
            raise argparse.ArgumentError(action, said)
        super()._check_value(action, value)

    def _flag_for(self, word: str) -> str:
        """A question for the flag that a camera's number or a model's file belongs to; empty for any other word."""
        flag = "--camera" if word.isdecimal() else "--model" if word.lower().endswith(MODEL_SUFFIXES) else None
        return f": did you mean {flag} {word}?" if flag in self._option_string_actions else ""

    @staticmethod
    def _near(word: str, words: Iterable[str]) -> str:
        """A question for the word that may have been meant; empty where none is like it."""
        import difflib  # here, as most commands need it never

        # Without the dashes, which make short flags look alike.
        named = {each.lstrip("-"): each for each in words}
        near = difflib.get_close_matches(word.lstrip("-"), list(named), 1, NEAR)
        return f": did you mean {named[near[0]]}?" if near else ""

    def error(self, message: str) -> NoReturn:
        print_message(f"{message}{self._file_that_begins_as_a_flag()} (see {self.prog} --help)")
        self.exit(ExitStatus.WRONG_USE)

    def _file_that_begins_as_a_flag(self) -> str:
        """What is to be written for a file such as `-1.jpg`, where one of the words names it; empty where none does."""
        flags = (word for word in self._given[: _place(self._given, "--")] if word.startswith("-"))
        unknown = (word for word in flags if word.partition("=")[0] not in self._option_string_actions)
        file = next((word for word in unknown if os.path.isfile(word)), None)  # noqa: PTH113 - never raises an error
        return "" if file is None else f": for the file {file} give .{os.sep}{file}"

    def print_help(self, _file: object = None) -> None:
        # Argparse's own method says nothing if the text cannot be written.
        print_exactly(self.format_help().rstrip("\n"))


def _shown_by(file: str) -> str:
    """The command that shows a file of that name."""
    return "demo --model FILE" if file.lower().endswith(MODEL_SUFFIXES) else "play FILE"


def _place(words: Sequence[str], word: str) -> int:
    """Where the first such word is, or else the end."""
    return next((index for index, each in enumerate(words) if each == word), len(words))
