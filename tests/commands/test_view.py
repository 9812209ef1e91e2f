"""A request to end is not lost, wherever it falls."""

import signal

import pytest

from ashe_live.commands.view import ended_by_signals

ENDS = {signal.SIGINT: KeyboardInterrupt, signal.SIGTERM: SystemExit}


@pytest.fixture(autouse=True)
def _heard():
    """Not ignored, as they are in a shell's background job."""
    before = {number: signal.signal(number, signal.default_int_handler) for number in ENDS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(("number", "error"), ENDS.items())
def test_a_signal_that_something_swallowed_is_heard_at_the_next_picture(number, error):
    with ended_by_signals() as end_if_asked:
        with pytest.raises(error):
            signal.raise_signal(number)
        with pytest.raises(error) as raised:
            end_if_asked()
    assert error is KeyboardInterrupt or raised.value.code == 128 + number


def test_impatience_does_not_cut_short_what_ends():
    with ended_by_signals():
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)


def test_nobody_asked_and_nothing_ends():
    with ended_by_signals() as end_if_asked:
        end_if_asked()
