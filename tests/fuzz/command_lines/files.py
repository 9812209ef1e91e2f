"""Files after a run: what was there is as it was, what is new was asked for, and another reader finds it whole."""

import json
import re
import signal
from collections.abc import Callable, Iterator, Mapping
from fnmatch import fnmatch
from pathlib import Path, PurePosixPath

import av
import jsonschema
import PIL.Image

from tests.checkout import CHECKOUT
from tests.fuzz.command_lines.case import HOME, TEMPORARY, Case
from tests.fuzz.command_lines.promises import Broken
from tests.fuzz.command_lines.runner import Outcome
from tests.fuzz.command_lines.sandbox import Entry

SCHEMA = json.loads((CHECKOUT / "docs" / "contract.schema.json").read_text(encoding="utf-8"))
ANSWERS = (0, 3, 4)
# What the program, and the libraries below it, may keep in a person's home.
OWN_PLACES = (f"{HOME}/.cache", f"{HOME}/.local", f"{HOME}/.config", f"{HOME}/.nv", f"{HOME}/Library")
DEMO_FILES = ("ashe-live-demo-*.mp4", "ashe-live-demo-*.png")


def broken_by_files(case: Case, outcome: Outcome) -> Iterator[Broken]:
    """Of what was there, of what is new, of what should be."""
    outputs = {_normal(f"{case.folder}/{outcome.sandbox.filled(output)}") for output in case.outputs}
    yield from _of_what_was_there(case, outcome, outputs)
    yield from _of_what_is_new(case, outcome, outputs)
    yield from _of_what_was_asked_for(case, outcome, outputs)


def picture_count(path: Path) -> int:
    """How many pictures of a clip can be decoded. Raises what the decoder does about one that is broken."""
    with av.open(str(path.absolute())) as clip:
        return sum(1 for _ in clip.decode(video=0))


def defect(path: Path) -> str | None:
    """What is wrong with a file of one of the kinds that the program writes, None when it is whole."""
    check = CHECKS.get(path.suffix.lower())
    if check is None:
        return None
    try:
        return check(path)
    except Exception as error:  # whatever a reader raises, the file is not whole
        return f"{type(error).__name__}: {error}"


def _clip(path: Path) -> str | None:
    return None if picture_count(path) else "no picture in it"


def _picture(path: Path) -> str | None:
    with PIL.Image.open(path) as picture:
        picture.load()
    return None


def _pdf(path: Path) -> str | None:
    content = path.read_bytes()
    return None if content.startswith(b"%PDF") and content.rstrip().endswith(b"%%EOF") else "no whole PDF"


def _page(path: Path) -> str | None:
    return None if path.read_text(encoding="utf-8").rstrip().endswith("</html>") else "no whole page"


def _json(path: Path) -> str | None:
    content = json.loads(path.read_text(encoding="utf-8"), parse_constant=_no_number)
    if "summary" in content:
        jsonschema.validate(content, SCHEMA)
    return None


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is not JSON")


CHECKS: Mapping[str, Callable[[Path], str | None]] = {
    ".mp4": _clip,
    ".png": _picture,
    ".pdf": _pdf,
    ".html": _page,
    ".json": _json,
}


def _of_what_was_there(case: Case, outcome: Outcome, outputs: set[str]) -> Iterator[Broken]:
    after = outcome.after
    for path, entry in outcome.before.items():
        is_target = case.overwrites and path in outputs and entry.kind in ("file", "link")
        now = after.get(path)
        is_home = path.startswith(OWN_PLACES) and entry.kind == "folder"
        if now is None and not (case.folder == "deleted" and path.startswith("deleted-")):
            yield Broken("foreign files stay", f"gone: {_kind(path, entry)}", path)
        elif now is not None and not is_target and not is_home and _differs(entry, now, path, case):
            yield Broken("foreign files stay", f"changed: {_kind(path, entry)}", f"{path!r}: {entry} is now {now}")
        elif now is not None and is_target and now != entry and now.kind == "file" and (why := _defect(outcome, path)):
            yield Broken("outputs are whole", f"not whole: {PurePosixPath(path).suffix}", f"{path!r}: {why}")


def _of_what_is_new(case: Case, outcome: Outcome, outputs: set[str]) -> Iterator[Broken]:
    for path, entry in outcome.after.items():
        if path in outcome.before or (entry.kind == "folder" and _is_output(path, outputs)):
            continue
        if not _may_appear(path, case, outputs):
            yield Broken("nothing is left over", f"left: {_pattern(path)}", f"{path!r}, {entry.byte_count} bytes")
        elif entry.kind == "file" and not _is_abandoned(path, case) and (why := _defect(outcome, path)) is not None:
            yield Broken("outputs are whole", f"not whole: {PurePosixPath(path).suffix}", f"{path!r}: {why}")


def _of_what_was_asked_for(case: Case, outcome: Outcome, outputs: set[str]) -> Iterator[Broken]:
    before, after = outcome.before, outcome.after
    answered = [ended for ended in outcome.ended if ended.status in ANSWERS]
    if len(answered) > 1 and not case.overwrites and any(output.lower().endswith(".mp4") for output in outputs):
        clips = [
            path
            for path, entry in after.items()
            if path not in before and entry.kind == "file" and path[-4:].lower() == ".mp4"
        ]
        if len(clips) < len(answered):
            yield Broken("no recording is lost", "recording lost", f"{clips!r} of {len(answered)}")
    if answered and len(outcome.ended) == 1 and "bench" not in case.arguments and "-h" not in case.arguments:
        written = {path for path in outputs if path in after and (path not in before or case.overwrites)}
        is_help = any(word in ("--help", "--version") for word in case.arguments)
        missing = outputs - written - {_normal(f"{case.folder}/{name}") for name in ("steps",)}
        if missing and not is_help and "--debug" not in "".join(case.arguments):
            yield Broken("what was asked for is written", f"missing: {_pattern(min(missing))}", f"{sorted(missing)!r}")


def _defect(outcome: Outcome, path: str) -> str | None:
    return defect(outcome.sandbox.base / path)


def _differs(entry: Entry, now: Entry, path: str, case: Case) -> bool:
    if path in {_normal(name) for name in case.modes}:
        return (entry.kind, entry.content, entry.inode, entry.modified_ns) != (
            now.kind, now.content, now.inode, now.modified_ns
        )  # fmt: skip
    return entry != now


def _is_output(path: str, outputs: set[str]) -> bool:
    return any(path == output or path.startswith(f"{output}/") or output.startswith(f"{path}/") for output in outputs)


def _may_appear(path: str, case: Case, outputs: set[str]) -> bool:
    name = PurePosixPath(path).name
    if path.startswith(OWN_PLACES):
        return True
    if _is_abandoned(path, case):
        return True
    folder = str(PurePosixPath(path).parent)
    if any(fnmatch(name, pattern) for pattern in DEMO_FILES):
        return folder in {case.folder, *(str(PurePosixPath(output).parent) for output in outputs)}
    # What a full disk leaves of a recording stays.
    if "RLIMIT_FSIZE" in case.limits and name.startswith(".") and name.endswith(".mp4"):
        return True
    # Of two at once the later one takes the next name.
    first = re.sub(r"-[2-9](\.\w+)$", r"\1", path) if case.second_after_ms is not None else path
    return any(first == output or path.startswith(f"{output}/") for output in outputs)


def _is_abandoned(path: str, case: Case) -> bool:
    """What a killed process had in the making."""
    is_killed = signal.SIGKILL in {number for _, number, _ in case.signals}
    return is_killed and (path.startswith(TEMPORARY) or PurePosixPath(path).name.startswith("."))


def _normal(path: str) -> str:
    parts = [part for part in path.split("/") if part not in ("", ".")]
    return "/".join(parts)


def _pattern(path: str) -> str:
    """Hidden or not, and the suffix: without the name, which is the case's."""
    place = PurePosixPath(path)
    hidden, partial = "." if place.name.startswith(".") else "", ".partial" if ".partial" in place.name else ""
    return f"{place.parts[0]}/{hidden}*{partial}{place.suffix[:8]}"


def _kind(path: str, entry: Entry) -> str:
    return f"{entry.kind} {_pattern(path)}"
