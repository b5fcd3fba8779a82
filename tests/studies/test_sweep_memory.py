"""The watch on the memory of a sweep."""

import mmap

import pytest


def test_the_watch_sees_a_process_that_grows():
    psutil = pytest.importorskip("psutil")
    from studies.sweep_memory import Watch

    watch, kept, size = Watch(), [], 1 << 22
    for done in range(20):
        kept.append(
            mmap.mmap(-1, size)
        )  # an array might be given memory that the process has in hand
        kept[-1].write(bytes([1]) * size)
        watch.look(done)
    assert watch.own[-1] == pytest.approx(psutil.Process().memory_info().rss, rel=0.1)
    assert watch.growth("own") == pytest.approx(size, rel=0.2)
    assert watch.growth("worker") < 1.0
