"""Ctrl-C where it does no harm: real signals."""

import os
import signal
import threading
import time

import pytest

from bifurc.limits import (
    GRACE,
    CutOff,
    Deadline,
    HeldInterrupt,
    cut_off_after,
    left_behind,
    whole,
)


@pytest.fixture(autouse=True)
def default_handler():
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, former)


def press():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.01)  # the handler runs between two instructions


def test_an_interrupt_waits_for_the_next_check():
    done = []
    with pytest.raises(KeyboardInterrupt), HeldInterrupt() as held:
        press()
        done.append("step")
        held.check()
        done.append("not reached")
    assert done == ["step"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_interrupt_without_a_check_comes_at_the_end_of_the_block():
    done = []
    with pytest.raises(KeyboardInterrupt), HeldInterrupt():
        press()
        done.append("all")
    assert done == ["all"]


def test_a_second_interrupt_acts_at_once():
    done = []
    with pytest.raises(KeyboardInterrupt), HeldInterrupt():
        press()
        press()
        done.append("not reached")
    assert not done


def test_a_deadline_passes_at_an_interrupt():
    with pytest.raises(KeyboardInterrupt), HeldInterrupt() as held:
        deadline = Deadline(interrupt=held)
        assert not deadline.passed
        press()
        assert deadline.passed
    assert deadline.left == 0.0


def test_the_inner_of_two_blocks_takes_the_interrupt():
    with HeldInterrupt() as outer:
        with pytest.raises(KeyboardInterrupt), HeldInterrupt():
            press()
        assert not outer.noted
        outer.check()


def test_an_error_in_the_block_is_not_hidden_by_the_interrupt():
    with pytest.raises(ValueError, match="trouble"), HeldInterrupt():
        press()
        raise ValueError("trouble")


def test_a_handler_of_the_user_and_a_thread_are_left_alone():
    seen = []
    signal.signal(signal.SIGINT, lambda *_: seen.append("mine"))
    with HeldInterrupt():
        press()
    assert seen == ["mine"]

    def work():
        with HeldInterrupt():
            seen.append(signal.getsignal(signal.SIGINT))

    handler = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen[-1] is handler


# --- what does not end by itself --------------------------------------------------------


def last(seconds):
    """Python code that asks nobody."""
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        sum(range(1000))


def test_what_does_not_ask_is_cut_off_soon_after_the_deadline():
    began = time.perf_counter()
    with pytest.raises(CutOff), cut_off_after(Deadline(0.05)):
        last(60.0)
    assert time.perf_counter() - began < 30.0
    assert signal.getsignal(signal.SIGALRM) is signal.SIG_DFL


def test_what_does_not_ask_is_cut_off_soon_after_ctrl_c():
    with pytest.raises(KeyboardInterrupt), HeldInterrupt() as held:
        with pytest.raises(CutOff), cut_off_after(Deadline(interrupt=held)):
            press()
            last(60.0)
        held.check()


def test_what_is_whole_is_cut_off_behind_its_end():
    written = []

    @whole
    def write():
        written.append("begin")
        last(3 * GRACE)
        written.append("end")

    with pytest.raises(CutOff), cut_off_after(Deadline(0.0)):
        write()
        last(60.0)
    assert written == ["begin", "end"]


def test_what_ends_by_itself_is_not_cut_off():
    with cut_off_after(Deadline(10.0)):
        pass
    time.sleep(0.01)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_a_decomposition_is_left_behind_in_a_thread():
    began = time.perf_counter()
    with pytest.raises(CutOff), cut_off_after(Deadline(0.0)):
        left_behind(10**4, time.sleep)(60.0)
    assert time.perf_counter() - began < 30.0
    with cut_off_after(Deadline(10.0)):
        assert left_behind(10**4, max)(1, 2) == 2
        with pytest.raises(TypeError):
            left_behind(10**4, max)(1)


def test_an_alarm_of_the_user_is_left_alone():
    rings = []
    former = signal.signal(signal.SIGALRM, lambda *_: rings.append("mine"))
    try:
        with cut_off_after(Deadline(0.0)):
            last(2 * GRACE)
        signal.raise_signal(signal.SIGALRM)
    finally:
        signal.signal(signal.SIGALRM, former)
    assert rings == ["mine"]
