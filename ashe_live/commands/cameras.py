"""`ashe-live cameras`: which cameras are connected, and what they can do."""

import argparse

from rich.console import Console
from rich.table import Table

from ashe_live.capture.cameras import Mode, connected, modes_of
from ashe_live.errors import ExitStatus, UserError


def run(options: argparse.Namespace) -> int:
    devices = connected()
    if not devices:
        raise UserError("there is no camera", "connect one, or play a clip: ashe-live play FILE")
    table = Table("--camera", "name", *([] if options.fast else ["modes"]))
    for device in devices:
        modes = [] if options.fast else ["\n".join(map(_mode_line, modes_of(device.number))) or "in use, or forbidden"]
        table.add_row(str(device.number), device.name, *modes)
    Console(highlight=False).print(table)
    return ExitStatus.ANSWERED


def _mode_line(mode: Mode) -> str:
    rate = f"   {mode.fps:.0f} fps" if mode.fps > 0 else ""
    return f"{mode.size[0]}x{mode.size[1]}{rate}   {mode.codec}".rstrip()
