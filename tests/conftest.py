"""What holds for all tests."""

import gc


def pytest_collection_finish():
    """What was collected lives as long as the run: the collector need not walk through
    it again and again."""
    gc.freeze()
