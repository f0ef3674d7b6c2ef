"""The package reaches every function of the header."""

from pathlib import Path

import pytest

from conftest import CALLED
from fixpair import native


@pytest.mark.last
def test_the_tests_of_the_package_call_every_function(request):
    ran = {item.path for item in request.session.items}
    if any(path not in ran for path in Path(__file__).parent.glob("test_*.py")):
        pytest.skip("other tests, which do the calling, did not run")
    missing = (native.SIGNATURES.keys() | native.OTHERS.keys()) - CALLED
    assert not missing, sorted(missing)
