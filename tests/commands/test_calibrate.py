"""`ashe-live calibrate` from clips, and from a camera that is played by a fake."""

import contextlib
import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np
import PIL.ExifTags
import PIL.Image
import pytest

from ashe_live.capture.recording.recorder import Recorder
from ashe_live.capture.sources import SourceLost
from ashe_live.commands import calibrate
from ashe_live.commands.viewing import setup
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera, read_camera_file
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.tracking.boards import calibration_guide
from ashe_live.tracking.boards.calibration import CameraCalibration
from ashe_live.tracking.boards.calibration_board import BoardView, CalibrationBoard
from ashe_live.tracking.boards.calibration_guide import CalibrationGuide
from ashe_live.viewer.windows import calibration_window
from tests.tracking.board_pictures import Lens, seen_from

BOARD = CalibrationBoard()
SIZE = (480, 360)
CAMERA = Camera(SIZE, np.array([(430.0, 0, 245), (0, 430.0, 176), (0, 0, 1)]), np.array((-0.1, 0.03, 0, 0, 0)), "file")
UNIT_PX = 40
FRAMES = 40


@pytest.fixture(scope="module")
def pictures() -> list[Image]:
    """A board that wanders over the picture and tilts to all sides, some of it outside at times."""
    lens = Lens.of(CAMERA)
    sheet = BOARD.bitmap((BOARD.squares[0] * UNIT_PX, BOARD.squares[1] * UNIT_PX))
    sheet = cv2.copyMakeBorder(sheet, *[UNIT_PX] * 4, cv2.BORDER_CONSTANT, value=255)
    half_view = np.array(SIZE) / 2 / CAMERA.K[0, 0]
    pictures = []
    for at in range(FRAMES):
        phase = 2 * np.pi * at / FRAMES
        place = np.array((0.6 * np.sin(3 * phase), 0.55 * np.sin(2 * phase + 1))) * half_view
        distance = 10 * CAMERA.K[0, 0] / ((0.85 + 0.15 * np.sin(5 * phase)) * SIZE[1])
        middle = np.array(BOARD.squares) / 2 + 1
        pose = seen_from(distance, 25 + 12 * np.sin(4 * phase), 360 * 7 * at / FRAMES, middle, place, 0)
        pictures.append(np.dstack([lens.picture(sheet, pose, UNIT_PX, seed=at)] * 3))
    return pictures


@pytest.fixture(scope="module")
def board_clip(pictures: list[Image], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("board") / "board.mp4"
    with Recorder(path, SIZE, 30) as recorder:
        for index, picture in enumerate(pictures):
            recorder.write(picture, index / 30)
    return path


def known(views: Sequence[BoardView], _size: object) -> CameraCalibration:
    """What a calibration could say, at once: CAMERA, and that the second view contradicts the others."""
    return CameraCalibration(
        camera=CAMERA,
        rms_px=0.21,
        sigma_f_px=np.array((1.2, 1.3)),
        sigma_c_px=np.array((2.1, 2.2)),
        sigma_dist=np.array((0.01, 0.02, 0.0, 0.0, 0.0)),
        view_rms_px=np.full(len(views), 0.2),
        used=np.arange(len(views)) != 1,
    )


@pytest.fixture
def known_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration_guide, "calibrate", known)


class Told:
    """Guidance for nobody, which keeps what it was told, and wants to end after `most` of that."""

    def __init__(self, most: int = 999) -> None:
        self.frames: list[int] = []
        self.views: list[BoardView | None] = []
        self.said: list[str | None] = []
        self._most = most

    def show(self, frame: Frame, view: BoardView | None, _guide: CalibrationGuide, said: str | None) -> bool:
        self.frames.append(frame.index)
        self.views.append(view)
        self.said.append(said)
        return len(self.frames) < self._most

    @contextlib.contextmanager
    def open(self, *_: object) -> Iterator["Told"]:
        yield self


def test_a_folder_of_photos_gives_a_camera_file(run, pictures: list[Image], tmp_path: Path) -> None:
    folder, path = tmp_path / "photos", tmp_path / "camera.json"
    folder.mkdir()
    for number, picture in enumerate(pictures[::2]):
        cv2.imwrite(str(folder / f"{number:02}.png"), picture)
    (folder / "notes.txt").write_text("f/8")
    outcome = run("calibrate", "--camera", folder, "--out", path)
    assert outcome.status == 0
    assert outcome.err[0].endswith("passed over, as not named as photos: notes.txt")
    assert read_camera_file(path).K[0, 0] == pytest.approx(430, rel=0.01)


def test_photos_that_a_phone_turned_are_of_one_camera(run, pictures: list[Image], tmp_path: Path) -> None:
    """Looking down, it turns them as it happens to be tilted: all count as turned as the first one is, clockwise."""
    folder, path = tmp_path / "photos", tmp_path / "camera.json"
    folder.mkdir()
    for number, picture in enumerate(pictures[::2]):
        exif = PIL.Image.Exif()
        exif[PIL.ExifTags.Base.Orientation] = (6, 3, 1, 8)[number % 4]
        PIL.Image.fromarray(picture).save(folder / f"{number:02}.jpg", exif=exif, quality=98)
    assert run("calibrate", "--camera", folder, "--out", path).status == 0
    camera = read_camera_file(path)
    assert camera.size == SIZE[::-1]
    assert camera.K[0, 0] == pytest.approx(430, rel=0.01)
    # The sensor's 245, 176; half a turn more would mirror that at the centre.
    np.testing.assert_allclose(camera.K[:2, 2], (SIZE[1] - 1 - 176, 245), atol=2)


def test_a_photo_of_the_board_is_not_overwritten(run, pictures: list[Image], tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "0.png"), pictures[0])
    before = (tmp_path / "0.png").read_bytes()
    outcome = run("calibrate", "--camera", tmp_path, "--out", tmp_path / "0.png", "--overwrite", "--headless")
    assert outcome.status == 2
    assert (tmp_path / "0.png").read_bytes() == before


def test_the_clip_of_the_board_is_not_overwritten(run, film, tmp_path: Path) -> None:
    clip = tmp_path / "board.mp4"
    clip.write_bytes(film.path.read_bytes())
    assert "is also read" in run("calibrate", "--camera", clip, "--out", clip, "--overwrite", "--headless").refusal
    assert clip.read_bytes() == film.path.read_bytes()


def test_photos_of_two_sizes_are_refused_by_name(run, pictures: list[Image], tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), pictures[0])
    cv2.imwrite(str(tmp_path / "b.png"), pictures[1][:-8])
    outcome = run("calibrate", "--camera", tmp_path, "--out", tmp_path / "camera.json")
    assert outcome.status == 2
    assert "b.png has 480x352 pixels" in outcome.err[-1]


def test_no_size_is_asked_of_photos(run, pictures: list[Image], tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "1.png"), pictures[0])
    outcome = run("calibrate", "--camera", tmp_path, "--size", "640x480", "--out", tmp_path / "camera.json")
    assert "--size" in outcome.refusal


@pytest.mark.parametrize(("camera", "opened"), [("/dev/null", "/dev/null"), ("3", 3)])
def test_a_camera_is_asked_for_its_size_by_number_or_by_its_device(
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, camera: str, opened: object
) -> None:
    asked: list[object] = []

    def refuse(*how: object) -> None:
        asked.append(how)
        raise UserError("it is busy", "close what uses it")

    monkeypatch.setattr(calibrate, "WebcamSource", refuse)
    monkeypatch.setattr(calibrate, "connected", lambda: [object()])
    assert (
        "it is busy" in run("calibrate", "--camera", camera, "--size", "640x480", "--out", tmp_path / "a.json").refusal
    )
    assert asked == [(opened, (640, 480))]


def test_a_folder_without_photos_is_refused(run, tmp_path: Path) -> None:
    assert "no photo" in run("calibrate", "--camera", tmp_path, "--out", tmp_path / "camera.json").refusal


def test_a_clip_gives_a_camera_file(run, board_clip: Path, tmp_path: Path) -> None:
    """Also one whose name looks like Rich's markup, which is only a name."""
    path = tmp_path / "[/b]" / "[red]camera.json"
    path.parent.mkdir(parents=True)
    outcome = run("calibrate", "--camera", board_clip, "--out", path)
    assert outcome.status == 0
    camera = read_camera_file(path)
    assert camera.size == SIZE
    assert camera.K[0, 0] == pytest.approx(430, rel=0.01)
    assert camera.K[:2, 2] == pytest.approx(CAMERA.K[:2, 2], abs=3)
    content = json.loads(path.read_text())
    assert content["rms_px"] < 0.3
    assert 0 < content["sigma"]["f_px"][0] < 4.3
    assert any("±" in line and line.startswith("f ") for line in outcome.out)
    assert outcome.out[-1].endswith(f"--camera-file {path}")
    again = run("calibrate", "--camera", board_clip, "--out", path)
    assert "exists" in again.refusal


def test_a_clip_that_is_cut_says_so(run, board_clip: Path, tmp_path: Path) -> None:
    """Its end may be what the calibration lacks."""
    cut, content = tmp_path / "cut.mp4", board_clip.read_bytes()
    cut.write_bytes(content[: len(content) // 8])
    outcome = run("calibrate", "--camera", cut, "--out", tmp_path / "camera.json")
    assert outcome.status == 2
    note, refusal = outcome.err[-2:]
    assert "cut.mp4 is truncated or damaged: only" in note
    assert "too few" in refusal


@pytest.mark.usefixtures("known_at_once")
def test_the_figures_are_printed_though_the_file_finds_no_room(
    run, board_clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """View by view, and then the camera's with how sure they are."""

    def refuse(*_: object, **__: object) -> None:
        raise UserError("cannot write camera.json (no room)", "make some")

    monkeypatch.setattr(calibrate, "write_json", refuse)
    outcome = run("calibrate", "--camera", board_clip, "--out", tmp_path / "camera.json")
    assert outcome.status == 2
    assert "cannot write camera.json" in outcome.err[-1]
    focal, centre = "f 430.0 ± 1.2, 430.0 ± 1.3 px", "c 245.0 ± 2.1, 176.0 ± 2.2 px"
    assert outcome.out[-1] == f"{focal}; {centre}; distortion -0.1000 ± 0.0100, 0.0300 ± 0.0200, 0, 0, 0"
    rows = [line.strip("│ ").split("│") for line in outcome.out if line.strip("│ ")[:1].isdigit()]
    assert [int(row[0]) for row in rows] == list(range(1, len(rows) + 1))
    assert len(rows) > 12
    assert all(float(row[3]) == 0.2 for row in rows)
    assert ["left out" in row[-1] for row in rows] == [number == 1 for number in range(len(rows))]


@pytest.mark.usefixtures("known_at_once")
@pytest.mark.parametrize(("seen", "status"), [(0, 130), (FRAMES, 0)])
def test_ctrl_c_ends_it_with_what_was_seen(
    run, pictures: list[Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seen: int, status: int
) -> None:
    class Interrupted(FakeWebcam):
        def read(self) -> Frame:
            if self.reads == seen:
                raise KeyboardInterrupt
            return super().read()

    webcam = Interrupted(pictures)
    webcam.is_live = False  # a clip: a camera ends by itself
    monkeypatch.setattr(calibrate, "WebcamSource", lambda camera, size: webcam)  # noqa: ARG005
    webcam.lost_at = set()
    outcome = run("calibrate", "--camera", "0", "--headless", "--out", tmp_path / "camera.json")
    assert outcome.status == status
    assert not [line for line in outcome.err if line.startswith("ashe-live:")]
    assert (tmp_path / "camera.json").exists() == (status == 0)


@pytest.mark.parametrize("are_others", [False, True])
def test_without_a_camera_it_names_what_else_shows_the_board(
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, are_others: bool
) -> None:
    def refuse(camera: int, size: object) -> None:  # noqa: ARG001
        raise UserError("/dev/video0 is busy", "close what uses it")

    monkeypatch.setattr(calibrate, "WebcamSource", refuse)
    monkeypatch.setattr(calibrate, "connected", lambda: [object()] if are_others else [])
    outcome = run("calibrate", "--out", tmp_path / "camera.json")
    assert outcome.status == 2
    without = "there is no camera: connect one, or name a clip or a folder of photos of the board with --camera"
    assert outcome.err[-1] == f"ashe-live: {'/dev/video0 is busy: close what uses it' if are_others else without}"


def test_a_clip_without_a_board_is_one_line(run, film, tmp_path: Path) -> None:
    outcome = run("calibrate", "--camera", film.path, "--out", tmp_path / "camera.json")
    assert outcome.status == 2
    (line,) = [line for line in outcome.err if line.startswith("ashe-live:")]
    assert "no calibration board" in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["missing.mp4", "garbage.mp4", "empty.mp4"])
def test_what_is_no_clip_is_one_line(run, tmp_path: Path, name: str) -> None:
    (tmp_path / "garbage.mp4").write_bytes(b"no clip" * 99)
    (tmp_path / "empty.mp4").touch()
    assert run("calibrate", "--camera", tmp_path / name, "--out", tmp_path / "camera.json").refusal
    assert not (tmp_path / "camera.json").exists()


class FakeWebcam:
    """A camera before which the board is moved for ever."""

    is_live, is_photo, note, fps, name, size = True, False, None, 30.0, "camera 0", SIZE

    def __init__(self, pictures: list[Image]) -> None:
        self._pictures = pictures
        self.reads = 0
        self.lost_at = {5, 6}
        self.reopened = 0

    def read(self) -> Frame:
        self.reads += 1
        if self.reads in self.lost_at:
            raise SourceLost("camera 0 gives no more pictures", "plug it in again")
        return Frame(self._pictures[(self.reads - 1) % FRAMES], self.reads - 1, self.reads / 30)

    def reopen(self) -> bool:
        self.reopened += 1
        return True

    def __enter__(self) -> "FakeWebcam":
        return self

    def __exit__(self, *_error: object) -> None: ...


def test_a_live_camera_ends_when_it_is_known_although_it_was_lost_in_between(
    run: Callable, pictures: list[Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    webcam = FakeWebcam(pictures)
    monkeypatch.setattr(calibrate, "WebcamSource", lambda camera, size: webcam)  # noqa: ARG005
    outcome = run("calibrate", "--camera", "0", "--headless", "--out", tmp_path / "camera.json")
    assert outcome.status == 0
    assert webcam.reads <= 2 * FRAMES
    assert webcam.reopened == 2
    assert read_camera_file(tmp_path / "camera.json").K[0, 0] == pytest.approx(430, rel=0.01)


@pytest.mark.usefixtures("known_at_once")
def test_a_file_that_has_appeared_meanwhile_stays_and_the_calibration_is_put_beside_it(
    run: Callable, pictures: list[Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, webcam = tmp_path / "camera.json", FakeWebcam(pictures)

    def opened(_camera: int, _size: object) -> FakeWebcam:
        path.write_text("precious")
        return webcam

    monkeypatch.setattr(calibrate, "WebcamSource", opened)
    outcome = run("calibrate", "--camera", "0", "--headless", "--out", path)
    assert outcome.status == 0
    assert path.read_text() == "precious"
    (written,) = set(tmp_path.iterdir()) - {path}
    np.testing.assert_array_equal(read_camera_file(written).K, CAMERA.K)
    views = len(json.loads(written.read_text())["views"])
    assert outcome.out[-1] == (
        f"{written}: 0.21 px off on average in {views - 1} of {views} views; use it with --camera-file {written}"
    )


@pytest.mark.usefixtures("known_at_once")
def test_a_camera_that_is_gone_is_waited_for_and_what_it_says_is_told(
    run: Callable, pictures: list[Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Away(FakeWebcam):
        def reopen(self) -> bool:
            self.lost_at = {self.reads + 1} if self.reopened < 3 else set()
            return super().reopen() and self.reopened > 3

    webcam, told, slept = Away(pictures), Told(), []
    webcam.lost_at = {5}
    monkeypatch.setattr(calibrate, "WebcamSource", lambda camera, size: webcam)  # noqa: ARG005
    monkeypatch.setattr(calibrate, "_lines", told.open)
    monkeypatch.setattr(calibrate.time, "sleep", slept.append)
    assert run("calibrate", "--camera", "0", "--headless", "--out", tmp_path / "camera.json").status == 0
    assert slept == [calibrate.RECONNECT_EVERY_S] * 3, "and at once where it is back"
    lost = [at for at, said in enumerate(told.said) if said is not None]
    assert lost == [4, 5, 6, 7]
    assert {told.said[at] for at in lost} == {"camera 0 gives no more pictures: plug it in again"}
    assert {told.frames[at] for at in lost} == {3}, "the last picture stands meanwhile"
    assert all(told.views[at] is None for at in lost)
    assert told.views[3] is not None


@pytest.mark.parametrize("is_lost", [False, True])
def test_who_ends_it_before_its_time_gets_what_the_views_so_far_say(
    run: Callable, pictures: list[Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_lost: bool
) -> None:
    """Also while the camera is gone."""
    webcam, told = FakeWebcam(pictures), Told(most=5)
    webcam.lost_at = {5} if is_lost else set()
    monkeypatch.setattr(calibrate, "WebcamSource", lambda camera, size: webcam)  # noqa: ARG005
    monkeypatch.setattr(calibrate, "_lines", told.open)
    outcome = run("calibrate", "--camera", "0", "--headless", "--out", tmp_path / "camera.json")
    assert "seen in too few different views" in outcome.refusal
    assert (webcam.reads, webcam.reopened) == (5, 0)
    assert len(told.frames) == 5


def test_views_that_do_not_tell_enough_are_followed_by_more(
    run: Callable, pictures: list[Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tries = []

    def refused_twice(views: Sequence[BoardView], size: object) -> CameraCalibration:
        tries.append(len(views))
        if len(tries) < 3:
            raise UserError(f"{len(views)} views are too few", "show more")
        return known(views, size)

    told, twice = Told(), [picture for picture in pictures for _ in range(2)]
    monkeypatch.setattr(calibration_guide, "calibrate", refused_twice)
    monkeypatch.setattr(CalibrationGuide, "wanted", lambda _guide: None)
    monkeypatch.setattr(calibrate, "WebcamSource", lambda camera, size: FakeWebcam(twice))  # noqa: ARG005
    monkeypatch.setattr(calibrate, "_lines", told.open)
    assert run("calibrate", "--camera", "0", "--headless", "--out", tmp_path / "camera.json").status == 0
    assert tries == [1, 2, 3], "with each view that is new"
    assert told.said[:4] == [f"{count} views are too few: show more" for count in (1, 1, 2, 2)]


@pytest.mark.usefixtures("known_at_once")
@pytest.mark.parametrize(
    ("is_live", "has_display", "flags", "in_window"),
    [
        (True, True, (), True),
        (True, True, ("--headless",), False),
        (True, False, (), False),
        (False, True, (), False),
    ],
)
def test_a_camera_is_guided_in_a_window_where_there_is_a_display(
    run: Callable,
    pictures: list[Image],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    is_live: bool,
    has_display: bool,
    flags: tuple[str, ...],
    in_window: bool,
) -> None:
    webcam, lines, window, opened = FakeWebcam(pictures), Told(most=2), Told(most=2), []
    webcam.is_live = is_live
    monkeypatch.setattr(calibrate, "WebcamSource", lambda camera, size: webcam)  # noqa: ARG005
    monkeypatch.setattr(setup, "has_display", lambda: has_display)
    monkeypatch.setattr(calibration_window, "CalibrationWindow", lambda *given: opened.append(given) or window.open())
    monkeypatch.setattr(calibrate, "_lines", lines.open)
    run("calibrate", "--camera", "0", *flags, "--out", tmp_path / "camera.json")
    assert (len(window.frames), len(lines.frames)) == ((2, 0) if in_window else (0, 2))
    assert opened == ([("camera 0", SIZE)] if in_window else [])


def test_in_the_terminal_it_says_what_is_wanted_frame_by_frame(
    pictures: list[Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    lines: list[str] = []

    class Progress:
        def add_task(self, *_: object, **__: object) -> int:
            return 7

        def update(self, task: int, completed: float, views: int, description: str) -> None:
            lines.append(f"{task} {completed:.2f} {views} {description}")

    guide, shown = CalibrationGuide(SIZE), calibrate._Lines(Progress())
    frame = Frame(pictures[0], 12, 0.0)
    view = BOARD.find(pictures[0][..., 0])
    guide.add(view, 12)
    assert shown.show(frame, None, guide, None)
    assert shown.show(frame, view, guide, None)
    assert shown.show(frame, view, guide, "plug it in")
    monkeypatch.setattr(CalibrationGuide, "wanted", lambda _guide: None)
    assert shown.show(frame, view, guide, None)
    state = f"7 {guide.progress:.2f} 1 frame 12:"
    assert lines[0] == f"{state} no board in view"
    assert lines[1].startswith(f"{state} tilt the board")
    assert lines[2] == f"{state} plug it in"
    assert lines[3].startswith(f"{state} enough views")
