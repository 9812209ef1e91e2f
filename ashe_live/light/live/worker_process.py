"""The light worker's process: makes estimates, one request after the other."""

import os
import sys
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from ashe_live.errors import UserError
from ashe_live.process.pipes import receive_value, send_value
from ashe_live.process.unexpected_errors import fault

if TYPE_CHECKING:
    from ashe_live.core.arrays import Image
    from ashe_live.core.types import LightEstimate, TrackedFrame
    from ashe_live.light.estimators.estimator import Estimator
    from ashe_live.light.estimators.preset import ProxyPreset
    from ashe_live.light.estimators.view_search import Trace
    from ashe_live.light.live.same_scene import PlanePicture

Draw = Callable[["TrackedFrame", "LightEstimate", "Trace"], "Image"]  # a picture (h, w, 3), BGR, of an estimate's trace


LOWEST_PRIORITY = 19


@dataclass(frozen=True, slots=True)
class Request:
    """What the process is asked, with the frames that it has not been sent before."""

    numbers: tuple[int, ...]  # of the frozen frame, then of the other views, which are kept for the next request
    doubted: int | None  # of a frame that showed a scene which none of the other views shows
    new: "Mapping[int, TrackedFrame]"
    preset: "ProxyPreset"
    draw: Draw | None = None  # what draws the trace
    is_awaited: bool = False  # by a person
    held: "LightEstimate | None" = None  # the answer that is shown
    # Whether nothing is to be estimated if the frame shows the other views' scene in the light of that answer.
    follows: bool = False


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to a request."""

    estimate: "LightEstimate | None"  # None: what is shown still holds, or no other frame shows this scene
    picture_bgr: "Image | None" = None  # of the trace; None where none was asked for, or the estimator keeps no trace
    outdated: tuple[int, ...] = ()  # indices of the other views that show another scene, and were left out
    is_followed: bool = False  # whether the estimate is the held one with its lights moved to what the frame shows
    # Whether there is no light in a changed scene, and the shadows of the held answer's lights are gone from it.
    has_lost_shadows: bool = False


@dataclass(frozen=True, slots=True)
class WorkerFailure:
    """Why a request got no estimate."""

    frame_index: int
    message: str  # one line, for the user


def run(connection: Connection, make: "Callable[[ProxyPreset], Estimator]") -> None:
    """Answers each Request with an Answer or a WorkerFailure; returns when the connection is closed."""
    import cv2

    # The other cores are left to the viewer's loop.
    cv2.setNumThreads(1)
    estimator_by = cache(make)
    held = HeldViews()
    patient = ThreadPoolExecutor(1, "patient", initializer=_give_way)
    # EOFError and BrokenPipeError: the viewer has gone, and no answer is needed.
    with suppress(EOFError, OSError):
        while True:
            request = receive_value(connection)
            held.take(request)
            work = partial(_answer, estimator_by, held, request)
            send_value(connection, work() if request.is_awaited else patient.submit(work).result())


class HeldViews:
    """The frames of the last request, kept so that none is sent twice, and their pictures of the plane."""

    def __init__(self) -> None:
        self._views: dict[int, TrackedFrame] = {}
        self._planes: dict[int, PlanePicture] = {}
        self._numbers: tuple[int, ...] = ()
        self._doubted: int | None = None

    def take(self, request: Request) -> None:
        """Takes the new frames of a request and forgets those that it does not name."""
        self._numbers, self._doubted = request.numbers, request.doubted
        known = {**self._views, **request.new}
        named = self._numbers if self._doubted is None else (*self._numbers, self._doubted)
        self._views = {number: known[number] for number in named}
        self._planes = {number: plane for number, plane in self._planes.items() if number in self._views}

    @property
    def frozen(self) -> "TrackedFrame":
        return self._views[self._numbers[0]]

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


def _give_way() -> None:
    """Puts this thread at the lowest priority, from which there is no way back: on Linux each thread has its own."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), LOWEST_PRIORITY)


def _answer(
    estimator_by: "Callable[[ProxyPreset], Estimator]", held: HeldViews, request: Request
) -> Answer | WorkerFailure:
    """The estimate, or a failure for any exception, so that the process goes on."""
    from ashe_live.light.estimators.estimator import TracingEstimator
    from ashe_live.light.live.key_views import LEAST_SPAN_RAD, span_of
    from ashe_live.light.views.following import follow, has_lost_shadows

    frozen, others = held.frozen, held.others
    try:
        estimator = estimator_by(request.preset)
        gone = tuple(held.outdated())
        has_changed = len(gone) == len(others) > 0
        same: list[TrackedFrame] = [view for place, view in enumerate(others) if place not in gone]
        if others and not same and not request.is_awaited:
            same = held.doubted()
            if not same:
                return Answer(None, None, gone)  # something may be passing before the camera
        elif request.held is not None and request.follows and same:
            if request.held.illumination.real_object is None:  # without a body there is no shadow to look for
                return Answer(None, None, gone)
            if (followed := follow(request.held, frozen)) is not None:
                return Answer(followed, None, gone, is_followed=True)
        others = same if span_of([frozen, *same]) >= LEAST_SPAN_RAD else []
        picture = None
        if request.draw is not None and isinstance(estimator, TracingEstimator):
            estimate, trace = estimator.traced(frozen, others)
            picture = request.draw(frozen, estimate, trace)
        else:
            estimate = estimator.estimate(frozen, others)
        may_be_out = has_changed and estimate.light is None
        is_out = may_be_out and request.held is not None and has_lost_shadows(request.held, frozen)
        return Answer(estimate, picture, gone, has_lost_shadows=is_out)
    except UserError as error:
        return WorkerFailure(frozen.frame.index, str(error))
    except Exception as error:
        return WorkerFailure(frozen.frame.index, fault(error))
