"""Workers of a sweep that are no processes, for tests of what a sweep writes."""

from collections.abc import Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager

from linkages.app.sweep.run import Pool


class AtOnce(Executor):
    """Calls every function when it is submitted."""

    def submit(self, function, /, *arguments, **options):
        future = Future()
        try:
            future.set_result(function(*arguments, **options))
        except Exception as error:
            future.set_exception(error)
        return future


@contextmanager
def pool_at_once(workers: int | None, scheduler: str | None) -> Iterator[Pool]:
    """What stands for `linkages.app.sweep.run.open_pool`."""
    yield Pool(AtOnce(), window=4)
