"""Recordings that a killed program or a power cut left under their hidden names: given names that can be seen."""

import time
from pathlib import Path

from ashe_live.capture.recorder import salvaged
from ashe_live.core.output_files import partial_name, unused

# A recording in the making is written to every other second.
UNTOUCHED_FOR_S = 60.0


def rescue_recordings(folder: Path, untouched_for_s: float = UNTOUCHED_FOR_S) -> list[Path]:
    """Renames every playable one in `folder` to NAME-cut-short.mp4; what cannot be renamed stays as it is."""
    found = []
    for partial in sorted(folder.glob(partial_name(Path("*.mp4")).name)):
        try:
            is_abandoned = time.time() - partial.stat().st_mtime > untouched_for_s
            if is_abandoned and salvaged(partial):
                found.append(partial.rename(_name_for(partial)))
        except OSError:
            continue
    return found


def _name_for(partial: Path) -> Path:
    stem = partial.name.removeprefix(".").removesuffix(".partial.mp4")
    return unused(partial.with_name(f"{stem}-cut-short.mp4"))
