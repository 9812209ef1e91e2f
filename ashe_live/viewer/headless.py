"""Playback without a window: all frames in order, waiting for every requested estimate, so that it is reproducible.

Of a clip the first estimate is made before the first picture is drawn, so that a recording is lit from its beginning.
"""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice

from ashe_live.capture.sources import Source
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.output.report import Report
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.scene_tracker import SceneTracker


@dataclass(frozen=True, slots=True)
class HeadlessRun:
    """The content of a run, its length, and who gets the pictures."""

    scene: Callable[[Session], Scene]  # what of the session is shown
    frame_limit: int | None = None
    loop: bool = False
    takers: tuple[Callable[[Image, float], None], ...] = ()  # get each (h, w, 3) uint8 BGR and its time in seconds
    has_alpha: bool = False  # they get BGRA


def play_headless(
    source: Source, tracker: MarkerTracker, session: Session, renderer: SceneRenderer, run: HeadlessRun, report: Report
) -> None:
    """Plays `source` to its end or the limit and fills `report`. Raises UserError as the source does."""
    period_s = 1 / (source.fps or 1.0)
    begin_s = shown_s = 0.0
    scene = SceneTracker(tracker, session.watch.key_views)
    if not (source.is_live or source.is_photo):
        _estimate_ahead(source, scene, session, run, report)
    while run.frame_limit is None or len(report.frames) < run.frame_limit:
        started = time.perf_counter()
        frame = source.read()
        if frame is None:
            if session.settle_for_last(shown_s):
                _finish_estimate(session, report, shown_s)
            if not run.loop:
                break
            source.rewind()
            scene.rewind()
            begin_s = shown_s + period_s
            continue
        tracked = scene.track(frame)
        measured_ms = (time.perf_counter() - started) * 1e3
        shown_s = begin_s + frame.time_s

        scene.keep_view(tracked)
        session.take(tracked, shown_s)
        if session.watch.is_estimating:
            _finish_estimate(session, report, shown_s)
        else:
            session.show_light(shown_s)

        started = time.perf_counter()
        renderer.render(run.scene(session))
        renderer.finish()
        measured_ms += (time.perf_counter() - started) * 1e3
        report.add_frame(tracked, measured_ms)

        if run.takers:
            picture = renderer.read_bgra() if run.has_alpha else renderer.read_bgr()
            for take in run.takers:
                take(picture, shown_s)


def _estimate_ahead(source: Source, scene: SceneTracker, session: Session, run: HeadlessRun, report: Report) -> None:
    """Plays unseen to the frame that the light is estimated in; for the session it all happens at the time 0."""
    with suppress(UserError):  # of a damaged clip, what comes before the damage is played first
        for frame in islice(source, run.frame_limit):
            tracked = scene.track(frame)
            scene.keep_view(tracked)
            session.take(tracked, 0.0)
            run.scene(session)
            if session.watch.is_estimating:
                break
        else:
            session.settle_for_last(0.0)
    if session.watch.is_estimating:
        _finish_estimate(session, report, 0.0)
    source.rewind()
    scene.rewind(keeps_views=True)


def _finish_estimate(session: Session, report: Report, shown_s: float) -> None:
    """Waits for the estimate; one that takes too long is a failure, which the session notes as any other."""
    new = session.wait_for_estimate(shown_s)
    if new is not None:
        report.add_estimate(new.estimate)
