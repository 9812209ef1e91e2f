"""A process that has loaded the program already and forks for each start of it: a tenth of what a fresh start costs.

Run as a script with the number of a connected socket and the program's script; a line of JSON asks, a line of JSON answers. It imports nothing of
the tests, and is what all started processes descend from: whoever loses its parent becomes its child, so that nobody
survives unseen.
"""

import atexit
import contextlib
import ctypes
import gc
import importlib
import io
import json
import os
import pkgutil
import resource
import runpy
import select
import signal
import socket
import sys
import threading
import time
import traceback
from pathlib import Path
from typing import Any, NoReturn

PR_SET_CHILD_SUBREAPER, PR_CAPBSET_DROP = 36, 24
# A superuser for whom permissions hold: capabilities 1 and 2 are those that ignore them.
IGNORES_PERMISSIONS = (1, 2)
CAPABILITY_VERSION_3 = 0x20080522
SURVIVES_FOR_S = 3.0  # children notice that their parent has ended; under load that takes a while
WATCH_EVERY_S = 0.25
COULD_NOT_PREPARE = 97
STOPPED_AT_BYTES = 4 << 30  # twice of what is allowed: before the machine suffers


def load_program() -> None:
    """All its modules, as they are loaded lazily otherwise; but nothing that has threads or a graphics context."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    package = importlib.import_module("ashe_live")
    for module in pkgutil.walk_packages(package.__path__, "ashe_live."):
        if not module.name.startswith(("ashe_live.bench", "ashe_live.__main__")):
            importlib.import_module(module.name)
    gc.collect()
    gc.freeze()  # pages that no collection touches stay shared


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
            raw = open(at, mode, closefd=False)  # noqa: PTH123, SIM115
            how = "backslashreplace" if name == "stderr" else errors
            is_by_line = name == "stderr" or (name == "stdout" and raw.isatty())
            stream = io.TextIOWrapper(raw, encoding or "utf-8", how, line_buffering=is_by_line)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def become(start: dict[str, Any], script: str, terminal: str | None) -> NoReturn:
    """In the forked child: takes on folder, streams, limits and environment, runs the program and ends as Python does."""
    os.setsid()
    streams = [
        opened_stream(start[name], f"{start['records']}.{name}", terminal, name != "stdin")
        for name in ("stdin", "stdout", "stderr")
    ]
    os.chdir(start["folder"])
    if start["is_deleted"]:
        os.rmdir(start["folder"])
    for path, mode in start["modes"]:
        with contextlib.suppress(FileNotFoundError):  # a clip whose place another thing has taken
            os.chmod(path, mode)
    obey_permissions(ctypes.CDLL(None))
    use_streams(streams)
    for limit, value in start["limits"].items():
        number = getattr(resource, limit)
        resource.setrlimit(number, (value, value))
    argv, environment = start["argv"], start["environment"]
    if start["how"] != "forked":
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        command = [script] if start["how"] == "script" else [sys.executable, "-m", "ashe_live"]
        os.execve(command[0], [*command, *argv], environment)
    os.environ.clear()
    os.environ.update(environment)
    python_streams(environment)
    sys.argv = [script, *argv]
    sys.path[0:0] = [str(Path(script).parent)]
    _forget_folder()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os._exit(_status_of(script))


def _forget_folder() -> None:
    """What the standard library keeps from its import on."""
    process = importlib.import_module("multiprocessing.process")
    try:
        process.ORIGINAL_DIR = os.getcwd()  # type: ignore[attr-defined]
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


class Server:
    """Runs one case at a time."""

    def __init__(self, connection: socket.socket, script: str) -> None:
        self._connection, self._script = connection, script
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        self._listener.setblocking(False)
        self._connections = 0
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        # As a program finds them that is started by hand, whatever those ignore who run the tests; until it begins, a
        # signal simply ends it.
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)

    def serve(self) -> None:
        with self._connection.makefile("rw", encoding="ascii") as lines:
            lines.write(json.dumps({"port": self._listener.getsockname()[1]}) + "\n")
            lines.flush()
            for line in lines:
                lines.write(json.dumps(self.run(json.loads(line))) + "\n")
                lines.flush()

    def run(self, asked: dict[str, Any]) -> dict[str, Any]:
        """Starts what is asked for, each in its time; sends the signals; says how all of it ended."""
        master, terminal = None, None
        if any("terminal" in (start["stdout"], start["stderr"], start["stdin"]) for start in asked["starts"]):
            master, slave = os.openpty()
            terminal = os.ttyname(slave)
        begun, self._connections = time.monotonic(), 0
        starts = sorted(((start["after_s"], at) for at, start in enumerate(asked["starts"])), reverse=True)
        signals = sorted(((after_s, number, group) for after_s, number, group in asked["signals"]), reverse=True)
        pids: dict[int, int] = {}
        ended: dict[int, dict[str, Any]] = {}
        shown = bytearray()
        hangs, largest = False, 0
        while starts or len(ended) < len(asked["starts"]):
            now = time.monotonic() - begun
            while starts and starts[-1][0] <= now:
                at = starts.pop()[1]
                pids[self._start(asked["starts"][at], terminal)] = at
            first = next((pid for pid, at in pids.items() if at == 0), None)
            while signals and signals[-1][0] <= now:
                _, number, group = signals.pop()
                if first is not None and 0 not in ended:
                    with contextlib.suppress(ProcessLookupError):
                        (os.killpg if group else os.kill)(first, number)
            living = [pid for pid, at in pids.items() if at not in ended]
            due = [moment for moment, *_ in (*starts[-1:], *signals[-1:])]
            self._await_change(living, master, shown, min([WATCH_EVERY_S, *(max(0.0, at - now) for at in due)]))
            for pid, at in pids.items():
                if at not in ended and (how := _ended(pid)) is not None:
                    ended[at] = {**how, "wall_s": time.monotonic() - begun - asked["starts"][at]["after_s"]}
            largest = max([largest, *(_resident(pid) for pid in living)])
            if now > asked["within_s"] or largest > STOPPED_AT_BYTES:
                hangs = hangs or now > asked["within_s"]
                for pid in living:
                    for each in (*_descendants(pid), pid):
                        with contextlib.suppress(ProcessLookupError):
                            os.kill(each, signal.SIGKILL)
        survivors = _survivors()
        self._hang_up()
        if master is not None:
            _drain(master, shown)
            os.close(master)
            os.close(slave)
        return {
            "ended": [ended[at] for at in range(len(ended))],
            "hangs": hangs,
            "survivors": survivors,
            "connections": self._connections,
            "shown": shown.decode("latin-1"),
            "largest_bytes": max([largest, *(how["largest_bytes"] for how in ended.values())]),
        }

    def _start(self, start: dict[str, Any], terminal: str | None) -> int:
        pid = os.fork()
        if pid == 0:
            try:
                become(start, self._script, terminal)
            except BaseException:
                with contextlib.suppress(OSError):
                    Path(f"{start['records']}.harness").write_text(traceback.format_exc())
            finally:
                os._exit(COULD_NOT_PREPARE)
        return pid

    def _await_change(self, living: list[int], master: int | None, shown: bytearray, at_most_s: float) -> None:
        """Until one of the processes ends or calls, the terminal has something, or the time is over."""
        watched = []
        for pid in living:
            with contextlib.suppress(OSError):
                watched.append(os.pidfd_open(pid))
        others = [self._listener.fileno(), *([] if master is None else [master])]
        ready, _, _ = select.select([*watched, *others], [], [], at_most_s)
        self._hang_up()
        if master is not None and master in ready:
            _drain(master, shown)
        for descriptor in watched:
            os.close(descriptor)

    def _hang_up(self) -> None:
        """Counts who calls, and lets nobody wait."""
        with contextlib.suppress(BlockingIOError):
            while True:
                self._listener.accept()[0].close()
                self._connections += 1


def _ended(pid: int) -> dict[str, Any] | None:
    try:
        done, status, used = os.wait4(pid, os.WNOHANG)
    except ChildProcessError:
        return {"status": None, "cpu_s": 0.0, "largest_bytes": 0}
    if not done:
        return None
    return {
        "status": os.waitstatus_to_exitcode(status),
        "cpu_s": used.ru_utime + used.ru_stime,
        "largest_bytes": used.ru_maxrss * 1024,
    }


def _drain(master: int, shown: bytearray) -> None:
    with contextlib.suppress(OSError):
        while select.select([master], [], [], 0)[0]:
            shown += os.read(master, 65536)


def _survivors() -> list[str]:
    """Command lines of those that are still there a while after all ended; they are ended then."""
    deadline = time.monotonic() + SURVIVES_FOR_S
    while time.monotonic() < deadline:
        try:
            if os.waitpid(-1, os.WNOHANG) == (0, 0):
                time.sleep(0.002)
        except ChildProcessError:
            return []
    left = _descendants(os.getpid())
    named = [Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode("latin-1") for pid in left]
    for pid in left:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    with contextlib.suppress(ChildProcessError):
        while True:
            os.waitpid(-1, 0)
    return named


def _descendants(pid: int) -> list[int]:
    """Of all generations, the youngest first."""
    found = []
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            for child in map(int, (task / "children").read_text().split()):
                found += [*_descendants(child), child]
    return found


def _resident(pid: int) -> int:
    """Bytes of the largest one among a process and its descendants."""
    sizes = [0]
    for each in (pid, *_descendants(pid)):
        with contextlib.suppress(OSError, IndexError):
            sizes.append(int(Path(f"/proc/{each}/statm").read_text().split()[1]) * resource.getpagesize())
    return max(sizes)


if __name__ == "__main__":
    del sys.path[0]  # this folder: nobody is to import from it
    load_program()
    Server(socket.socket(fileno=int(sys.argv[1])), sys.argv[2]).serve()
