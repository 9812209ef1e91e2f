"""What must hold whatever was asked for, wherever: the promises of docs/reliability.md and docs/contract.md."""

import json
import re
import signal
from collections.abc import Iterator
from pathlib import PurePosixPath

import jsonschema

from tests.fuzz.command_lines.case import Case
from tests.fuzz.command_lines.files import ANSWERS, SCHEMA, broken_by_files
from tests.fuzz.command_lines.names import SEQUENCE
from tests.fuzz.command_lines.promises import Broken, culprit, plain, shortened
from tests.fuzz.command_lines.runner import Ended, Outcome

WRONG_USE = 2
MOST_BYTES = 2 << 30
LONGEST_LINE = 650  # 600 characters of a message, and the program's name
MOST_NOTES = 6
# What may stand on stderr beside the one line of an error: each says something that a person should know.
NOTES = (
    r"ashe-live: the camera's field of view is not known: ",
    r"ashe-live: a recording that was cut short is now ",
    r"ashe-live: no camera is connected, so this is the demo ",
    r"ashe-live: .* is truncated or damaged: ",
    r"ashe-live: .*: passed over, as not named as ",
    r"ashe-live: saved ",
    r"ashe-live: nothing to estimate in frame ",
    r"ashe-live: camera: [0-9.]+° ",
    r"ashe-live: .* has appeared meanwhile and stays as it is: see ",
    r".*: steps in ",
    r"ashe-live: .*: without its steps: ",
    r"sheet in ",
    r".*frame \d+: ",  # the board's guide
    r"(?:[^A-Za-z\\]|\\u[0-9a-f]{4})+$",  # the same where the terminal has a column only
)
PROGRAM_LINE = re.compile("|".join([*NOTES, "ashe-live: "]))
NOTE = re.compile("|".join(NOTES))
CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
BEFORE_HANDLERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def broken_promises(case: Case, outcome: Outcome) -> list[Broken]:
    """None is what is hoped for."""
    found = [*_of_processes(outcome), *broken_by_files(case, outcome)]
    for ended in outcome.ended:
        found += _of_status(case, ended)
        found += _of_errors(case, ended)
        found += _of_answers(case, ended)
    if SEQUENCE.encode() in outcome.shown:
        found.append(Broken("no name controls the terminal", "sequence on the terminal", repr(outcome.shown[-300:])))
    return found


def is_before_our_first_line(case: Case, ended: Ended) -> bool:
    """Whether a signal came while Python was still starting, or pip's script imported what it needs.

    Nothing of ours can hear it then. By Ctrl-C Python ends with a traceback, and with status 130 or 1; by a kill of its
    parent, a process that is being made finds nothing to read.
    """
    sent = {number for _, number, _ in case.signals}
    is_interrupted = signal.SIGINT in sent and culprit(ended.err) == "KeyboardInterrupt in Python"
    is_unborn = b"pickle.load(from_parent)" in ended.err and ended.err.rstrip().endswith(b"EOFError: Ran out of input")
    return is_interrupted or (signal.SIGKILL in sent and is_unborn)


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
    if ended.status not in {*ANSWERS, WRONG_USE, *by_signal} and not is_before_our_first_line(case, ended):
        yield Broken("a documented status", f"status {ended.status}: {culprit(ended.err)}", shortened(ended.err))


def _of_errors(case: Case, ended: Ended) -> Iterator[Broken]:
    """What stands on stderr: lines of the program's own, one of them about an error."""
    text = ended.err.decode("utf-8", "surrogateescape")
    if case.environment.get("PYTHONIOENCODING") == "utf-16":
        return
    yield from _of_characters(text, "stderr")
    if is_before_our_first_line(case, ended):
        return
    lines = [line for line in text.split("\n") if line.strip()]
    foreign = [line for line in lines if not PROGRAM_LINE.match(line)]
    if foreign:
        yield Broken("only lines of its own on stderr", f"stderr: {culprit(ended.err)}", shortened(ended.err))
    elif any(len(line) > LONGEST_LINE for line in lines):
        yield Broken("lines of a bounded length", "long line: " + plain(lines[0]), f"{max(map(len, lines))} characters")
    errors = [line for line in lines if not NOTE.match(line)]
    if ended.status == WRONG_USE and not foreign:
        if len(errors) > 1:
            yield Broken("one line about an error", "lines: " + plain(errors[0]), shortened(ended.err))
        is_said_elsewhere = case.stderr != "file" or not {"estimate", "doctor"}.isdisjoint(case.arguments)
        if not errors and not is_said_elsewhere:
            yield Broken("one line about an error", "says nothing", shortened(ended.out))
    elif len(errors) > MOST_NOTES and not foreign:
        yield Broken("few notes", "many notes", shortened(ended.err))


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
                yield Broken("JSON as in the contract", "json: " + plain(str(error)), line[:300])
    if "Traceback (most" in text:
        yield Broken("no traceback", "stdout: " + culprit(ended.out), shortened(ended.out))


def _of_characters(text: str, stream: str) -> Iterator[Broken]:
    if (control := CONTROLS.search(text)) is not None:
        where = plain(text[max(0, text.rfind("\n", 0, control.start())) : control.start()])
        around = text[max(0, control.start() - 60) : control.end() + 60]
        yield Broken(f"no control character on {stream}", f"{stream} control: {where}", ascii(around))
