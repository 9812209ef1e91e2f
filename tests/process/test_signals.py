"""A request to end is not lost, wherever it falls."""

import signal
import threading

import pytest

from ashe_live.process.signals import called_from_c, ctrl_c_blocked, ended_by_signals, signals_held

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


@pytest.mark.parametrize(("number", "error"), ENDS.items())
def test_in_what_c_code_calls_a_signal_waits(number, error):
    """C code prints what it is raised there, and takes it for a damaged file."""

    @called_from_c
    def read() -> bytes:
        return within()

    def within() -> bytes:
        signal.raise_signal(number)
        return b"all"

    with ended_by_signals() as end_if_asked:
        assert read() == b"all"
        with pytest.raises(error):
            end_if_asked()


def test_impatience_does_not_cut_short_what_ends():
    with ended_by_signals():
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)


@pytest.mark.parametrize(("within", "number"), [(ended_by_signals, signal.SIGTERM), (signals_held, signal.SIGINT)])
def test_afterwards_every_handler_is_as_it_was(within, number):
    before = {each: signal.getsignal(each) for each in signal.valid_signals()}
    with within():
        assert signal.getsignal(number) is not before[number]
    assert {each: signal.getsignal(each) for each in signal.valid_signals()} == before


def test_what_is_ignored_stays_ignored():
    """As under nohup."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    with ended_by_signals() as end_if_asked:
        signal.raise_signal(signal.SIGTERM)
        end_if_asked()


def test_nobody_asked_and_nothing_ends():
    with ended_by_signals() as end_if_asked:
        end_if_asked()


@pytest.mark.parametrize(("number", "error"), ENDS.items())
def test_a_held_signal_is_heard_afterwards(number, error):
    done = []

    def work():
        with signals_held():
            signal.raise_signal(number)
            done.append("all of it")

    with ended_by_signals(), pytest.raises(error):
        work()
    assert done


def test_other_threads_hold_nothing_as_no_handler_runs_in_them():
    def hold():
        with signals_held():
            handlers.append(signal.getsignal(signal.SIGINT))
        done.append(True)

    handlers, done = [], []
    thread = threading.Thread(target=hold)
    thread.start()
    thread.join()
    assert handlers == [signal.default_int_handler]
    assert done


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="Windows has no such masks")
def test_a_blocked_ctrl_c_is_heard_afterwards():
    done = []

    def work():
        with ctrl_c_blocked():
            signal.pthread_kill(threading.get_ident(), signal.SIGINT)
            done.append("all of it")

    with ended_by_signals(), pytest.raises(KeyboardInterrupt):
        work()
    assert done
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
