"""What tests of sweeps share."""

import pytest

from tests.linkages.app.sweep.same_process import pool_at_once


@pytest.fixture
def same_process(monkeypatch):
    """Members are mapped in the process of the test."""
    monkeypatch.setattr("linkages.app.sweep.run.open_pool", pool_at_once)
