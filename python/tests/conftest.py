"""What the tests share: both precisions, and a record of the functions that the package has called."""

import numpy as np
import pytest

import fixpair
from fixpair._library import library, path

CALLED = set()
library.called = lambda name, arguments: CALLED.add(name)


@pytest.fixture(params=[np.float32, np.float64], ids=["f32", "f64"])
def dtype(request):
    return np.dtype(request.param)


@pytest.fixture(scope="session")
def low():
    """The library without the layer above: what it is called for is not recorded."""
    return fixpair.native.Library(str(path()))


def pytest_collection_modifyitems(items):
    """The test of the record comes last."""
    items.sort(key=lambda item: item.get_closest_marker("last") is not None)


def pytest_configure(config):
    config.addinivalue_line("markers", "last: runs after all others")
