"""Stand-ins for what the viewer is made of, so that its own logic is tested without camera, estimator or OpenGL."""

import math
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from ashe_live.capture.sources import Source, SourceLost
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.live.worker import Outcome
from ashe_live.light.live.worker_messages import Estimated, EstimateTask, Followed, OtherScene, Unchanged, WorkerFailure
from ashe_live.models.mesh import Model
from ashe_live.models.placement import UNMOVED, Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from tests.viewer.scripted_session import ScriptedSession

SIZE = (64, 48)
SIDE_M = 0.08
CAMERA = Camera.from_hfov(SIZE, 60)
MODEL = placed_on_marker(Model("box", (box((1, 1, 1)),), up="y"), SIDE_M)  # as of a shipped file


def pose(tilt_deg: float = 0.0) -> MarkerPose:
    """Seen from straight above, or from `tilt_deg` aside."""
    tilt = math.radians(tilt_deg)
    across = np.array([[1, 0, 0], [0, math.cos(tilt), -math.sin(tilt)], [0, math.sin(tilt), math.cos(tilt)]])
    T_cam_marker = rigid(across @ np.diag((1.0, -1.0, -1.0)), (0, 0, 0.4))
    half = SIDE_M / 2
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    return MarkerPose(T_cam_marker, project(CAMERA, T_cam_marker, square), SIDE_M, 0.25, None)


def tracked(index: int = 0, has_marker: bool = True, fps: float = 30.0, tilt_deg: float = 0.0) -> TrackedFrame:
    frame = Frame(np.full((SIZE[1], SIZE[0], 3), 90, np.uint8), index, index / fps)
    return TrackedFrame(frame, CAMERA, pose(tilt_deg) if has_marker else None, 1.0)


class FakeSource(Source):
    """`count` grey frames. `hook(index)` runs before each read and may wait or raise; `returns` answers reopen."""

    def __init__(self, count: int = 5, fps: float | None = 200.0, is_live: bool = False, is_photo: bool = False):
        self.name, self.size, self.fps = "fake", SIZE, fps
        self.is_live, self.is_photo = is_live, is_photo
        self.note: str | None = None
        self.hook: Callable[[int], None] = lambda _index: None
        self.returns: list[bool] = []
        self.rewinds = self.reads = 0
        self.closed = threading.Event()
        self._count = count
        self._index = 0

    def read(self) -> Frame | None:
        self.reads += 1
        self.hook(self._index)
        if self._index >= self._count:
            return None
        self._index += 1
        return Frame(np.zeros((SIZE[1], SIZE[0], 3), np.uint8), self._index - 1, (self._index - 1) / (self.fps or 1))

    def rewind(self) -> None:
        self.rewinds += 1
        self._index = 0

    def reopen(self) -> bool:
        return self.returns.pop(0) if self.returns else False

    def close(self) -> None:
        self.closed.set()


class FakeClip(FakeSource):
    """A source in which one can go to and fro. `sought` has where to."""

    def __init__(self, count: int = 5, fps: float = 200.0) -> None:
        super().__init__(count, fps)
        self.path = Path("clip.mp4")
        self.duration_s = (count - 1) / fps
        self.sought: list[int] = []

    def seek(self, time_s: float) -> None:
        self.seek_frame(min(round(time_s * self.fps), self._count - 1))

    def seek_frame(self, index: int) -> None:
        self.sought.append(index)
        self._index = index

    def pass_over(self, is_shown: Callable[[float], bool]) -> bool:
        if self._index >= self._count - 1 or is_shown(self._index / self.fps):
            return False
        self._index += 1
        return True


class FakeTracker:
    """Finds the marker in every frame. `hook(frame)` runs first."""

    preset: object = None
    note: str | None = None
    marker = parse_marker("aruco:4x4_50:0")

    def __init__(self) -> None:
        self.resets = self.jumps = 0
        self.hook: Callable[[Frame], None] = lambda _frame: None

    def track(self, frame: Frame) -> TrackedFrame:
        self.hook(frame)
        return TrackedFrame(frame, CAMERA, pose(), 1.0, self.note)

    def reset(self) -> None:
        self.resets += 1

    def jump(self) -> None:
        self.jumps += 1


class FakeWorker:
    """Takes one request, and answers it when `answer` is set."""

    def __init__(self) -> None:
        self.requested: list[TrackedFrame] = []
        self.answer: LightEstimate | WorkerFailure | None = None
        self.picture: Image | None = None  # goes with an answer that it was asked for with
        self.outdated: tuple[int, ...] = ()  # goes with the next answer
        self.known: list[LightEstimate | None] = []  # of the requests: what is only to be followed
        self.follows = False  # what is known is answered with `answer`
        self.shows_empty_table = self.is_over_empty_table = False  # what the next estimates say
        self.busy = self.draws = self.takes_one_frame = False
        self.waited_s = 0.0

    def request(
        self,
        frozen: TrackedFrame,
        others: tuple[TrackedFrame, ...],
        doubted: TrackedFrame | None,
        task: EstimateTask,
        empty: TrackedFrame | None = None,
    ) -> bool:
        if self.busy:
            return False
        self.empty = empty
        self.busy, self.draws, self.is_awaited = True, task.draw is not None, task.is_awaited
        self.requested.append(frozen)
        self.others, self.doubted = others, doubted
        self.known.append(task.held if task.follows else None)
        return True

    def wait(self, _timeout_s: float) -> Outcome | None:
        if not self.busy or self.answer is None:
            return None
        self.busy = False
        answer, self.answer = self.answer, None
        if isinstance(answer, WorkerFailure):
            return answer
        outdated, self.outdated = self.outdated, ()
        has_changed = len(outdated) == len(self.others) > 0
        if has_changed and not self.is_awaited and self.doubted is None:
            return OtherScene(outdated=outdated)
        if self.known[-1] is not None and len(outdated) < len(self.others):
            return Followed(answer, outdated=outdated) if self.follows else Unchanged()
        return Estimated(
            answer,
            self.picture if self.draws else None,
            has_changed,
            shows_empty_table=self.shows_empty_table,
            is_over_empty_table=self.is_over_empty_table,
            outdated=outdated,
        )

    def give_up(self) -> None:
        self.busy, self.answer = False, None


class FakeKeyViews:
    """The frames that it is made of, but for those that are dropped."""

    def __init__(self, *views: TrackedFrame) -> None:
        self.views = views

    def drop(self, views: Sequence[TrackedFrame] | None = None) -> None:
        self.views = tuple(
            each for each in self.views if views is not None and not any(each is other for other in views)
        )


class FakeShelf:
    """Four names, and nothing behind them."""

    moves = False
    marker_side_m = 0.08
    shown = MODEL
    awaited_name = None  # every model is there at once

    def __init__(self) -> None:
        self.names = ["cube", "lantern", "mug", "tree"]
        self.at = 0
        self.error = None
        self.words = []
        self.turned = 0

    @property
    def chosen_name(self) -> str:
        return self.names[self.at]

    @property
    def shown_name(self) -> str:
        return self.chosen_name

    def progress(self, _is_drawn: bool) -> str | None:
        return None

    def placement(self, _name: str, _where: str) -> Placement:
        return UNMOVED

    def keep_placement(self, _name: str, _where: str, _placement: Placement) -> None:
        pass

    def take_up(self, name: str, _model: object) -> None:
        self.at = self.names.index(name)

    def choose(self, index: int) -> bool:
        if index >= len(self.names):
            return False
        self.at = index
        return True

    def add(self, *paths: str) -> None:
        self.at = len(self.names)
        self.names += paths

    def step(self, by: int) -> None:
        self.at = (self.at + by) % len(self.names)

    def poll(self) -> None:
        pass

    def turn_up(self, by: int = 1) -> str:
        self.turned += by
        return "yzx"[self.turned]

    def take_notes(self):
        words, self.words = self.words, []
        return words

    def take_error(self):
        error, self.error = self.error, None
        return error


class FakeRenderer:
    """Keeps the scenes; its pictures' grey is the number of scenes so far."""

    gl_renderer, gl_version, preset, is_settled = "fake", "3.3", None, True
    shown_models = ()
    covers_marker = False

    def __init__(self, _context: object = None, _preset: object = None, size: tuple[int, int] = SIZE) -> None:
        self.size = size
        self.scenes = []
        self.waited = []  # for each scene, whether it waited for what was not ready
        self.begun_after = []  # the numbers of scenes after which another video began

    def render(self, scene, waits: bool = True) -> None:
        self.scenes.append(scene)
        self.waited.append(waits)

    def begin_anew(self) -> None:
        self.begun_after.append(len(self.scenes))

    def beside(self, size: tuple[int, int]) -> "FakeRenderer":
        return FakeRenderer(None, self.preset, size)

    def finish(self) -> None: ...

    def resize(self, size: tuple[int, int]) -> None:
        self.size = size

    def read_bgr(self) -> np.ndarray:
        return np.full((self.size[1], self.size[0], 3), len(self.scenes), np.uint8)

    def read_bgra(self) -> np.ndarray:
        return np.full((self.size[1], self.size[0], 4), len(self.scenes), np.uint8)


class Fakes:
    """All of the above by name, as a conftest cannot be imported."""

    Source, Clip, Tracker, Worker, KeyViews, Shelf, Renderer = (
        FakeSource,
        FakeClip,
        FakeTracker,
        FakeWorker,
        FakeKeyViews,
        FakeShelf,
        FakeRenderer,
    )
    tracked = staticmethod(tracked)

    @staticmethod
    def lost_once(at: int) -> Callable[[int], None]:
        """A source's hook by which it is lost before the frame with this index, the first time."""
        losses = iter([True])

        def lose(index: int) -> None:
            if index == at and next(losses, False):
                raise SourceLost("the camera gives no more pictures", "plug it in")

        return lose

    @staticmethod
    def tracked_in(frame: Frame) -> TrackedFrame:
        """Any frame, with a marker in it."""
        return TrackedFrame(frame, Camera.from_hfov(frame.size, 60), pose(), 1.0)

    @staticmethod
    def estimate(
        frame_index: int = 0, with_light: bool = True, towards=(1.0, 0.0, 1.0), sigma_rad=0.05, others=(), span_rad=None
    ) -> LightEstimate:
        light = Light(towards, sigma_rad=sigma_rad)
        mask = np.zeros((24, 32), bool)
        mask[4:12, 8:16] = True
        if not with_light:
            return LightEstimate("fake", frame_index, Illumination(), "no shadow found beside the object")
        times = {"total": 12.0}
        views = frame_index, *others
        return LightEstimate("fake", frame_index, Illumination((light,)), None, mask, ~mask, times, views, span_rad)


@pytest.fixture(scope="session")
def fakes() -> type[Fakes]:
    return Fakes


@pytest.fixture
def make(fakes) -> Callable[..., ScriptedSession]:
    """A session with fakes behind it: `when` its first estimate is made, and after how many frames it is steady."""

    def make(truth=None, automatic=False, steady_frames=3, **when) -> ScriptedSession:
        first = FirstEstimate(Steadiness(steady_frames), **when)
        return ScriptedSession(fakes, first, true_to_light_marker=truth, automatic=automatic)

    return make


@pytest.fixture
def shown(make) -> Callable[..., ScriptedSession]:
    """The same, which shows a frame with a marker."""

    def shown(**how) -> ScriptedSession:
        session = make(**how)
        session.take(tracked(), 0.0)
        return session

    return shown
