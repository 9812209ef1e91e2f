"""Why a camera cannot be used, as far as the system tells, and what to do about it."""

import os
import stat
import sys
from contextlib import suppress
from pathlib import Path

from ashe_live.errors import UserError

VIDEO_MAJOR = 81  # of all video devices: linux/videodev2.h


def check_is_device(path: str) -> None:
    """Raises UserError unless `path` can be a camera: OpenCV takes other files for clips, and some names crash it."""
    try:
        path.encode("utf-8")
        is_device = not sys.platform.startswith("linux") or _is_video_device(Path(path).stat())
    except (OSError, ValueError):
        is_device = False
    if not is_device and not os.path.lexists(path):
        raise camera_error(path)
    if not is_device:
        remedy = "name a number or a device such as /dev/video0 with --camera; a clip is played by ashe-live play FILE"
        raise UserError(f"{path} is not a camera", remedy)


def camera_error(camera: int | str, devices: Path = Path("/dev")) -> UserError:
    """Why `camera` could not be used, as far as the system tells, and the remedy. `devices` is where Linux has them."""
    if not sys.platform.startswith("linux"):
        return UserError(
            f"camera {camera} cannot be used",
            "connect it, close other programs that use it, and allow camera access in the system's privacy settings",
        )
    device = devices / f"video{camera}" if isinstance(camera, int) else Path(camera)
    if not device.exists():
        others = ", ".join(str(path) for path in sorted(devices.glob("video*")))
        remedy = (
            f"choose one of {others} with --camera" if others else "connect one, or play a clip: ashe-live play FILE"
        )
        return UserError(f"there is no camera {device}", remedy)
    if not os.access(device, os.R_OK | os.W_OK):
        return UserError(
            f"no permission to use {device}",
            "add yourself to the group video (sudo usermod -aG video $USER) and log in again",
        )
    users = ", ".join(sorted(programs_using(device)))
    if users:
        return UserError(f"{device} is busy: it is used by {users}", "close what uses it")
    return UserError(
        f"{device} gives no pictures",
        "close other programs that use it; a camera can have several devices, so try the next number too",
    )


def _is_video_device(state: os.stat_result) -> bool:
    return stat.S_ISCHR(state.st_mode) and os.major(state.st_rdev) == VIDEO_MAJOR


def programs_using(device: Path) -> set[str]:
    """Names of this user's other processes that have `device` open, where the system tells as Linux does."""
    names = set()
    for opened in Path("/proc").glob("[0-9]*/fd/*"):
        # Processes end meanwhile, and those of others are not told.
        with suppress(OSError):
            process = opened.parents[1]
            if opened.readlink() == device.resolve() and int(process.name) != os.getpid():
                names.add((process / "comm").read_text(encoding="utf-8", errors="replace").strip())
    return names
