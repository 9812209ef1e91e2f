"""In a process that has just been forked: takes on all circumstances of a case and runs the program.

A module beside fork_server.py, which is a script; like that one it imports nothing of the tests.
"""

import atexit
import contextlib
import ctypes
import importlib
import io
import os
import resource
import runpy
import signal
import sys
import threading
import traceback
from pathlib import Path
from typing import Any, NoReturn

PR_CAPBSET_DROP = 24
# A superuser for whom permissions hold: capabilities 1 and 2 are those that ignore them.
IGNORES_PERMISSIONS = (1, 2)
CAPABILITY_VERSION_3 = 0x20080522


def obey_permissions(libc: ctypes.CDLL) -> None:
    """Gives up what lets a superuser ignore them; does nothing for others, who have no such rights."""
    if os.geteuid() != 0:
        return
    for capability in IGNORES_PERMISSIONS:
        libc.prctl(PR_CAPBSET_DROP, capability, 0, 0, 0)
    header = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION_3, 0)
    sets = (ctypes.c_uint32 * 6)()  # effective, permitted, inheritable of the first 32; then of the others
    if libc.capget(header, sets) == 0:
        for at in range(3):
            for capability in IGNORES_PERMISSIONS:
                sets[at] &= ~(1 << capability)
        libc.capset(header, sets)


def opened_stream(kind: str, path: str, terminal: str | None, writes: bool) -> int | None:
    """A file descriptor, None for a closed one."""
    if kind == "closed":
        return None
    if kind == "broken pipe":
        reading, writing = os.pipe()
        os.close(reading)
        return writing
    where = {"full": "/dev/full", "null": os.devnull, "file": path, "terminal": terminal or os.devnull}[kind]
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC if writes else os.O_RDONLY
    return os.open(where, flags | os.O_NOCTTY, 0o600)


def use_streams(streams: list[int | None]) -> None:
    """As descriptors 0 to 2; all others are closed."""
    high = [None if stream is None else os.dup2(stream, 1000 + at) for at, stream in enumerate(streams)]
    os.closerange(0, 1000)
    for at, stream in enumerate(high):
        if stream is not None:
            os.dup2(stream, at, inheritable=True)
    os.closerange(1000, 1003)


def python_streams(environment: dict[str, str]) -> None:
    """`sys.stdin`, `stdout` and `stderr` as an interpreter makes them that starts in this environment."""
    is_plain = environment.get("LC_ALL", environment.get("LANG", "C")) in ("C", "POSIX", "")
    encoding, _, errors = environment.get("PYTHONIOENCODING", "").partition(":")
    errors = errors or ("strict" if encoding or not is_plain else "surrogateescape")
    for at, (name, mode) in enumerate((("stdin", "rb"), ("stdout", "wb"), ("stderr", "wb"))):
        stream = None
        with contextlib.suppress(OSError):
            raw = open(at, mode, closefd=False)  # noqa: SIM115
            how = "backslashreplace" if name == "stderr" else errors
            is_by_line = name == "stderr" or (name == "stdout" and raw.isatty())
            stream = io.TextIOWrapper(raw, encoding or "utf-8", how, line_buffering=is_by_line)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def become(start: dict[str, Any], terminal: str | None) -> NoReturn:
    """Takes on folder, streams, permissions, limits and environment, runs the program and ends as Python does."""
    os.setsid()
    streams = [
        opened_stream(start[name], f"{start['records']}.{name}", terminal, name != "stdin")
        for name in ("stdin", "stdout", "stderr")
    ]
    os.chdir(start["folder"])
    if start["is_deleted"]:
        Path(start["folder"]).rmdir()
    for path, mode in start["modes"]:
        with contextlib.suppress(FileNotFoundError):  # a clip whose place another thing has taken
            Path(path).chmod(mode)
    obey_permissions(ctypes.CDLL(None))
    use_streams(streams)
    for limit, value in start["limits"].items():
        number = getattr(resource, limit)
        resource.setrlimit(number, (value, value))
    argv, environment = start["argv"], start["environment"]
    if start["how"] != "forked":
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        command = [start["script"]] if start["how"] == "script" else [sys.executable, "-m", "ashe_live"]
        os.execve(command[0], [*command, *argv], environment)
    os.environ.clear()
    os.environ.update(environment)
    python_streams(environment)
    sys.argv = [start["script"], *argv]
    sys.path[0:0] = [str(Path(start["script"]).parent)]
    _forget_folder()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os._exit(_status_of(start["script"]))


def _forget_folder() -> None:
    """What the standard library keeps from its import on."""
    process = importlib.import_module("multiprocessing.process")
    try:
        process.ORIGINAL_DIR = str(Path.cwd())  # type: ignore[attr-defined]
    except OSError:
        process.ORIGINAL_DIR = None  # type: ignore[attr-defined]


def _status_of(script: str) -> int:
    """What Python's own end does, without taking its modules apart, which would copy every page."""
    status = 0
    try:
        runpy.run_path(script, run_name="__main__")
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException as error:
        with contextlib.suppress(OSError):
            traceback.print_exc()
        status = 128 + signal.SIGINT if isinstance(error, KeyboardInterrupt) else 1
    with contextlib.suppress(Exception):
        threading._shutdown()  # type: ignore[attr-defined]
    with contextlib.suppress(Exception):
        atexit._run_exitfuncs()
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None and not stream.closed:
                stream.flush()
    except OSError as error:
        with contextlib.suppress(OSError):
            os.write(2, f"Exception ignored at exit: {error}\n".encode())
        status = 120
    return status & 0xFF
