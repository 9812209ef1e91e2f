"""The viewer in a real window, worked by its keys."""

import os
import re
import signal
import time

import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.clips.clip import ClipSource
from tests.painted_cubes import CAMERA, CubeScene, looking, painted, sun
from tests.patience import await_that

pytestmark = pytest.mark.window
# Parts of the window: the quality's name right of the rate, the film without any text, the help, the masks.
QUALITY = (0.1, 0.02, 0.35, 0.08)
BODY = (0.0, 0.25, 0.6, 0.85)
HELP = (0.3, 0.3, 0.7, 0.7)
INSET = (0.65, 0.65, 1.0, 1.0)
BAR = (0.5, 0.96, 0.9, 1.0)
STILL_S = 0.7


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Mean absolute, in grey levels; pictures of different sizes are as different as can be."""
    return 255.0 if a.shape != b.shape else float(np.abs(a - b).mean())


def await_part(viewer, part, was: np.ndarray, differs: bool = True) -> None:
    """Until the part's picture differs from what it was, or is that again."""
    await_that(lambda: (difference(was, viewer.part(*part)) > 0.2) is differs, f"a picture that differs: {differs}")


def await_still(viewer, part, still_s: float = STILL_S) -> np.ndarray:
    """The part's picture once it has not changed for so long that a playing film would have changed it."""
    seen, since = viewer.part(*part), time.monotonic()

    def is_still() -> bool:
        nonlocal seen, since
        now = viewer.part(*part)
        if difference(seen, now) > 0:
            seen, since = now, time.monotonic()
        return time.monotonic() - since > still_s

    await_that(is_still, "a still picture")
    return seen


def changed(viewer, was: np.ndarray) -> np.ndarray:
    """The picture of the models once it is another, and still."""
    seen = was

    def is_another() -> bool:
        nonlocal seen
        await_part(viewer, BODY, was)
        seen = await_still(viewer, BODY)
        return difference(seen, was) > 0.2

    await_that(is_another, "another picture that is still")
    return seen


def paused(viewer) -> np.ndarray:
    """The playing film's picture after P, held for far longer than the film, on a crowded machine, held any before."""
    times_s = [time.monotonic()]
    for _ in range(4):
        seen = viewer.part(*BODY)
        await_that(lambda seen=seen: difference(seen, viewer.part(*BODY)) > 0, "a film that plays")
        times_s.append(time.monotonic())
    viewer.press("p")
    return await_still(viewer, BODY, max(STILL_S, 3 * float(np.diff(times_s).max())))


def rewound(viewer) -> np.ndarray:
    """The film's first picture, held: the one frame that is known, and from which there are others to go on to."""
    paused(viewer)
    viewer.press("r")
    return await_still(viewer, BODY, 3 * STILL_S)


@pytest.fixture(scope="module")
def shared(play):
    """Hands out one viewer to test after test, as starting one takes seconds; a new one when it has ended."""
    viewers = []

    def shared():
        if not viewers or viewers[-1].process.poll() is not None:
            viewers.append(play("--loop"))
            await_that(lambda: "light" in viewers[-1].output, "the first estimate, made unasked")
            if "light: azimuth" not in viewers[-1].output:  # in some frames two iterations of GrabCut find none
                rewound(viewers[-1])
                viewers[-1].press("space")
                await_that(lambda: "light: azimuth" in viewers[-1].output, "the first frame's light")
                viewers[-1].press("p")
        return viewers[-1]

    return shared


@pytest.fixture
def estimated(shared, request):
    """A viewer that plays and whose light is known. Tests that do not end it leave it as they found it, or fail."""
    viewer, failed = shared(), request.session.testsfailed
    yield viewer
    print(viewer.output)  # shown where the test fails
    if request.session.testsfailed > failed:
        # It was left anyhow: the next test gets another.
        viewer.stop()


@pytest.fixture
def without_text(estimated):
    """That viewer, with nothing in the window that says that a model is loading."""
    estimated.press("i")
    yield estimated
    estimated.press("i")


def test_keys_switch_the_model_also_while_paused(without_text):
    without_text.press("1")
    pictures = [paused(without_text)]
    for key in ("2", "Right", "Left", "1"):
        without_text.press(key)
        pictures.append(changed(without_text, pictures[-1]))
    assert difference(pictures[1], pictures[3]) < 0.05
    assert difference(pictures[0], pictures[4]) < 0.05
    without_text.press("p")


def test_models_stand_beside_each_other_and_go_again(without_text):
    without_text.press("1")
    alone = paused(without_text)
    without_text.press("t")
    seen = [alone, changed(without_text, alone)]
    without_text.press("2")  # the new one
    seen.append(changed(without_text, seen[-1]))
    without_text.press("Tab", "plus", "plus")  # the first
    seen.append(changed(without_text, seen[-1]))
    without_text.press("minus", "minus", "Tab", "shift+t")
    await_part(without_text, BODY, alone, differs=False)
    without_text.press("p")


def test_space_estimates_while_frames_go_on(play):
    """With the estimator that takes seconds."""
    viewer = play("--loop", "--estimate-at", "1000", quick=False)
    viewer.press("space")
    moved = 0
    before = viewer.part(*BODY)
    while "light:" not in viewer.output and moved < 3:
        now = viewer.part(*BODY)
        moved += difference(before, now) > 0.2
        before = now
    assert moved == 3, "the picture stood still while estimating"
    assert viewer.end() == 0


def test_overlays_come_and_go(estimated):
    plain = paused(estimated)
    without_inset = await_still(estimated, INSET)
    for key, part, was in (("l", BODY, plain), ("h", HELP, await_still(estimated, HELP)), ("d", INSET, without_inset)):
        for wanted in (True, False):
            estimated.press(key)
            await_part(estimated, part, was, differs=wanted)
    for wanted in (True, False):
        estimated.press("F1")
        await_part(estimated, BODY, plain, differs=wanted)
    estimated.press("p")


def test_the_mouse_sets_light_and_model_and_a_double_click_gives_them_back(estimated):
    estimated.press("1")
    plain = paused(estimated)
    estimated.drag((0.3, 0.6), (0.45, 0.7))
    lit = changed(estimated, plain)
    estimated.drag((0.4, 0.5), (0.3, 0.6), "shift")
    moved = changed(estimated, lit)
    estimated.scroll(3)
    scaled = changed(estimated, moved)
    estimated.scroll(-3, "shift")
    turned = changed(estimated, scaled)
    estimated.scroll(3, "shift")
    estimated.scroll(-3)
    await_part(estimated, BODY, moved, differs=False)
    assert difference(turned, plain) > 0.2
    estimated.screen.xdotool("click", "--repeat", "2", "--delay", "50", "1")
    await_part(estimated, BODY, plain, differs=False)
    estimated.press("p")


def test_keys_set_light_and_model_and_backspace_gives_them_back(estimated):
    def estimate() -> np.ndarray:
        lines = estimated.output.count("light: azimuth")
        estimated.press("space")
        await_that(lambda: estimated.output.count("light: azimuth") > lines, "the light of the frame that is shown")
        return await_still(estimated, BODY)

    estimated.press("1")
    rewound(estimated)  # as there are frames in which two iterations of GrabCut find no light
    plain = estimate()
    seen = [plain]
    for keys in (["ctrl+Right"] * 8, ["ctrl+Down"] * 4, ["alt+Left"] * 3, ["bracketleft"] * 3, ["plus"] * 3):
        estimated.press(*keys)
        seen.append(changed(estimated, seen[-1]))
    estimated.press("minus", "KP_Subtract", "minus")
    await_part(estimated, BODY, seen[-2], differs=False)
    with_light_by_hand = await_still(estimated, BODY)
    assert difference(estimate(), with_light_by_hand) > 0.2
    assert difference(estimated.part(*BODY), plain) > 0.2  # the model stays as it is
    estimated.press("BackSpace")
    await_part(estimated, BODY, plain, differs=False)
    estimated.press("p")


def test_a_held_key_goes_on(estimated):
    plain = paused(estimated)
    estimated.screen.xdotool("keydown", "equal")
    first = estimated.part(*BODY)
    await_part(estimated, BODY, plain)
    for _ in range(3):
        await_part(estimated, BODY, first)
        first = estimated.part(*BODY)
    estimated.screen.xdotool("keyup", "equal")
    estimated.press("BackSpace")
    await_part(estimated, BODY, plain, differs=False)
    estimated.press("p")


def test_pause_and_restart(estimated):
    first = rewound(estimated)
    # By steps, as what a playing film is paused at may be its first frame.
    estimated.press(*["period"] * 6)
    await_part(estimated, BODY, first)
    estimated.press("r")
    await_part(estimated, BODY, first, differs=False)
    assert difference(first, await_still(estimated, BODY)) <= 0.2
    estimated.press("p")
    await_part(estimated, BODY, first)


def test_steps_seeks_and_the_bar(estimated):
    """To and fro brings the same pictures again; the light holds."""
    lights = estimated.output.count("light:")
    before = rewound(estimated)
    estimated.press(*["period"] * 6)
    await_part(estimated, BODY, before)
    on = await_still(estimated, BODY)
    estimated.press(*["comma"] * 6)
    await_part(estimated, BODY, on)
    near = difference(before, on) / 3
    await_that(lambda: difference(before, estimated.part(*BODY)) < near, "the same picture again")
    again = await_still(estimated, BODY)
    estimated.click_at(0.9, 0.99)
    await_part(estimated, BODY, again)
    late = await_still(estimated, BODY)
    estimated.press("shift+Left")  # by more than the film is long
    await_part(estimated, BODY, late)
    first = await_still(estimated, BODY)
    estimated.press("r")
    assert difference(first, await_still(estimated, BODY)) < 0.05
    bar = estimated.part(*BAR)
    estimated.press("i")
    await_part(estimated, BAR, bar)
    estimated.press("i")
    await_part(estimated, BAR, bar, differs=False)
    estimated.press("p", "o", "z", "x", "o")
    await_part(estimated, BODY, first)
    assert estimated.output.count("light:") == lights


def test_snapshot_and_recording_land_in_the_folder(estimated):
    estimated.press("s")
    await_that(lambda: estimated.files("*.png"), "a snapshot")
    with PIL.Image.open(estimated.files("*.png")[0]) as snapshot:
        assert snapshot.size == (640, 480)
    estimated.press("v")
    before = estimated.part(*BODY)
    for _ in range(3):
        await_part(estimated, BODY, before)
        before = estimated.part(*BODY)
    estimated.press("v")
    await_that(lambda: estimated.files("*.mp4"), "a recording")
    with ClipSource(estimated.files("*.mp4")[0]) as recording:
        frames = list(recording)
    assert recording.size == (640, 480)
    assert len(frames) > 1
    assert recording.note is None
    assert difference(frames[0].image_bgr.astype(int), frames[-1].image_bgr.astype(int)) > 0.05


def test_quality_goes_round_and_fullscreen_comes_and_goes(estimated):
    paused(estimated)
    for _ in range(4):
        before = estimated.part(*QUALITY)
        estimated.press("q")
        await_part(estimated, QUALITY, before)
    estimated.press("f")
    await_that(lambda: estimated.picture()[-200:].std() > 1, "fullscreen")
    estimated.press("f")
    await_that(lambda: estimated.picture()[-200:].std() < 1, "the window again")
    estimated.press("p")


def test_sigterm_finishes_the_recording(estimated):
    estimated.press("v")
    await_that(lambda: list(estimated.folder.glob(".*partial.mp4")), "a recording")
    for _ in range(3):  # pictures, of which the recording then has one at least
        await_part(estimated, BODY, estimated.part(*BODY))
    estimated.process.send_signal(signal.SIGTERM)
    assert estimated.wait() == 128 + signal.SIGTERM
    with ClipSource(estimated.files("*.mp4")[0]) as recording:
        assert recording.read() is not None
    assert not list(estimated.folder.glob(".*partial.mp4"))


def test_ctrl_c_ends_it_without_a_traceback(estimated):
    estimated.process.send_signal(signal.SIGINT)
    assert estimated.wait() == 130
    assert "Traceback" not in estimated.output


def test_it_goes_on_when_the_light_worker_dies(estimated):
    lines = estimated.output.count("light:")
    (worker,) = estimated.light_workers()
    os.kill(worker, signal.SIGKILL)
    await_that(lambda: not estimated.light_workers(), "its end")
    await_part(estimated, BODY, estimated.part(*BODY))
    estimated.press("space")
    await_that(lambda: estimated.output.count("light:") > lines, "an estimate by a new worker")
    assert estimated.light_workers() != [worker]


def test_it_plays_estimates_and_ends_with_status_0(estimated):
    before = estimated.part(*BODY)
    await_part(estimated, BODY, before)
    assert estimated.end() == 0
    assert "Traceback" not in estimated.output


def test_frames_ends_it_and_out_records_it(play):
    viewer = play("--frames", "20", "--loop", "--out", "o.mp4")
    assert viewer.wait() == 0
    with ClipSource(viewer.folder / "o.mp4") as recording:
        # A crowded machine shows some of them so late that the next one takes their place.
        assert 0 < len(list(recording)) <= 20


def test_the_end_of_the_clip_stays_on_screen_also_in_a_small_window(play):
    viewer = play("--size", "320x240")
    assert viewer.part(0, 0, 1, 1).shape == (240, 320, 3)
    await_that(lambda: "light: azimuth" in viewer.output, "the estimate")
    held = await_still(viewer, BODY)
    viewer.press("r")
    await_part(viewer, BODY, held)
    assert viewer.end() == 0


def test_the_demo_runs_and_shows_how_far_off_its_estimate_is(launch):
    viewer = launch("demo", "--quality", "fast", "--no-hide-marker")
    before = viewer.part(*BODY)
    await_part(viewer, BODY, before)
    error = re.compile(r"light: .* \(([\d.]+)° from the truth\)")
    await_that(lambda: error.search(viewer.output), "an estimate")
    assert float(error.search(viewer.output)[1]) < 8
    assert viewer.end() == 0


def white_share(picture: np.ndarray) -> float:
    """The part of a picture that is as bright and colourless as the paper cube."""
    return float(((picture.min(axis=2) > 190) & (np.ptp(picture, axis=2) < 20)).mean())


def test_a_paper_cube_is_covered_and_a_model_stands_in_its_place(launch, tmp_path):
    photo = tmp_path / "cube.png"
    PIL.Image.fromarray(painted(CubeScene(CAMERA, looking(0.4, 45, 30), [sun(200, 35)]))[..., ::-1]).save(photo)
    viewer = launch("play", photo, "--hfov", "60", "--model", "tree", quick=False)
    await_that(lambda: "light: azimuth" in viewer.output, "an estimate")
    middle = (0.3, 0.25, 0.7, 0.75)
    beside = await_still(viewer, middle)
    assert white_share(beside) > 0.02
    viewer.press("c")
    await_that(lambda: white_share(viewer.part(*middle)) < 0.1 * white_share(beside), "a covered cube")
    assert difference(beside, await_still(viewer, middle)) > 5  # the tree stands there, and its shadow lies there
    viewer.press("c")
    # Not the same picture: on a crowded machine the light may be found better meanwhile.
    await_that(lambda: white_share(viewer.part(*middle)) > 0.9 * white_share(beside), "the cube again")
    assert viewer.end() == 0
