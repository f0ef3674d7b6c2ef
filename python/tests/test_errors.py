"""What the library refuses is an exception: by class, status and message, with outputs untouched."""

import numpy as np
import pytest

import fixpair
from fixpair import native
from samples import BOX, scattered


@pytest.mark.parametrize("status", [status for status in native.Status if status != 0])
def test_every_status_has_a_class(status):
    error = native.error_of(status, fixpair.status_message(status), "deposit")
    assert type(error) is not fixpair.FixpairError and isinstance(error, fixpair.FixpairError)
    assert error.status is status and str(error) == fixpair.status_message(status) and error.function == "deposit"


def test_a_status_of_a_later_library_is_an_error_too():
    error = native.error_of(-999, "unheard of")
    assert type(error) is fixpair.FixpairError and error.status == -999


def test_the_version_is_that_of_the_library():
    assert fixpair.__version__ == fixpair.version() and len(fixpair.version().split(".")) == 3


@pytest.mark.parametrize("call, kind, also", [
    (lambda: fixpair.Fft(22), fixpair.MeshSizeError, ValueError),
    (lambda: fixpair.Brick.slab(8, 5, 4), fixpair.BrickError, ValueError),
    (lambda: fixpair.Brick.whole(2**62), fixpair.SizeError, OverflowError),
    (lambda: fixpair.Threads(0), fixpair.RangeError, ValueError),
    (lambda: fixpair.white_modes(8, fixpair.Realisation(1, amplitude=9)), fixpair.ChoiceError, ValueError),
    (lambda: fixpair.cosmology.radiation_density(float("nan"), 3.0, 0.7), fixpair.NotFiniteError, ValueError),
    (lambda: fixpair.Binning([4, 1]), fixpair.TableError, ValueError),
    (lambda: fixpair.variance.hartlap_factor(4, 4), fixpair.SamplesError, ValueError),
    (lambda: fixpair.variance.covariance_root(np.ones((2, 2))), fixpair.SingularError, ArithmeticError),
    (lambda: fixpair.pm.drift(x := np.zeros((4, 3)), x, BOX), fixpair.OverlapError, ValueError),
])
def test_mistakes_are_what_python_calls_them(call, kind, also):
    with pytest.raises(kind) as caught:
        call()
    assert isinstance(caught.value, also) and caught.value.function


def test_a_refused_call_leaves_outputs_as_they_were(dtype):
    mesh, x = np.full((8, 8, 8), 3, dtype), scattered(10, dtype)
    with pytest.raises(fixpair.RangeError):
        fixpair.deposit(mesh, x, -1.0)
    assert (mesh == 3).all()
