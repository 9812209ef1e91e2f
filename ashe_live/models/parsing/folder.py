"""What a model file may read beside itself: files of its own folder, small enough together, never a network."""

import contextlib
import itertools
import os
import re
import unicodedata
from pathlib import Path, PurePosixPath, PureWindowsPath
from urllib.parse import unquote

from ashe_live.errors import UserError
from ashe_live.files.reading import read_bytes
from ashe_live.models.parsing.limits import MAX_NAMED_FILES

SCHEME = re.compile(r"[a-z][a-z0-9+.-]+:", re.IGNORECASE)  # of an address; one letter is a drive of Windows
MOST_ENTRIES = 10_000  # of a folder that are looked at for a name that is written otherwise


class MissingFileError(UserError):
    """A file is not in the folder; whether it is elsewhere is not looked at."""


class Folder:
    """Lets a model file read what lies in its own folder.

    Names are taken as other systems write them: with backslashes, with other capitals, with accents apart from their
    letters, in other encodings, percent-encoded. Of a path that leads elsewhere (absolute, `../textures/a.png`) the end
    is looked for within the folder: exporters write where a picture lay on the machine of its maker, and people copy it
    beside the model.
    """

    def __init__(self, model: Path, most_bytes: int) -> None:
        self.model = model
        self._folder = model.parent.resolve()
        self._bytes_left = most_bytes
        self._named = 0
        self._names: dict[Path, dict[str, str]] = {}
        self.read: dict[Path, None] = {}  # the files that have been read, in order

    def get(self, name: str) -> bytes:
        """The content of the file of that name. Raises MissingFileError where there is none, UserError where it cannot
        be read.
        """
        self._named += 1
        if self._named > MAX_NAMED_FILES:
            raise UserError(
                f"the model file {self.model} names files more than {MAX_NAMED_FILES:,} times", "export it with fewer"
            )
        path = self._found(name)
        try:
            content = read_bytes(path, self._bytes_left)
        except UserError as refusal:
            raise UserError(
                f"the model file {self.model} needs a file beside it: {refusal.message}", refusal.remedy
            ) from None
        self._bytes_left -= len(content)
        self.read[path] = None
        return content

    def _found(self, name: str) -> Path:
        relative = unquote(name.strip()).replace("\\", "/")
        # Before it is looked at: on Windows that of another machine would be asked for.
        is_elsewhere = bool(PureWindowsPath(relative).anchor) or "\0" in relative or not self._is_within(relative)
        if not is_elsewhere:
            # A downloaded file may have %20 in its name, and formats other than glTF have no such codes.
            for spelled in (relative, name.strip().replace("\\", "/")):
                if (path := self._named_like(spelled)) is not None and not path.is_dir():
                    return path
        elif "\0" not in relative and not SCHEME.match(relative):
            parts = PurePosixPath(relative).parts
            for first in range(max(1, len(parts) - 3), len(parts)):
                if (path := self._named_like("/".join(parts[first:]))) is not None and path.is_file():
                    return path
        if SCHEME.match(relative):
            raise MissingFileError(
                f"the model file {self.model} names {name}, and only data in it and files beside it are read",
                "export it as GLB, or put the file beside it and name that",
            )
        why = "outside its own folder" if is_elsewhere else "which is missing"
        raise MissingFileError(f"the model file {self.model} names {name}, {why}", "put what it needs beside it")

    def _is_within(self, relative: str) -> bool:
        return Path(os.path.realpath(self._folder / relative)).is_relative_to(self._folder)

    def _named_like(self, relative: str) -> Path | None:
        """Within the folder, also if `_folded` alike alone; None when there is nothing, or a link leads elsewhere."""
        path = self._folder
        for part in PurePosixPath(relative).parts:
            inside = path / part
            if not os.path.lexists(inside):
                alike = self._names_in(path).get(_folded(part))
                if alike is None:
                    return None
                inside = path / alike
            path = inside
        real = Path(os.path.realpath(path))
        return real if real.is_relative_to(self._folder) else None

    def _names_in(self, folder: Path) -> dict[str, str]:
        """Of those that are `_folded` alike the first by alphabet. A folder is looked through once."""
        if folder not in self._names:
            names: list[str] = []
            with contextlib.suppress(OSError), os.scandir(folder) as entries:
                names = sorted(entry.name for entry in itertools.islice(entries, MOST_ENTRIES))
            self._names[folder] = {_folded(name): name for name in reversed(names)}
        return self._names[folder]


def _folded(name: str) -> str:
    """Equal for names that look alike: Unicode's canonical caseless matching (section 3.13, D145).

    Macs part accents from letters in names of files, and archives keep that. Bytes that are no UTF-8 are taken for
    Latin-1, as they are in the text of models.
    """
    try:
        text = os.fsencode(name).decode()
    except UnicodeDecodeError:
        text = os.fsencode(name).decode("latin-1")
    except UnicodeEncodeError:  # a half of a pair, as JSON may have it
        text = name
    return unicodedata.normalize("NFD", unicodedata.normalize("NFD", text).casefold())
