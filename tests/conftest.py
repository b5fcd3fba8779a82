"""What holds for all tests."""

import gc
import os
import tempfile

# What an earlier run of the tests kept is not what this one finds; its workers share what
# they keep.
if "PYTEST_XDIST_WORKER" not in os.environ:
    _kept = tempfile.TemporaryDirectory(prefix="bifurc-")
    os.environ["BIFURC_CACHE"] = _kept.name


def pytest_collection_finish():
    """What was collected lives as long as the run: the collector need not walk through
    it again and again."""
    gc.freeze()
