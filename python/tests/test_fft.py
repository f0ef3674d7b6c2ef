"""The built-in transform is that of numpy, and any transform of the host's takes its place."""

import numpy as np
import pytest

import fixpair
from samples import BOX, numbers, tolerance

scipy_fft = pytest.importorskip("scipy.fft")
HOSTS = {"numpy": (np.fft.rfftn, np.fft.irfftn), "scipy": (scipy_fft.rfftn, scipy_fft.irfftn)}


def filled(fft):
    data = fft.mesh()
    fft.cells(data)[...] = numbers(fft.n**3).reshape((fft.n,) * 3)
    return data


@pytest.mark.parametrize("pad", [None, 0, 3])
def test_the_transform_is_that_of_numpy(dtype, pad):
    fft = fixpair.Fft(12, dtype, pad)
    data = filled(fft)
    cells = fft.cells(data).copy()
    modes = fft.forward(data)
    expected = np.fft.rfftn(cells)
    # A few roundings of the largest.
    assert np.abs(modes - expected).max() < tolerance(dtype, 4) * np.abs(expected).max()
    assert np.abs(fft.inverse(data) / 12**3 - cells).max() < tolerance(dtype, 4)
    fft.self_test()


def test_cells_and_modes_are_the_same_memory(dtype):
    fft = fixpair.Fft(8, dtype)
    data = fft.mesh()
    assert np.shares_memory(fft.cells(data), data) and np.shares_memory(fft.modes(data), data)
    assert fft.cells(data).shape == (8, 8, 8) and fft.modes(data).shape == (8, 8, 5)
    with pytest.raises(ValueError, match="shape"):
        fft.forward(data[:-1])
    with pytest.raises(TypeError):
        fft.forward(data.astype(np.float32 if dtype == np.float64 else np.float64))


@pytest.mark.parametrize("host", HOSTS)
def test_a_host_transform_makes_the_same_universe(host, dtype):
    own = fixpair.HostFft(16, dtype, *HOSTS[host])
    own.self_test()
    conditions = fixpair.Conditions(5, box_size=BOX, f_nl=100.0)
    found, expected = (fixpair.initial_conditions(conditions, fft)[1] for fft in (own, fixpair.Fft(16, dtype)))
    # Velocities are up to some hundred km/s, with the rounding of a dozen transforms.
    assert np.abs(found - expected).max() < tolerance(dtype, 100) * np.abs(expected).max()


def test_a_wrong_host_transform_is_found_out():
    wrong = fixpair.HostFft(8, np.float64, lambda cells: np.conj(np.fft.rfftn(cells)))
    with pytest.raises(fixpair.HookError):
        wrong.self_test()


def test_an_exception_of_a_host_transform_is_raised():
    def fails(cells):
        raise KeyError("no plan")
    fft = fixpair.HostFft(8, np.float64, fails)
    with pytest.raises(KeyError, match="no plan"):
        fixpair.noise.modes_from_field(fft.mesh(), fft, fixpair.Realisation(1))
    with pytest.raises(KeyError, match="no plan"):
        fft.forward(fft.mesh())


def test_sides_and_padding():
    assert [fixpair.fft.next_side(n) for n in (1, 11, 24, 97)] == [2, 12, 24, 98]
    assert fixpair.fft.padding(12) == 0 and fixpair.fft.padding(256, np.float32) > 0
