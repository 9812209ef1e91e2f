"""Keeps OpenCV's thread pool from competing with the renderer for the processor's cores."""

import cv2


def leave_cores_to_renderer() -> None:
    """Keeps OpenCV's own threads asleep in this process.

    After each parallel call they spin for a while and wait for the next one: on two cores that doubled the processor
    time of a frame at 640x480, took the cores from the capture thread and from a software rasteriser, and made
    nothing faster, 1440x1080 included (CHANGELOG.md).
    """
    cv2.setNumThreads(1)
