"""The count of OpenGL objects that a process holds."""

import threading

import numpy as np

from ashe_live.render.gl.offscreen import live_gl_objects


def test_objects_are_counted_while_other_threads_fill_tuples(ctx) -> None:
    """CPython cannot enlarge a tuple that a list of all objects holds, too."""
    failures: list[SystemError] = []
    is_over, ones = threading.Event(), np.ones(300)

    def fill() -> None:
        while not is_over.is_set():
            try:
                tuple(ones.copy() for _ in range(50))
            except SystemError as failure:
                failures.append(failure)

    threads = [threading.Thread(target=fill) for _ in range(2)]
    before = live_gl_objects()
    held = [ctx.buffer(reserve=4), ctx.texture((4, 4), 4), ctx.renderbuffer((4, 4))]
    for thread in threads:
        thread.start()
    try:
        counts = {live_gl_objects() for _ in range(50)}
    finally:
        is_over.set()
        for thread in threads:
            thread.join()
    assert not failures
    assert counts == {before + len(held)}
    for thing in held:
        thing.release()
