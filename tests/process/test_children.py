"""Child processes: nothing of the current folder runs in them, they end with their parent, and they have limits."""

import multiprocessing
import os
import signal
import subprocess
import sys
import sysconfig
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from multiprocessing import spawn
from multiprocessing.connection import Connection, wait
from pathlib import Path

import pytest

from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.process import awake, isolated
from ashe_live.process.children import Limits, safe_module_path, started
from ashe_live.process.isolated import NoAnswerError, _Alarm, isolated_call
from tests.checkout import CHECKOUT
from tests.patience import PATIENCE_S, await_that

FREE = Limits(niceness=0)
POSIX_ONLY = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limits")
# As it is installed: with `-m`, or `-c`, Python itself looks into the current folder first.
COMMAND = Path(sysconfig.get_path("scripts")) / "ashe-live"
# Modules that a child needs early or late, and this package itself.
NAMES = (
    "pickle",
    "signal",
    "selectors",
    "struct",
    "socket",
    "numpy",
    "cv2",
    "moderngl",
    "ctypes",
    "ashe_live",
)
TILE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


@pytest.fixture
def trapped(tmp_path: Path) -> Path:
    """A folder with modules that leave a file behind when they are run."""
    for name in NAMES:
        (tmp_path / f"{name}.py").write_text(f"open(__file__ + '.ran', 'w').close()\nraise SystemExit('{name} ran')\n")
    (tmp_path / "a.obj").write_text(TILE)
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (("play", str(resource("assets", "clips", "table.mp4")), "--headless", "--frames", "2", "--model", "a.obj"), 0),
        # Loads glfw, which looks for its library in a process of its own.
        (("doctor",), 2),
        (("marker", "--show"), 2),
    ],
)
def test_no_code_of_the_current_folder_runs(trapped: Path, arguments: tuple[str, ...], status: int) -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment["DISPLAY"] = ":there-is-none"
    done = subprocess.run([COMMAND, *arguments], cwd=trapped, env=environment, capture_output=True, text=True)
    assert not list(trapped.glob("*.ran"))
    assert done.returncode == status, done


@pytest.mark.skipif(sys.platform != "linux", reason="its dynamic linker, and OpenGL by EGL")
def test_no_library_of_the_current_folder_is_loaded(tmp_path: Path) -> None:
    """OpenCV leaves an empty entry, which is that folder, in the linker's path of all child processes."""
    (tmp_path / "libEGL.so.1").write_text("no library")
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "LD_LIBRARY_PATH")}
    done = subprocess.run([COMMAND, "doctor"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert "works          offscreen pictures" in done.stdout, done


@pytest.mark.parametrize(("before", "inside"), [(None, os.devnull), ("/a::/b:", "/a:/b"), ("", os.devnull)])
def test_a_childs_library_path_is_without_the_current_folder(monkeypatch, before, inside):
    if before is None:
        monkeypatch.delenv("LD_LIBRARY_PATH", raising=False)
    else:
        monkeypatch.setenv("LD_LIBRARY_PATH", before)
    assert isolated_call(os.getenv, ("LD_LIBRARY_PATH",), "test", FREE, PATIENCE_S) == inside


def test_the_module_path_is_without_the_current_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = list(sys.path)
    for entry in ("", ".", str(tmp_path), "not there"):
        monkeypatch.syspath_prepend(entry)
    assert safe_module_path() == ["not there", *(entry for entry in before if entry)]


def test_the_current_folder_stays_where_the_package_lies(monkeypatch):
    home = next(entry for entry in sys.path if (Path(entry) / "ashe_live").is_dir())
    monkeypatch.chdir(home)
    assert home in safe_module_path()


def test_it_starts_where_the_current_folder_was_deleted(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert isolated_call(os.getpid, (), "test", FREE, PATIENCE_S) != os.getpid()


def test_a_program_that_does_not_guard_its_main_script_can_start_one(tmp_path):
    script = tmp_path / "unguarded.py"
    script.write_text(
        "import os\nfrom ashe_live.process.isolated import isolated_call\n"
        "from ashe_live.process.children import Limits\n"
        f"print(isolated_call(os.getpid, (), 'test', Limits(niceness=0), {PATIENCE_S}) != os.getpid())\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True\n", "")


def test_nothing_is_left_behind_in_the_parents_environment():
    before, path, prepare = dict(os.environ), list(sys.path), spawn.get_preparation_data
    isolated_call(os.getpid, (), "test", FREE, PATIENCE_S)
    assert dict(os.environ) == before
    assert spawn.get_preparation_data is prepare, "what other processes are sent is their own affair"
    assert sys.path == path
    assert not [child for child in multiprocessing.active_children() if child.name == "test"]


def test_what_is_wrong_is_said_from_there():
    with pytest.raises(UserError, match="it is broken: mend it"):
        isolated_call(_broken, (), "test", FREE, PATIENCE_S)
    with pytest.raises(NoAnswerError, match=r"^ZeroDivisionError: "):
        isolated_call(divmod, (1, 0), "test", FREE, PATIENCE_S)
    with pytest.raises(NoAnswerError, match="ended with status 9"):
        isolated_call(os._exit, (9,), "test", FREE, PATIENCE_S)


def _broken() -> None:
    raise UserError("it is broken", "mend it")


def test_one_that_does_not_answer_is_killed():
    with pytest.raises(NoAnswerError, match=r"within 0\.5 s"):
        isolated_call(time.sleep, (PATIENCE_S,), "test", FREE, 0.5)
    assert not [child for child in multiprocessing.active_children() if child.name == "test"]


def test_who_stops_an_alarm_waits_until_it_rings_no_more():
    """Else it might kill a process of which nobody knows any more."""
    rings, goes_on, done = threading.Event(), threading.Event(), []

    def ring() -> None:
        rings.set()
        assert goes_on.wait(PATIENCE_S)
        done.append(True)

    alarm = _Alarm(0.0, ring)
    assert rings.wait(PATIENCE_S)
    stopping = threading.Thread(target=lambda: (alarm.stop(), done.append("stopped")))
    stopping.start()
    await_that(alarm._stopped.is_set)
    goes_on.set()
    stopping.join(PATIENCE_S)
    assert done == [True, "stopped"]
    assert alarm.has_rung
    quiet = _Alarm(PATIENCE_S, ring)
    quiet.stop()
    assert not quiet.has_rung


def test_one_is_not_killed_because_all_was_suspended_for_hours(monkeypatch):
    hours = count()
    monkeypatch.setattr(awake, "now_s", lambda: 3600.0 * next(hours))  # at every look another one is over
    assert isolated_call(os.getpid, (), "test", FREE, PATIENCE_S) != os.getpid()


def test_one_that_stops_in_the_middle_of_its_answer_is_killed(tmp_path, monkeypatch):
    """However long it takes to begin: time stands still until then."""
    begun = tmp_path / "begun"
    monkeypatch.setattr(awake, "now_s", lambda: time.monotonic() if begun.exists() else 0.0)
    with pytest.raises(NoAnswerError, match=r"within 1 s"):
        isolated_call(_stop_while_answering, (begun,), "test", FREE, 1)
    assert not [child for child in multiprocessing.active_children() if child.name == "test"]


def _stop_while_answering(begun: Path) -> None:
    def send_half(connection: Connection, _value: object) -> None:
        connection.send((1, b"its one buffer never comes"))
        begun.touch()
        time.sleep(PATIENCE_S)

    isolated.send_value = send_half


@POSIX_ONLY
def test_it_takes_so_much_processor_time_and_no_more():
    with pytest.raises(NoAnswerError, match="more than 1 s of processor time"):
        isolated_call(sum, (range(10**12),), "test", Limits(niceness=0, processor_s=1), PATIENCE_S)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not hold a process to it")
def test_it_takes_so_much_memory_and_no_more():
    limits = Limits(niceness=0, memory_bytes=500_000_000)
    assert len(isolated_call(bytes, (100_000_000,), "test", limits, PATIENCE_S)) == 100_000_000
    with pytest.raises(NoAnswerError, match="out of memory"):
        isolated_call(bytes, (500_000_000,), "test", limits, PATIENCE_S)


@POSIX_ONLY
def test_it_has_the_niceness_that_is_asked_for_and_leaves_no_picture_of_its_memory_behind():
    import resource

    assert isolated_call(os.nice, (0,), "test", Limits(niceness=3), PATIENCE_S) == min(19, os.nice(0) + 3)
    soft, _ = isolated_call(resource.getrlimit, (resource.RLIMIT_CORE,), "test", FREE, PATIENCE_S)
    assert soft == 0


@pytest.mark.parametrize("by_the_user", ["", "3"])
def test_it_takes_one_core_for_arithmetic_unless_the_user_says_otherwise(monkeypatch, by_the_user):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", by_the_user)
    given = isolated_call(os.getenv, ("OPENBLAS_NUM_THREADS",), "test", FREE, PATIENCE_S)
    assert given == (by_the_user or "1")
    assert os.environ["OPENBLAS_NUM_THREADS"] == by_the_user


def test_what_it_prints_can_be_silenced(capfd):
    isolated_call(os.write, (2, b"seen"), "test", FREE, PATIENCE_S)
    isolated_call(os.write, (2, b"unseen"), "test", Limits(niceness=0, silent=True), PATIENCE_S)
    assert capfd.readouterr().err == "seen"


def test_ctrl_c_does_not_reach_it_from_its_first_moment():
    near, far = multiprocessing.Pipe()
    process = started(_tell_and_wait, (), "test", FREE, far)
    assert process.pid is not None
    while not near.poll(0.001):
        os.kill(process.pid, signal.SIGINT)
    os.kill(process.pid, signal.SIGINT)
    near.recv()
    near.send("end")
    process.join(PATIENCE_S)
    assert process.exitcode == 0


def _tell_and_wait(far_end: Connection) -> None:
    far_end.send(os.getpid())
    far_end.recv()


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere it has nothing to do with threads")
def test_it_outlives_the_thread_that_asked_for_it():
    near, far = multiprocessing.Pipe()
    with ThreadPoolExecutor(1) as short_lived:
        process = short_lived.submit(started, _tell_and_wait, (), "test", FREE, far).result()
        near.recv()
    near.send("end")
    process.join(PATIENCE_S)
    assert process.exitcode == 0


PARENT = """
import multiprocessing, os, signal, sys
from multiprocessing.connection import Connection
from ashe_live.process.children import Limits, started
import tests.process.test_children as here
near, far = multiprocessing.Pipe()
started(here._hold_the_lock, (Connection(int(sys.argv[1])),), "test", Limits(niceness=0), far)
near.recv()
os.kill(os.getpid(), signal.SIGKILL)
"""


def _hold_the_lock(far_end: Connection, _alive: Connection) -> None:
    """In C, where no other thread of Python's can run."""
    far_end.send("ready")
    10 ** (10**9)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere such a child ends as soon as it lets go of the lock")
def test_it_ends_with_a_parent_that_is_killed_even_while_it_computes():
    """The pipe that the child inherits, and nobody else keeps open, ends when the child does."""
    reader, writer = os.pipe()
    os.set_inheritable(writer, True)
    parent = subprocess.Popen([sys.executable, "-c", PARENT, str(writer)], pass_fds=[writer], cwd=CHECKOUT)
    os.close(writer)
    assert parent.wait(PATIENCE_S) == -signal.SIGKILL
    assert wait([reader], PATIENCE_S)
    assert os.read(reader, 1) == b""
    os.close(reader)


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_a_worker_of_a_pool_may_start_one(method: str) -> None:
    """It is a daemon, which otherwise has no children: `Pool` is how a program looks at many photos at once."""
    with multiprocessing.get_context(method).Pool(1) as pool:
        worker = pool.apply(os.getpid)
        child = pool.apply_async(isolated_call, (os.getpid, (), "asked", FREE, PATIENCE_S)).get(PATIENCE_S)
        assert child not in (worker, os.getpid())
        assert pool.apply(_is_daemon), "all else is as it was"


def _is_daemon() -> bool:
    return multiprocessing.current_process().daemon
