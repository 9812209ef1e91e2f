"""Commands run in this process, with an estimator that answers at once where the estimator is not the subject."""

import json
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import jsonschema
import numpy as np
import pytest

from ashe_live import cli
from ashe_live.commands.flags.option_groups import DEFAULT_ESTIMATOR
from ashe_live.commands.viewing import setup
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators import estimator
from ashe_live.light.live.worker_messages import Estimated
from tests.checkout import CHECKOUT


@dataclass(frozen=True)
class InstantEstimator:
    """Sees the light straight overhead, or none when told so."""

    has_light: bool = True
    name: str = DEFAULT_ESTIMATOR

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:  # noqa: ARG002
        lights = (Light((0.0, 0.3, 1.0)),) if self.has_light else ()
        reason = None if self.has_light else "no shadow found beside the object"
        return LightEstimate(
            self.name, tracked.frame.index, Illumination(lights), reason, timing_ms={"fit": 1.0, "total": 1.0}
        )


class InstantWorker:
    """Stands in for the light worker, without its process."""

    waited_s = 0.0

    def __init__(self, _name: str) -> None:
        self._asked: TrackedFrame | None = None

    @property
    def busy(self) -> bool:
        return self._asked is not None

    def request(self, tracked: TrackedFrame, *_how: object) -> bool:
        self._asked = tracked
        return True

    def wait(self, _timeout_s: float = 0.0) -> Estimated | None:
        asked, self._asked = self._asked, None
        return None if asked is None else Estimated(InstantEstimator().estimate(asked))

    def __enter__(self) -> "InstantWorker":
        return self

    def __exit__(self, *_error: object) -> None: ...


@cache
def contract() -> dict:
    return json.loads((CHECKOUT / "docs" / "contract.schema.json").read_text())


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    out: list[str]  # lines
    err: list[str]  # lines

    @property
    def records(self) -> list[dict]:
        """The answers in JSON, which keep to the contract."""
        records = [json.loads(line) for line in self.out]
        for record in records:
            jsonschema.validate(record, contract())
        return records

    @property
    def refusal(self) -> str:
        """All that a command said that was asked for what cannot be: one line."""
        assert self.status == 2
        (line,) = self.out + self.err
        return line


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str], request: pytest.FixtureRequest) -> Callable[..., Outcome]:
    """Runs `ashe-live` with these arguments; a test that fails shows what it said."""

    def run(*arguments: str | Path) -> Outcome:
        try:
            status = cli.run([str(argument) for argument in arguments])
        except SystemExit as end:  # argparse's way
            status = end.code
        out, err = capfd.readouterr()
        request.node.add_report_section("call", f"ashe-live {arguments[0] if arguments else ''}", f"{out}{err}")
        return Outcome(int(status or 0), out.splitlines(), err.splitlines())

    return run


@pytest.fixture
def heeds_signals() -> Iterator[None]:
    """Signals act that whoever began the tests may have ignored, as nohup and a shell's `&` do."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    for number in before:
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.fixture
def instant(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every estimate is made at once and in this process."""
    monkeypatch.setitem(estimator.ESTIMATORS, DEFAULT_ESTIMATOR, lambda _preset: InstantEstimator())
    monkeypatch.setattr(setup, "LightWorker", InstantWorker)


@pytest.fixture
def go_dark(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """From its call on, every estimate made in this process finds no light."""
    return lambda: monkeypatch.setitem(
        estimator.ESTIMATORS, DEFAULT_ESTIMATOR, lambda _preset: InstantEstimator(has_light=False)
    )


@pytest.fixture(scope="session")
def files(film, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Inputs by what is in them: photo, empty_table, garbage, truncated, tall_camera, broken_model."""
    folder = tmp_path_factory.mktemp("files")
    capture = cv2.VideoCapture(str(film.path))
    _, image = capture.read()
    capture.release()
    named = {name: folder / file for name, file in FILES.items()}
    cv2.imwrite(str(named["photo"]), image)
    cv2.imwrite(str(named["empty_table"]), np.full_like(image, 140))
    named["garbage"].write_bytes(b"this is no picture" * 20)
    whole = film.path.read_bytes()
    named["truncated"].write_bytes(whole[: 2 * len(whole) // 3])
    camera = json.loads(film.camera_file.read_text())
    named["tall_camera"].write_text(json.dumps({**camera, "size": camera["size"][::-1]}))
    named["broken_model"].write_bytes(b"glTF\x02\x00\x00\x00and nothing more")
    return named


FILES = {
    "photo": "photo.png",
    "empty_table": "empty_table.png",
    "garbage": "garbage.jpg",
    "truncated": "truncated.mp4",
    "tall_camera": "tall.json",
    "broken_model": "broken.glb",
}
