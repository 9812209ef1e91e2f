"""A process that has loaded the program already and forks for each start of it: a tenth of what a fresh start costs.

Run as a script with the number of a connected socket; a line of JSON asks, a line of JSON answers. It imports nothing
of the tests, and is what all started processes descend from: whoever loses its parent becomes its child, so that nobody
survives unseen.
"""

import contextlib
import ctypes
import gc
import importlib
import json
import os
import pkgutil
import resource
import select
import signal
import socket
import sys
import time
import traceback
from pathlib import Path
from typing import Any

from started import become

PR_SET_CHILD_SUBREAPER = 36
WATCH_EVERY_S = 0.25
COULD_NOT_PREPARE = 97
STOPPED_AT_BYTES = 4 << 30  # twice of what is allowed: before the machine suffers


def load_program() -> None:
    """All its modules, as they are loaded lazily otherwise; but nothing that has threads or a graphics context."""
    package = importlib.import_module("ashe_live")
    # What the program sets before it loads libraries, as some read it then.
    os.environ.update(importlib.import_module("ashe_live.cli").ENVIRONMENT)
    for module in pkgutil.walk_packages(package.__path__, "ashe_live."):
        if not module.name.startswith(("ashe_live.bench", "ashe_live.__main__")):
            importlib.import_module(module.name)
    gc.collect()
    gc.freeze()  # pages that no collection touches stay shared


class Server:
    """Runs one case at a time."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
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
        survivors = _survivors(asked["survives_for_s"])
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
                become(start, terminal)
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


def _survivors(for_s: float) -> list[str]:
    """Command lines of those that are still there so long after all ended; they are ended then."""
    deadline = time.monotonic() + for_s
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
    Server(socket.socket(fileno=int(sys.argv[1]))).serve()
