"""Recordings that are ended in every way, at random moments: the right status, every frame kept, nothing left over."""

import random
import re
import shutil
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import av
import pytest

from tests.fuzz.command_lines.case import WORK, Case, Planted
from tests.fuzz.command_lines.files import picture_count
from tests.fuzz.command_lines.oracle import broken_promises, is_before_our_first_line

KINDS = ("signal", "Ctrl-C in the first second", "two instances", "asleep while another starts", "kill -9 and restart")
LONGEST_MS = 2500
ENDLESS = Case(
    ("play", "clip.mp4", "--headless", "--loop", "--frames", "1000000", "--quality", "fast", "--estimate-at", "999999",
     "--no-hide-marker", "--out", "walk.mp4"),
    (Planted(f"{WORK}/clip.mp4", "material", "clip.mp4"),),
    ("walk.mp4",),
)  # fmt: skip
SHORT = replace(ENDLESS, arguments=tuple("20" if word == "1000000" else word for word in ENDLESS.arguments))


def broken_run(runner, kind: str, chance: random.Random) -> list[str]:
    """Everything that went otherwise than promised in one run."""
    if kind == "kill -9 and restart":
        return list(_killed_and_started_again(runner, chance))
    case = ENDLESS
    number = chance.choice((signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
    if kind == "signal":
        after_ms = chance.randrange(LONGEST_MS)
        again = ((after_ms + chance.randrange(200), int(number), False),) if chance.random() < 0.5 else ()
        case = replace(ENDLESS, signals=((after_ms, int(number), chance.random() < 0.5), *again))
    elif kind == "Ctrl-C in the first second":
        number = signal.SIGINT
        case = replace(ENDLESS, signals=((chance.randrange(1000), int(number), True),), start="script")
    elif kind == "two instances":
        case = replace(SHORT, second_after_ms=chance.randrange(700))
    else:
        asleep_ms = chance.randrange(200, 900)
        sleep = ((asleep_ms, int(signal.SIGSTOP), False), (asleep_ms + 1500, int(signal.SIGCONT), False))
        case = replace(SHORT, second_after_ms=asleep_ms + 100, signals=sleep)
    with runner.run(case) as outcome:
        broken = [f"{case.signals} {case.second_after_ms}: {each}" for each in broken_promises(case, outcome)]
        ended = outcome.ended[0]
        is_ours = len(outcome.ended) == 1 and not is_before_our_first_line(case, ended)
        if is_ours and ended.status not in (128 + number, -number):
            broken.append(f"{case.signals}: status {ended.status} instead of {128 + number}: {ended.err[-300:]!r}")
        if len(outcome.ended) == 2 and [ended.status for ended in outcome.ended] not in ([0, 0], [0, 2], [2, 0]):
            broken.append(f"{case.second_after_ms}: statuses {[ended.status for ended in outcome.ended]}")
        said = re.search(rb"saved .* \((\d+) frames?\)", outcome.ended[0].err)
        walk = outcome.sandbox.base / WORK / "walk.mp4"
        if said and walk.exists() and picture_count(walk) != int(said[1]):
            broken.append(f"{case.signals}: {picture_count(walk)} pictures in it, but {said[0]!r}")
        return broken


def _killed_and_started_again(runner, chance: random.Random) -> Iterator[str]:
    """The next start, at once and with the same output, finds every picture that could be played."""
    killed = replace(ENDLESS, signals=((chance.randrange(400, 2 * LONGEST_MS), int(signal.SIGKILL), False),))
    with runner.run(killed) as outcome:
        for each in broken_promises(killed, outcome):
            yield f"{killed.signals}: {each}"
        folder = outcome.sandbox.base / WORK
        partials = [path for path in folder.iterdir() if path.name.startswith(".")]
        recoverable = sum(recoverable_pictures(path, outcome.sandbox.records / "copy.mp4") for path in partials)
        again = replace(SHORT, arguments=tuple("3" if word == "20" else word for word in SHORT.arguments))
        restarted = runner.run(again, outcome.sandbox)
        if [ended.status for ended in restarted.ended] != [0]:
            yield f"{killed.signals}: the next start ends with {restarted.ended}"
        clips = {path.name: picture_count(path) for path in folder.glob("walk*.mp4")}
        if clips.get("walk.mp4") != 3:
            yield f"{killed.signals}: the next recording has {clips.get('walk.mp4')} pictures of 3"
        rescued = sum(clips.values()) - clips.get("walk.mp4", 0)
        if rescued < recoverable:
            yield f"{killed.signals}: {rescued} of {recoverable} recoverable pictures; {clips}"
        left = sorted(path.name for path in folder.iterdir() if path.name.startswith("."))
        if left:
            yield f"{killed.signals}: {left} left"


def recoverable_pictures(partial: Path, copy: Path) -> int:
    """As many as can be decoded of a recording in the making, by whatever means."""
    shutil.copyfile(partial, copy)
    content = copy.read_bytes()
    # A fragment that is not whole hides those before it from some readers: the longest beginning that is one counts.
    ends = [match.start() - 4 for match in re.finditer(b"moof", content)]
    counts = [0]
    for end in (len(content), *reversed(ends[-2:])):
        copy.write_bytes(content[:end])
        try:
            counts.append(picture_count(copy))
        except (av.error.FFmpegError, IndexError):
            continue
    copy.unlink()
    return max(counts)


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_that_is_ended_at_any_moment_is_kept_and_nothing_else(runner, kind):
    """One run of each kind; --fuzz-signals tries very many."""
    assert broken_run(runner, kind, random.Random(f"7 {kind}")) == []


def test_very_many_recordings_that_are_ended_at_random(runner, capsys, pytestconfig):
    count = pytestconfig.getoption("fuzz_signals", None)
    if count is None:
        pytest.skip("a long run: --fuzz-signals N --fuzz-seed N")
    chance = random.Random(pytestconfig.getoption("fuzz_seed"))
    broken: dict[str, list[str]] = {kind: [] for kind in KINDS}
    for at in range(count):
        kind = KINDS[at % len(KINDS)]
        broken[kind] += broken_run(runner, kind, chance)
        if (at + 1) % 20 == 0:
            counts = {kind: len(each) for kind, each in broken.items()}
            with capsys.disabled():
                print(f"{at + 1} of {count} runs, broken: {counts}", flush=True)
    assert not any(broken.values()), "\n".join(f"{kind}: {each}" for kind in KINDS for each in broken[kind])
