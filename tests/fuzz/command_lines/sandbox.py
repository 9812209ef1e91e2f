"""The folder a case runs in: what lies there, and whether all of it is as before."""

import hashlib
import os
import shutil
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz.command_lines.case import HOME, INNER, OUTSIDE, TEMPORARY, WORK, Case, Planted

MARK = "ran.txt"  # where foreign code says that it ran
CODE = "import os\nwith open({mark!r}, 'a') as mark:\n    mark.write(__file__ + '\\n')\n"
HASHED_BYTES = 4 << 20
HOLES_BYTES = 20 << 30  # more than a photo may have, and more than can be looked through
THESIS = "the only copy of ten years' work\n"
YEARS_AGO_NS = 86_400 * 10**9


@dataclass(frozen=True, slots=True)
class Entry:
    """What a file is: nothing of it may change."""

    kind: str  # "file", "folder", "link", "other"
    mode: int
    content: str  # hash, or the link's target; of a folder nothing, as what is in it is looked at itself
    inode: int
    modified_ns: int
    byte_count: int = 0


class Sandbox:
    """`base` is the folder; everything in it but the records of the runs is what the program finds."""

    def __init__(self, base: Path, case: Case, materials: Mapping[str, Path], port: int) -> None:
        self.base, self.case, self._materials, self._port = base, case, materials, port
        self.records = base / "records"
        self.records.mkdir(parents=True)
        self.mark = self.records / MARK
        (self.records / "0.stdin").write_text("y\n")
        (self.records / "1.stdin").write_text("y\n")
        for folder in (WORK, HOME, OUTSIDE, TEMPORARY, INNER):
            (base / folder).mkdir()
        self._write(base / OUTSIDE / "thesis.txt", THESIS)
        for planted in case.planted:
            # A name that this file system does not take, or twice the same one: then it is not there.
            try:
                self._plant(planted)
            except (OSError, ValueError):
                continue

    def filled(self, text: str) -> str:
        """With the listener's port and this folder for their placeholders."""
        return text.replace("{port}", str(self._port)).replace("{base}", str(self.base))

    def snapshot(self) -> dict[str, Entry]:
        """Everything that is there, by its path from `base` on."""
        found: dict[str, Entry] = {}
        self._look_into(self.base, "", found)
        return found

    def ran_code(self) -> list[str]:
        return self.mark.read_text(errors="replace").splitlines() if self.mark.exists() else []

    def permit_all(self) -> None:
        """So that the folders can be looked into, and removed."""
        for path in self.case.modes:
            place = self.base / self.filled(path)
            if place.exists() and not place.is_symlink():
                place.chmod(0o700)

    def remove(self) -> None:
        shutil.rmtree(self.base, ignore_errors=True)

    def _plant(self, planted: Planted) -> None:
        path = self.base / self.filled(planted.path)
        if not Path(os.path.normpath(path)).is_relative_to(self.base) or os.path.lexists(path):
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        content = self.filled(planted.content)
        match planted.kind:
            case "material":
                shutil.copyfile(self._materials[content], path)
            case "holes":
                shutil.copyfile(self._materials[content], path)
                os.truncate(path, HOLES_BYTES)
            case "text":
                self._write(path, content)
            case "link":
                path.symlink_to(content)
            case "fifo":
                os.mkfifo(path)
            case "folder":
                path.mkdir()
            case "sparse":
                with path.open("wb") as file:
                    file.truncate(int(content))
            case "code":
                self._write(path, CODE.format(mark=str(self.mark)))
            case "node":
                os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, int(content)))
        if planted.is_old:
            os.utime(path, ns=(YEARS_AGO_NS, YEARS_AGO_NS), follow_symlinks=False)

    @staticmethod
    def _write(path: Path, content: str) -> None:
        path.write_bytes(content.encode("utf-8", "surrogateescape"))

    def _look_into(self, folder: Path, prefix: str, found: dict[str, Entry]) -> None:
        for place in os.scandir(folder):
            name = prefix + place.name
            if name == self.records.name:
                continue
            status = place.stat(follow_symlinks=False)
            kind, content = "other", f"{status.st_rdev}"
            if place.is_symlink():
                kind, content = "link", str(Path(place.path).readlink())
            elif place.is_dir(follow_symlinks=False):
                found[name] = Entry("folder", status.st_mode, "", status.st_ino, 0)
                self._look_into(Path(place.path), f"{name}/", found)
                continue
            elif stat.S_ISREG(status.st_mode):
                kind, content = "file", _digest(Path(place.path), status.st_size)
            found[name] = Entry(kind, status.st_mode, content, status.st_ino, status.st_mtime_ns, status.st_size)


def _digest(path: Path, byte_count: int) -> str:
    with path.open("rb") as file:
        return hashlib.blake2b(file.read(HASHED_BYTES), digest_size=16).hexdigest() + f" {byte_count}"
