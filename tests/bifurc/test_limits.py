"""Ctrl-C where it does no harm: real signals."""

import os
import signal
import threading
import time

import pytest

from bifurc.limits import Deadline, HeldInterrupt


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
