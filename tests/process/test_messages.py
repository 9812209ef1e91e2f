"""Whatever a file name or a damaged file holds, a message is one printable line of bounded length."""

import errno
import io
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.errors import UserError
from ashe_live.process.messages import MOST_CHARACTERS, listed, print_answer, print_message, printable
from tests.checkout import CHECKOUT

ANY_TEXT = st.text(st.characters(exclude_categories=()))  # lone surrogates too


@given(st.lists(st.integers(0, 9).map(str), min_size=1, max_size=40), st.integers(1, 9))
def test_a_list_accounts_for_every_name(names: list[str], most: int) -> None:
    assert listed(names).replace(" and ", ", ").split(", ") == names
    said = listed(names, most).replace(" and ", ", ").split(", ")
    if len(names) <= most:
        assert said == names
    else:
        assert said[:-1] == names[:most]
        assert said[-1] == f"{len(names) - most} more"


@given(ANY_TEXT)
def test_a_message_is_one_printable_line(text: str) -> None:
    line = printable(text)
    assert line.isprintable()
    assert len(line) <= MOST_CHARACTERS
    line.encode("utf-8")


@given(st.text(st.characters(categories=["L", "N", "P"]), min_size=1, max_size=MOST_CHARACTERS))
def test_ordinary_text_stays_as_it_is(text: str) -> None:
    assert printable(text) == text


@pytest.mark.parametrize(
    ("hostile", "seen"),
    [
        ("a\x1b[2Jb", "a\\x1b[2Jb"),
        ("a\udcffb", "a\\udcffb"),
        ("a\u202egnp.exe", "a\\u202egnp.exe"),
        ("two\nlines\r\nand a\ttab", "two lines and a tab"),
        ("a\u2028b\x85c", "a b c"),
    ],
)
def test_what_would_command_a_terminal_is_shown_as_an_escape(hostile: str, seen: str) -> None:
    assert printable(hostile) == seen


@pytest.mark.parametrize("letter", ["x", "\x1b", "\U0010ffff", "x "])
def test_what_is_too_long_keeps_its_beginning_and_its_end(letter: str) -> None:
    line = printable(f"cannot read {letter * 2_000_000}: copy it again", 100)
    assert len(line) <= 100
    assert line.startswith("cannot read ")
    assert line.endswith(": copy it again")


class Reader(io.RawIOBase):
    """The other end of a standard stream: it keeps what comes, or refuses it."""

    def __init__(self) -> None:
        self.got = b""
        self.refusal: OSError | None = None

    def writable(self) -> bool:
        return True

    def write(self, data: bytes | memoryview) -> int:
        if self.refusal is not None:
            raise self.refusal
        self.got += bytes(data)
        return len(data)


@contextmanager
def standard_streams() -> Iterator[tuple[Reader, Reader]]:
    """Those who read standard output and standard error, which are buffered as where they are a file or a pipe."""
    with pytest.MonkeyPatch.context() as patch:
        out, err = Reader(), Reader()
        for name, reader in (("stdout", out), ("stderr", err)):
            patch.setattr(sys, name, io.TextIOWrapper(io.BufferedWriter(reader)))
        yield out, err
        out.refusal = err.refusal = None  # what is left in the buffers is written at last


def test_a_line_is_read_before_the_program_ends() -> None:
    with standard_streams() as (out, err):
        assert print_answer("light from the left")
        print_message("no marker")
        assert (out.got, err.got) == (b"light from the left\n", b"ashe-live: no marker\n")


def test_a_reader_that_has_gone_is_reported_and_is_no_error_and_no_space_is_one() -> None:
    with standard_streams() as (out, err):
        out.refusal = err.refusal = BrokenPipeError(errno.EPIPE, "Broken pipe")
        assert not print_answer("light from the left")
        print_message("no marker")
        out.refusal = err.refusal = OSError(errno.ENOSPC, "No space left on device")
        with pytest.raises(UserError, match="No space left on device"):
            print_answer("light from the left")
        print_message("no marker")


def test_it_is_no_error_at_the_end_of_the_program_either() -> None:
    code = (
        "import sys; from ashe_live.process.ending import end_process; from ashe_live.process.messages import "
        "print_answer; sys.stdin.read(); end_process(print_answer('a') + 2 * print_answer('b'))"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=CHECKOUT,
    ) as process:
        assert process.stdout is not None
        process.stdout.close()
        _, said = process.communicate()
    assert (process.returncode, said) == (0, b"")


def test_errors_and_answers_take_one_line_each(capsys: pytest.CaptureFixture[str]) -> None:
    print_message("no\nmarker")
    print_answer("light\x1b from the left")
    said = capsys.readouterr()
    assert said.err == "ashe-live: no marker\n"
    assert said.out == "light\\x1b from the left\n"
