"""The process ends with its own status, whatever its threads are doing."""

import subprocess
import sys

import pytest

from tests.checkout import CHECKOUT
from tests.patience import PATIENCE_S

# A tracker that takes longer than the viewer waits for it: nearly all of the time is spent in OpenCV, without the lock.
IN_OPENCV = """
import threading
import cv2
import numpy as np

def work():
    while True:
        has_begun.set()
        cv2.medianBlur(picture, 5)

picture, has_begun = np.zeros((2000, 2000), np.uint8), threading.Event()
threading.Thread(target=work, daemon=True).start()
has_begun.wait()
"""
# As the cover of a marker's sheet is made, whose window was closed meanwhile.
IN_A_POOL = """
import threading
from concurrent.futures import ThreadPoolExecutor

def work():
    has_begun.set()
    threading.Event().wait()

has_begun = threading.Event()
ThreadPoolExecutor(1).submit(work)
has_begun.wait()
"""
END = """
import atexit
from ashe_live.process.ending import end_process

atexit.register(print, "ended in order", flush=True)
end_process(3)
"""


@pytest.mark.parametrize("before", ["", IN_OPENCV, IN_A_POOL], ids=["alone", "in a library", "in a pool"])
def test_a_thread_at_work_neither_changes_the_status_nor_is_waited_for(before: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", before + END], cwd=CHECKOUT, capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert (done.returncode, done.stdout, done.stderr) == (3, "ended in order\n", "")


@pytest.mark.skipif(sys.version_info >= (3, 14), reason="from then on Python leaves such threads alone")
def test_python_alone_would_abort() -> None:
    """Why the module is there; where this fails, it can go. On a busy machine the thread may just be between calls."""
    command = [sys.executable, "-c", f"{IN_OPENCV}\nraise SystemExit(3)"]
    assert any(subprocess.run(command, capture_output=True).returncode != 3 for _ in range(10))
