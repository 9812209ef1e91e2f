"""The flags of a command that plays the same clip or photo once more, as it is played now."""

import argparse

from ashe_live.commands.flags.parser import build_parser

# The flags that say how a clip is looked at; those for models and outputs are written anew. Which way models stand up
# is among what --as-shown says: by the end, the first one may be another one.
KEPT = (
    *("--marker-size", "--caster", "--camera-file", "--focal-px", "--hfov"),
    *("--estimate-at", "--quality", "--estimator", "--light"),
)


def replay_flags(options: argparse.Namespace) -> list[str]:
    """The flags of `play`, or of `demo` for its own clip, that differ from their defaults.

    The quality is left out if the window chooses it.
    """
    command = ["demo"] if getattr(options, "command", None) == "demo" else ["play", "clip.mp4"]
    as_they_come = vars(build_parser().parse_args(command))
    flags: list[str] = []
    for flag in KEPT:
        name = flag.removeprefix("--").replace("-", "_")
        value = getattr(options, name, None)
        if name in as_they_come and value not in (None, as_they_come[name], "auto"):
            flags.append(f"{flag}={value}")
    return [*flags, *(["--no-filter"] if getattr(options, "no_filter", False) else [])]
