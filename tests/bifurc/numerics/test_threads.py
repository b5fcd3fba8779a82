"""Linear algebra on one thread, where threads would only wait for each other."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import bifurc
from bifurc.limits import SMALL, one_thread


def threads():
    """The threads of BLAS, of one library or of several."""
    return {
        each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"
    }


@pytest.fixture(autouse=True)
def two_threads():
    with threadpool_limits(2, user_api="blas"):
        yield


def test_what_was_set_before_comes_back():
    with one_thread(SMALL + 1):
        assert threads() == {1}
    assert threads() == {2}
    with pytest.raises(ZeroDivisionError), one_thread(SMALL + 1):
        _ = 1 / 0
    assert threads() == {2}


def test_small_problems_are_left_as_they_are():
    with one_thread(SMALL):
        assert threads() == {2}


def test_a_search_works_on_one_thread():
    n = SMALL + 1
    seen = set()

    def circle(u):
        return [u[0] ** 2 + u[1] ** 2 - 1, *(u[k] - u[0] for k in range(2, n))]

    bifurc.explore(
        bifurc.FunctionProblem(circle, [(-2, 2)] * n),
        settings=bifurc.SearchSettings(starts=1, certify=False),
        progress=lambda *_: seen.update(threads()),
    )
    assert seen == {1}
    assert threads() == {2}
