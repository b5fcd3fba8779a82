"""Ctrl-C where it does no harm: real signals."""

import os
import signal
import sys
import threading
import time

import pytest

from bifurc.limits import (
    GRACE,
    CutOff,
    Deadline,
    HeldInterrupt,
    cut_off_after,
    hear_interrupts,
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


def test_blocks_around_know_that_it_was_pressed():
    with HeldInterrupt() as outer:
        with pytest.raises(KeyboardInterrupt), HeldInterrupt():
            press()
        assert outer.was_pressed
        with HeldInterrupt() as later:
            assert later.was_pressed


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


def test_a_share_of_a_deadline_is_over_before_it():
    part = Deadline(100.0).share(0.25)
    assert 20.0 < part.left <= 25.0
    assert Deadline().share(0.25).left == float("inf")


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


class LastsInDestructor:
    """What a signal raises there is printed, and goes no further."""

    def __init__(self, destructor):
        self.destructor = destructor

    def __del__(self):
        self.destructor()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_what_python_swallows_is_cut_off_again():
    with pytest.raises(CutOff), cut_off_after(Deadline(0.0)):
        LastsInDestructor(lambda: last(60.0))
        last(60.0)


def test_an_error_that_compiled_code_makes_of_a_cut_is_one():
    """As NumPy does in comparisons of structured arrays."""

    def end_otherwise():
        try:
            last(60.0)
        except CutOff:
            raise TypeError("cannot compare") from None

    with pytest.raises(CutOff), cut_off_after(Deadline(0.0)):
        end_otherwise()
    with pytest.raises(TypeError), cut_off_after(Deadline(60.0)):
        raise TypeError("its own")


@pytest.fixture
def heard(monkeypatch):
    """Ctrl-C as a program of its own hears it."""
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    hear_interrupts()


def test_an_interrupt_that_python_swallows_comes_again(heard):
    with pytest.raises(KeyboardInterrupt):
        LastsInDestructor(press)
        last(60.0)
    assert signal.getsignal(signal.SIGALRM) is signal.SIG_DFL


def test_an_interrupt_waits_for_the_end_of_an_import(heard, tmp_path, monkeypatch):
    source = "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\n"
    source += "end = time.perf_counter() + 0.1\n"
    source += "while time.perf_counter() < end:\n    pass\nis_whole = True\n"
    (tmp_path / "imported_at_ctrl_c.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        import imported_at_ctrl_c  # noqa: F401

        last(60.0)
    assert sys.modules.pop("imported_at_ctrl_c").is_whole


def test_blocks_are_cut_off_with_those_around_them():
    ended = []
    began = time.perf_counter()
    with pytest.raises(CutOff), cut_off_after(Deadline(0.0)):
        with cut_off_after(Deadline(60.0)):
            pass
        with pytest.raises(CutOff), cut_off_after(Deadline(60.0)):
            last(60.0)
        ended.append("inner")
        last(60.0)
    assert ended == ["inner"]
    assert time.perf_counter() - began < 30.0
    assert signal.getsignal(signal.SIGALRM) is signal.SIG_DFL


def test_an_inner_block_leaves_the_time_of_the_outer_one():
    with cut_off_after(Deadline()):
        with pytest.raises(CutOff), cut_off_after(Deadline(0.0)):
            last(60.0)
        assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0


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
