"""The flags that a command was given, to be given again."""

import argparse

from ashe_live.commands.flags.parser import build_parser

# Of how a clip is looked at; which models there are, and what becomes of the pictures, is told anew.
KEPT = (
    "--marker-size",
    "--caster",
    "--camera-file",
    "--focal-px",
    "--hfov",
    "--up",
    "--estimate-at",
    "--quality",
    "--estimator",
    "--light",
)


def flags_given(options: argparse.Namespace) -> list[str]:
    """Those that `play` has as well and that are not as they come; no quality where the window chooses it."""
    as_they_come = build_parser().parse_args(["play", "clip.mp4"])
    flags: list[str] = []
    for flag in KEPT:
        name = flag.removeprefix("--").replace("-", "_")
        value = getattr(options, name, None)
        if value is not None and value != getattr(as_they_come, name) and value != "auto":
            flags.append(f"{flag}={value}")
    return [*flags, *(["--no-filter"] if getattr(options, "no_filter", False) else [])]
