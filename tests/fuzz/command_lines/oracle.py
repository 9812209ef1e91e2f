"""What must hold whatever was asked for, wherever: the promises of docs/reliability.md and docs/contract.md."""

import json
import re
import signal
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import PurePosixPath

import jsonschema

from tests.fuzz.command_lines.case import HOME, TEMPORARY, Case
from tests.fuzz.command_lines.names import SEQUENCE
from tests.fuzz.command_lines.outputs import SCHEMA, defect
from tests.fuzz.command_lines.runner import Ended, Outcome
from tests.fuzz.command_lines.sandbox import Entry

ANSWERS = (0, 3, 4)
WRONG_USE = 2
MOST_BYTES = 2 << 30
LONGEST_LINE = 4000
MOST_NOTES = 6
# What may stand on stderr beside the one line of an error: each says something that a person should know.
NOTES = (
    r"ashe-live: the camera's field of view is not known, ",
    r"ashe-live: a recording that was cut short is now ",
    r"ashe-live: no camera is connected, so this is the demo ",
    r"ashe-live: .* is truncated or damaged: ",
    r"ashe-live: saved ",
    r".*: steps in ",
    r"sheet in ",
    r".*frame \d+: ",  # the board's guide
)
PROGRAM_LINE = re.compile("|".join([*NOTES, "ashe-live: "]))
NOTE = re.compile("|".join(NOTES))
CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
BEFORE_HANDLERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# What the program, and the libraries below it, may keep in a person's home and for temporary use.
OWN_PLACES = (f"{HOME}/.cache", f"{HOME}/.local", f"{HOME}/.config", f"{HOME}/.nv", f"{HOME}/Library")
DEMO_FILES = ("ashe-live-demo-*.mp4", "ashe-live-demo-*.png")


@dataclass(frozen=True, slots=True)
class Broken:
    """A promise that was not kept. `cause` is the same for the same fault, however the case looked."""

    promise: str
    cause: str
    detail: str

    def __str__(self) -> str:
        return f"{self.promise}: {self.detail}"


def broken_promises(case: Case, outcome: Outcome) -> list[Broken]:
    """None is what is hoped for."""
    found = [*_of_processes(outcome), *_of_files(case, outcome)]
    for ended in outcome.ended:
        found += _of_status(case, ended)
        found += _of_errors(case, ended)
        found += _of_answers(case, ended)
    if SEQUENCE.encode() in outcome.shown:
        found.append(Broken("no name controls the terminal", "sequence on the terminal", repr(outcome.shown[-300:])))
    return found


def _of_processes(outcome: Outcome) -> Iterator[Broken]:
    if outcome.hangs:
        yield Broken("it ends", "hangs", "still there after the longest time")
    for survivor in outcome.survivors:
        yield Broken("no process survives", "survivor " + survivor[-60:], survivor)
    if outcome.connections:
        yield Broken("no network", "connection", f"{outcome.connections} connections to the listener")
    if outcome.ran_code:
        names = sorted({PurePosixPath(path).name for path in outcome.ran_code})
        yield Broken("no foreign code runs", f"ran {names[0]}", ", ".join(outcome.ran_code))
    if outcome.largest_bytes > MOST_BYTES:
        yield Broken("memory below 2 GB", "memory", f"{outcome.largest_bytes >> 20} MiB")


def _of_status(case: Case, ended: Ended) -> Iterator[Broken]:
    sent = {number for _, number, _ in case.signals}
    by_signal = {128 + number for number in sent} | {-number for number in sent if number in BEFORE_HANDLERS}
    if signal.SIGKILL in sent:
        by_signal.add(-signal.SIGKILL)
    if ended.status not in {*ANSWERS, WRONG_USE, *by_signal}:
        yield Broken("a documented status", f"status {ended.status}: {_culprit(ended.err)}", _shortened(ended.err))


def _of_errors(case: Case, ended: Ended) -> Iterator[Broken]:
    """What stands on stderr: lines of the program's own, one of them about an error."""
    text = ended.err.decode("utf-8", "surrogateescape")
    if case.environment.get("PYTHONIOENCODING") == "utf-16":
        return
    yield from _of_characters(text, "stderr")
    lines = [line for line in text.split("\n") if line.strip()]
    foreign = [line for line in lines if not PROGRAM_LINE.match(line)]
    if foreign:
        yield Broken("only lines of its own on stderr", f"stderr: {_culprit(ended.err)}", _shortened(ended.err))
    elif any(len(line) > LONGEST_LINE for line in lines):
        yield Broken(
            "lines of a bounded length", "long line: " + _plain(lines[0]), f"{max(map(len, lines))} characters"
        )
    errors = [line for line in lines if not NOTE.match(line)]
    if ended.status == WRONG_USE and not foreign:
        if len(errors) > 1:
            yield Broken("one line about an error", "lines: " + _plain(errors[0]), _shortened(ended.err))
        is_said_elsewhere = case.stderr != "file" or not {"estimate", "doctor"}.isdisjoint(case.arguments)
        if not errors and not is_said_elsewhere:
            yield Broken("one line about an error", "says nothing", _shortened(ended.out))
    elif len(errors) > MOST_NOTES and not foreign:
        yield Broken("few notes", "many notes", _shortened(ended.err))


def _of_answers(case: Case, ended: Ended) -> Iterator[Broken]:
    """What stands on stdout, where it is a file."""
    if case.stdout != "file" or case.environment.get("PYTHONIOENCODING") == "utf-16" or "RLIMIT_FSIZE" in case.limits:
        return
    text = ended.out.decode("utf-8", "surrogateescape")
    is_json = "--json" in case.arguments and "estimate" in case.arguments[:1]
    if not is_json:
        yield from _of_characters(text, "stdout")
    elif ended.status in ANSWERS:
        for line in text.splitlines():
            try:
                jsonschema.validate(json.loads(line), SCHEMA)
            except (ValueError, jsonschema.ValidationError) as error:
                yield Broken("JSON as in the contract", "json: " + _plain(str(error)), line[:300])
    if "Traceback (most" in text:
        yield Broken("no traceback", "stdout: " + _culprit(ended.out), _shortened(ended.out))


def _of_characters(text: str, stream: str) -> Iterator[Broken]:
    if (control := CONTROLS.search(text)) is not None:
        where = _plain(text[max(0, text.rfind("\n", 0, control.start())) : control.start()])
        around = text[max(0, control.start() - 60) : control.end() + 60]
        yield Broken(f"no control character on {stream}", f"{stream} control: {where}", ascii(around))


def _of_files(case: Case, outcome: Outcome) -> Iterator[Broken]:
    """All that was there is as it was; what is new was asked for and is whole."""
    before, after, sandbox = outcome.before, outcome.after, outcome.sandbox
    outputs = {_normal(f"{case.folder}/{sandbox.filled(output)}") for output in case.outputs}
    for path, entry in before.items():
        is_target = case.overwrites and path in outputs and entry.kind in ("file", "link")
        now = after.get(path)
        is_home = path.startswith(OWN_PLACES) and entry.kind == "folder"
        if now is None and not (case.folder == "deleted" and path.startswith("deleted-")):
            yield Broken("foreign files stay", f"gone: {_kind(path, entry)}", path)
        elif now is not None and not is_target and not is_home and _differs(entry, now, path, case):
            yield Broken("foreign files stay", f"changed: {_kind(path, entry)}", f"{path!r}: {entry} is now {now}")
        elif now is not None and is_target and now != entry and now.kind == "file" and (why := _defect(outcome, path)):
            yield Broken("outputs are whole", f"not whole: {PurePosixPath(path).suffix}", f"{path!r}: {why}")
    answered = [ended for ended in outcome.ended if ended.status in ANSWERS]
    if len(answered) > 1 and not case.overwrites and any(output.lower().endswith(".mp4") for output in outputs):
        clips = [
            path
            for path, entry in after.items()
            if path not in before and entry.kind == "file" and path[-4:].lower() == ".mp4"
        ]
        if len(clips) < len(answered):
            yield Broken("no recording is lost", "recording lost", f"{clips!r} of {len(answered)}")
    for path, entry in after.items():
        if path in before or (entry.kind == "folder" and _is_output(path, outputs)):
            continue
        if not _may_appear(path, case, outputs):
            yield Broken("nothing is left over", f"left: {_pattern(path)}", f"{path!r}, {entry.byte_count} bytes")
        elif entry.kind == "file" and not _is_abandoned(path, case) and (why := _defect(outcome, path)) is not None:
            yield Broken("outputs are whole", f"not whole: {PurePosixPath(path).suffix}", f"{path!r}: {why}")
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


def _culprit(err: bytes) -> str:
    """Kind of error and innermost function of ours in the last traceback; else the beginning of the first line."""
    text = err.decode("utf-8", "replace")
    frames = re.findall(r'File "[^"\n]*/ashe_live/([^"\n]+)", line \d+, in (\S+)', text)
    lines = [line for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if re.match(r"[\w.]+(Error|Exception|Interrupt|Warning)\b", line)]
    if "Traceback (most" in text and errors:
        return f"{errors[-1].split(':')[0]} in {' '.join(frames[-1]) if frames else 'Python'}"
    return _plain(next((line for line in lines if not PROGRAM_LINE.match(line)), lines[0] if lines else ""))


def _plain(text: str) -> str:
    """The words of a message without what was filled in."""
    return " ".join(re.findall(r"[A-Za-z]{3,}", text.replace(SEQUENCE, ""))[:7])


def _shortened(content: bytes) -> str:
    text = content.decode("utf-8", "backslashreplace")
    return ascii(text if len(text) < 700 else f"{text[:200]} [...] {text[-450:]}")


def by_cause(broken: list[Broken]) -> Mapping[str, Broken]:
    return {f"{each.promise} | {each.cause}": each for each in broken}
