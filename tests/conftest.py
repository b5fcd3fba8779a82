"""What holds for all tests."""

import gc
import os
import tempfile

# What an earlier run of the tests kept is not what this one finds.
os.environ["BIFURC_CACHE"] = tempfile.mkdtemp(prefix="bifurc-")


def pytest_collection_finish():
    """What was collected lives as long as the run: the collector need not walk through
    it again and again."""
    gc.freeze()
