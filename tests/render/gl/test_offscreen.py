"""The count of OpenGL objects that a process holds."""

import subprocess
import sys

# In a process of its own, as this one may hold so many objects that others have their turn meanwhile.
COUNTED_WHILE_TUPLES_ARE_FILLED = """
import sys, threading
import numpy as np
from ashe_live.render.gl.offscreen import live_gl_objects

failures, is_over, ones, usual_s = [], threading.Event(), np.ones(300), sys.getswitchinterval()

def fill():
    while not is_over.is_set():
        try:
            tuple(ones.copy() for _ in range(50))
        except SystemError as failure:
            failures.append(failure)

threads = [threading.Thread(target=fill) for _ in range(2)]
for thread in threads:
    thread.start()
for _ in range(30):
    live_gl_objects()
is_over.set()
for thread in threads:
    thread.join()
print(len(failures), sys.getswitchinterval() == usual_s)
"""


def test_objects_are_counted_while_other_threads_fill_tuples() -> None:
    """CPython cannot enlarge a tuple that the garbage collector's list of all objects holds, too."""
    ended = subprocess.run(
        [sys.executable, "-c", COUNTED_WHILE_TUPLES_ARE_FILLED], capture_output=True, text=True, check=True
    )
    assert ended.stdout.split() == ["0", "True"]
