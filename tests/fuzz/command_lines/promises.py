"""A promise that was broken, and words for why: the same ones for the same fault."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tests.fuzz.command_lines.names import SEQUENCE


@dataclass(frozen=True, slots=True)
class Broken:
    """A promise that was not kept. `cause` is the same for the same fault, however the case looked."""

    promise: str
    cause: str
    detail: str

    def __str__(self) -> str:
        return f"{self.promise}: {self.detail}"


def by_cause(broken: Iterable[Broken]) -> Mapping[str, Broken]:
    return {f"{each.promise} | {each.cause}": each for each in broken}


def culprit(err: bytes) -> str:
    """Kind of error and innermost function of ours in the last traceback; else the beginning of the first line."""
    text = err.decode("utf-8", "replace")
    frames = re.findall(r'File "[^"\n]*/ashe_live/([^"\n]+)", line \d+, in (\S+)', text)
    lines = [line for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if re.match(r"[\w.]+(Error|Exception|Interrupt|Warning)\b", line)]
    if "Traceback (most" in text and errors:
        return f"{errors[-1].split(':')[0]} in {' '.join(frames[-1]) if frames else 'Python'}"
    return plain(next((line for line in lines if not line.startswith("ashe-live: ")), lines[0] if lines else ""))


def plain(text: str) -> str:
    """The words of a message without what was filled in."""
    return " ".join(re.findall(r"[A-Za-z]{3,}", text.replace(SEQUENCE, ""))[:7])


def shortened(content: bytes) -> str:
    text = content.decode("utf-8", "backslashreplace")
    return ascii(text if len(text) < 700 else f"{text[:200]} [...] {text[-450:]}")
