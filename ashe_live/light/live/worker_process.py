"""The light worker's process: makes estimates, one request after the other."""

import os
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from functools import cache, partial
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from ashe_live.errors import UserError
from ashe_live.light.live.worker_messages import (
    Answer,
    Draw,
    Estimated,
    EstimateRequest,
    EstimateTask,
    Followed,
    OtherScene,
    Unchanged,
    WorkerFailure,
)
from ashe_live.process.pipes import receive_value, send_value
from ashe_live.process.unexpected_errors import fault

if TYPE_CHECKING:
    from ashe_live.core.arrays import Image
    from ashe_live.core.light import LightEstimate
    from ashe_live.core.types import TrackedFrame
    from ashe_live.light.estimators.estimator import Estimator
    from ashe_live.light.estimators.preset import ProxyPreset
    from ashe_live.light.live.same_scene import PlanePicture

LOWEST_PRIORITY = 19


def run(connection: Connection, make: "Callable[[ProxyPreset], Estimator]") -> None:
    """Answers each EstimateRequest with an Answer or a WorkerFailure; returns when the connection is closed."""
    import cv2

    # The other cores are left to the viewer's loop.
    cv2.setNumThreads(1)
    estimator_by = cache(make)
    held = HeldViews()
    low_priority = ThreadPoolExecutor(1, "low priority", initializer=_lower_priority)
    # EOFError and BrokenPipeError: the viewer has gone, and no answer is needed.
    with suppress(EOFError, OSError):
        while True:
            request = receive_value(connection)
            held.take(request)
            work = partial(_outcome, estimator_by, held, request.task)
            send_value(connection, work() if request.task.is_awaited else low_priority.submit(work).result())


class HeldViews:
    """The frames of the last request, kept so that none is sent twice, and their pictures of the plane."""

    def __init__(self) -> None:
        self._views: dict[int, TrackedFrame] = {}
        self._planes: dict[int, PlanePicture] = {}
        self._numbers: tuple[int, ...] = ()
        self._doubted: int | None = None
        self._empty: int | None = None

    def take(self, request: EstimateRequest) -> None:
        """Takes the new frames of a request and forgets those that it does not name."""
        self._numbers, self._doubted, self._empty = request.numbers, request.doubted, request.empty
        known = {**self._views, **request.new}
        named = (*self._numbers, *(each for each in (self._doubted, self._empty) if each is not None))
        self._views = {number: known[number] for number in named}
        self._planes = {number: plane for number, plane in self._planes.items() if number in self._views}

    @property
    def frozen(self) -> "TrackedFrame":
        return self._views[self._numbers[0]]

    def frozen_over_empty(self) -> "TrackedFrame":
        """The frozen frame with its clean plate; as it is where the empty table was not seen so."""
        from ashe_live.light.pixels.clean_plate.registration import registered

        plate = None if self._empty is None else registered(self.frozen, self._views[self._empty])
        return self.frozen if plate is None else replace(self.frozen, clean_plate_bgr=plate)

    @property
    def others(self) -> "list[TrackedFrame]":
        return [self._views[number] for number in self._numbers[1:]]

    def outdated(self) -> list[int]:
        """Indices of the others that show another scene than the frozen frame."""
        from ashe_live.light.live.same_scene import outdated

        if len(self._numbers) < 2:
            return []
        now, *before = map(self._plane, self._numbers)
        return outdated(now, before)

    def doubted(self) -> "list[TrackedFrame]":
        """The doubted frame, if it shows the frozen frame's scene."""
        from ashe_live.light.live.same_scene import differs

        if self._doubted is None or differs(self._plane(self._numbers[0]), self._plane(self._doubted)) is not False:
            return []
        return [self._views[self._doubted]]

    def _plane(self, number: int) -> "PlanePicture":
        from ashe_live.light.live.same_scene import PlanePicture

        if number not in self._planes:
            self._planes[number] = PlanePicture.of(self._views[number])
        return self._planes[number]


def _lower_priority() -> None:
    """Puts this thread at the lowest priority, from which there is no way back: on Linux each thread has its own."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), LOWEST_PRIORITY)


def _outcome(
    estimator_by: "Callable[[ProxyPreset], Estimator]", views: HeldViews, task: EstimateTask
) -> Answer | WorkerFailure:
    """The answer, or a failure for any exception, so that the process goes on."""
    try:
        return _answer(estimator_by(task.preset), views, task)
    except UserError as error:
        return WorkerFailure(views.frozen.frame.index, str(error))
    except Exception as error:
        return WorkerFailure(views.frozen.frame.index, fault(error))


def _answer(estimator: "Estimator", views: HeldViews, task: EstimateTask) -> Answer:
    from ashe_live.light.estimators.estimator import shows_nothing
    from ashe_live.light.live.key_views import LEAST_SPAN_RAD, span_of
    from ashe_live.light.views.following import follow, has_lost_shadows

    frozen, others, held = views.frozen, views.others, task.held
    outdated = tuple(views.outdated())
    is_of_changed_scene = len(outdated) == len(others) > 0
    same = [view for place, view in enumerate(others) if place not in outdated]
    if is_of_changed_scene and not task.is_awaited:
        same = views.doubted()
        if not same:
            return OtherScene(outdated=outdated)
    elif held is not None and task.follows and same:
        if held.illumination.real_object is None:  # without a body there is no shadow to look for
            return Unchanged(outdated=outdated)
        if (followed := follow(held, frozen)) is not None:
            return Followed(followed, outdated=outdated)
    apart = same if span_of([frozen, *same]) >= LEAST_SPAN_RAD else []
    made = _made(estimator, views, apart, task.draw)
    is_without_light = is_of_changed_scene and made.estimate.light is None
    return replace(
        made,
        is_of_changed_scene=is_of_changed_scene,
        has_lost_shadows=is_without_light and held is not None and has_lost_shadows(held, frozen),
        shows_empty_table=shows_nothing(made.estimate),
        outdated=outdated,
    )


def _made(estimator: "Estimator", views: HeldViews, others: "Sequence[TrackedFrame]", draw: Draw | None) -> Estimated:
    """The estimate of the frozen frame with the others; without any, over the empty table where that is known."""
    from ashe_live.light.estimators.estimator import OF_ONE_FRAME, shows_nothing

    frozen = views.frozen
    over = frozen if others or estimator.name in OF_ONE_FRAME else views.frozen_over_empty()
    if over is not frozen:
        estimate, picture = _estimated(estimator, over, others, draw)
        if not shows_nothing(estimate):
            return Estimated(estimate, picture, is_over_empty_table=True)
        # Nothing has come onto the table: what stands there stood there before, and the empty table hides it.
    return Estimated(*_estimated(estimator, frozen, others, draw))


def _estimated(
    estimator: "Estimator", frame: "TrackedFrame", others: "Sequence[TrackedFrame]", draw: Draw | None
) -> "tuple[LightEstimate, Image | None]":
    """The estimate of a frame, and the picture of its trace."""
    from ashe_live.light.estimators.estimator import TracingEstimator

    if draw is None or not isinstance(estimator, TracingEstimator):
        return estimator.estimate(frame, others), None
    estimate, trace = estimator.traced(frame, others)
    return estimate, draw(frame, estimate, trace)
