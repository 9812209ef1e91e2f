"""Runs cases through the fork server, each in a sandbox of its own, and says what became of them."""

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from tests.checkout import CHECKOUT
from tests.fuzz.command_lines.case import HOME, TEMPORARY, Case
from tests.fuzz.command_lines.sandbox import Entry, Sandbox

SCRIPT = Path(sys.executable).with_name("ashe-live")
SERVER = Path(__file__).with_name("fork_server.py")
# Far beyond what any case needs, and what a child needs to notice that its parent has ended: on a machine that others
# crowd tenfold, some cases took a minute.
LONGEST_S, SURVIVES_FOR_S = 240.0, 20.0
READ_BYTES = 4 << 20


@dataclass(frozen=True, slots=True)
class Ended:
    """One process of a case: the exit status, negative for a signal that ended it; what it wrote."""

    status: int | None
    wall_s: float
    out: bytes
    err: bytes


@dataclass(frozen=True, slots=True)
class Outcome:
    """All that the oracle judges."""

    ended: tuple[Ended, ...]
    hangs: bool
    survivors: tuple[str, ...]
    connections: int
    shown: bytes  # on the terminal, where there was one
    largest_bytes: int
    ran_code: tuple[str, ...]
    before: Mapping[str, Entry]
    after: Mapping[str, Entry]
    sandbox: Sandbox  # removed where the outcome, as a context manager, ends

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.sandbox.remove()


class Runner:
    """A fork server and a folder for sandboxes; a context manager."""

    def __init__(self, materials: Mapping[str, Path]) -> None:
        self._materials = materials
        self._folder = Path(tempfile.mkdtemp(prefix="ashe-live-fuzz-"))
        self._numbers = count()
        ours, theirs = socket.socketpair()
        self._server = subprocess.Popen(
            [sys.executable, str(SERVER), str(theirs.fileno())],
            pass_fds=[theirs.fileno()],
            cwd=self._folder,
            env={**os.environ, "PYTHONPATH": str(CHECKOUT)},
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
        theirs.close()
        self._lines = ours.makefile("rw", encoding="ascii")
        ours.close()
        self.port: int = json.loads(self._lines.readline())["port"]

    def run(
        self,
        case: Case,
        sandbox: Sandbox | None = None,
        script: Path = SCRIPT,
        longest_s: float = LONGEST_S,
        survives_for_s: float = SURVIVES_FOR_S,
    ) -> Outcome:
        """In a new sandbox, or in one that an earlier case has left.

        `script` is what is started. After `longest_s` it counts as hanging, and what is still there `survives_for_s`
        after its end as a survivor. Raises RuntimeError when the harness itself fails.
        """
        if sandbox is None:
            sandbox = Sandbox(self._folder / str(next(self._numbers)), case, self._materials, self.port)
        starts = [self._start(case, sandbox, script, 0, 0.0)]
        if case.second_after_ms is not None:
            starts.append(self._start(case, sandbox, script, 1, case.second_after_ms / 1000))
        before = sandbox.snapshot()
        signals = [(after_ms / 1000, number, group) for after_ms, number, group in case.signals]
        answer = self._ask(
            {"starts": starts, "signals": signals, "within_s": longest_s, "survives_for_s": survives_for_s}
        )
        sandbox.permit_all()
        for record in sandbox.records.glob("*.harness"):
            raise RuntimeError(record.read_text())
        ended = tuple(
            Ended(how["status"], how["wall_s"], *(_read(f"{start['records']}.{name}") for name in ("stdout", "stderr")))
            for start, how in zip(starts, answer["ended"], strict=True)
        )
        return Outcome(
            ended,
            answer["hangs"],
            tuple(answer["survivors"]),
            answer["connections"],
            answer["shown"].encode("latin-1"),
            answer["largest_bytes"],
            tuple(sandbox.ran_code()),
            before,
            sandbox.snapshot(),
            sandbox,
        )

    def _ask(self, question: dict[str, Any]) -> Any:
        self._lines.write(json.dumps(question) + "\n")
        self._lines.flush()
        answer = self._lines.readline()
        if not answer:
            raise RuntimeError(f"the fork server ended with status {self._server.wait()}")
        return json.loads(answer)

    def _start(self, case: Case, sandbox: Sandbox, script: Path, number: int, after_s: float) -> dict[str, Any]:
        folder = sandbox.base / sandbox.filled(case.folder)
        if case.folder == "deleted":
            folder = sandbox.base / f"deleted-{number}"
            folder.mkdir()
        environment = {
            "HOME": str(sandbox.base / HOME),
            "TMPDIR": str(sandbox.base / TEMPORARY),
            "PATH": os.environ.get("PATH", os.defpath),
            "LANG": "C.UTF-8",
            "PYTHONDONTWRITEBYTECODE": "1",
            "MESA_SHADER_CACHE_DIR": str(self._folder / "shaders"),  # compiled once for all
        }
        for name, value in case.environment.items():
            environment.pop(name, None)
            if value is not None:
                environment[name] = sandbox.filled(value)
        return {
            "script": str(script),
            "argv": [sandbox.filled(argument) for argument in case.arguments],
            "folder": str(folder),
            "is_deleted": case.folder == "deleted",
            "environment": environment,
            "modes": [(str(sandbox.base / sandbox.filled(path)), mode) for path, mode in case.modes.items()],
            "stdin": case.stdin,
            "stdout": case.stdout,
            "stderr": case.stderr,
            "limits": dict(case.limits),
            "how": case.start,
            "after_s": after_s,
            "records": str(sandbox.records / str(number)),
        }

    def close(self) -> None:
        self._lines.close()
        try:
            self._server.wait(LONGEST_S)
        except subprocess.TimeoutExpired:
            self._server.kill()
            self._server.wait()
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def _read(path: str) -> bytes:
    with contextlib.suppress(FileNotFoundError), Path(path).open("rb") as file:
        return file.read(READ_BYTES)
    return b""
