"""What is kept between runs, in the user's configuration folder."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import platformdirs

from ashe_live.errors import UserError
from ashe_live.files.reading import read_json
from ashe_live.files.writing import write_json

# Where nothing is found and nothing can be written.
NOWHERE = Path("/dev/null/ashe-live")


def configuration_file(name: str) -> Path:
    """The path at which a file of that name is kept, whether it exists or not; in NOWHERE for a user without a home.

    Services and containers run as such users, with no HOME. A relative folder, as of `HOME=.`, would be anybody's.
    """
    try:
        folder = platformdirs.user_config_path("ashe-live", appauthor=False)
    except RuntimeError:  # of some versions of platformdirs; others name a folder called "~"
        folder = NOWHERE
    return (folder if folder.is_absolute() else NOWHERE) / name


class KeptObject:
    """A JSON object in a file. A file that cannot be read or written counts as missing."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> dict[str, Any]:
        try:
            content = read_json(self._path)
        except UserError:
            return {}
        return content if isinstance(content, dict) else {}

    def write(self, content: Mapping[str, Any]) -> None:
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_json(self._path, content, overwrite=True)
        except (OSError, UserError):
            return
