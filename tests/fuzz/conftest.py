"""Fuzzing the command line: what cases are made of, and the switches for long runs.

pytest tests/fuzz/test_command_line.py --fuzz-cases 20000 --fuzz-seed 1 --fuzz-summary summary.json
pytest tests/fuzz/test_recordings_survive.py --fuzz-signals 500
pytest tests/fuzz/test_scarce_resources.py --fuzz-disks 60
"""

import sys
from collections.abc import Mapping
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("fuzz", "long runs of tests/fuzz")
    group.addoption("--fuzz-cases", type=int, metavar="N", help="also try N random command lines")
    group.addoption(
        "--fuzz-seed", type=int, default=1, metavar="N", help="another seed, other command lines and moments"
    )
    group.addoption(
        "--fuzz-summary", type=Path, metavar="FILE.json", help="where the counts and what broke are written"
    )
    group.addoption(
        "--fuzz-signals", type=int, metavar="N", help="runs of signals at random moments, kill -9 and restart"
    )
    group.addoption("--fuzz-disks", type=int, metavar="N", help="sizes at which the disk is full")


@pytest.fixture(scope="session")
def materials(tmp_path_factory: pytest.TempPathFactory, film) -> Mapping[str, Path]:
    from tests.fuzz.materials import write_materials

    return write_materials(tmp_path_factory.mktemp("materials"), film.path, film.camera_file)


@pytest.fixture(scope="session")
def runner(materials):
    if not sys.platform.startswith("linux"):
        pytest.skip("the fork server watches processes as only Linux lets it")
    from tests.fuzz.command_lines.runner import Runner

    with Runner(materials) as runner:
        yield runner
