"""`ashe-live cameras`: which cameras are connected, and what they can do."""

import argparse

from rich.table import Table

from ashe_live.capture.cameras import Mode, connected, modes_of
from ashe_live.errors import ExitStatus, UserError
from ashe_live.process.console import TerminalConsole
from ashe_live.process.messages import printable


def run(options: argparse.Namespace) -> int:
    devices = connected()
    if not devices:
        raise UserError("there is no camera", "connect one, or play a clip: ashe-live play FILE")
    table = Table("--camera", "name", *([] if options.fast else ["modes"]))
    for device in devices:
        modes = [] if options.fast else ["\n".join(map(_mode_line, modes_of(device.number))) or "in use, or forbidden"]
        table.add_row(str(device.number), printable(device.name), *modes)
    TerminalConsole().print(table)
    return ExitStatus.ANSWERED


def _mode_line(mode: Mode) -> str:
    rate = f"   {mode.fps:.0f} fps" if mode.fps > 0 else ""
    return f"{mode.size[0]}x{mode.size[1]}{rate}   {mode.codec}".rstrip()
