"""Spectra, correlation functions and bispectra of fields whose statistics are known."""

import numpy as np
import pytest

import fixpair
from fixpair import Amplitude, Binning, Compensation, Fft, Multipole, Realisation, Second, Sums, Window, estimate
from samples import BOX, SEED, scattered, tolerance

N = 16
EDGES = estimate.edges_uniform(7)


def fixed(dtype, **members):
    return fixpair.white_modes(N, Realisation(SEED, amplitude=Amplitude.FIXED, **members), dtype=dtype)


def test_edges():
    assert EDGES.tolist() == [1, 4, 9, 16, 25, 36, 49] and EDGES.dtype == np.uint64
    assert estimate.edges_exact(3, 5).tolist() == [5, 6, 7]
    assert estimate.edges_wavenumbers(np.array([1, 2, 3]) * 2 * np.pi / BOX, BOX).tolist() == [1, 4, 9]


def test_a_fixed_field_has_exactly_the_input_power(dtype):
    bins, values = estimate.power_sums(Sums.zeros(Binning(EDGES)), [fixed(dtype)]).multipoles(8.0)
    assert bins.count.tolist() == [26, 66, 158, 234, 410, 470]
    assert np.abs(values / 8 - 1).max() < tolerance(dtype, 10)


def test_spectra_of_several_pairs_are_those_of_numpy():
    f, g = fixpair.white_modes(N, Realisation(1)), fixpair.white_modes(N, Realisation(2))
    binning = Binning(EDGES, orders=Multipole.MONOPOLE | Multipole.QUADRUPOLE)
    _, values = estimate.power_sums(Sums.zeros(binning, 2), [f, g], [(0, 0), (0, 1)]).multipoles(1.0)
    assert values.shape == (2, 6, 2)
    i = np.fft.fftfreq(N, 1 / N)
    square = i[:, None, None]**2 + i[:, None]**2 + np.arange(N // 2 + 1)**2
    twice = np.where((np.arange(N // 2 + 1) == 0) | (np.arange(N // 2 + 1) == N // 2), 1, 2) * np.ones(square.shape)
    mu = np.arange(N // 2 + 1) / np.sqrt(np.maximum(square, 1))
    for pair, product in enumerate((f * np.conj(f), f * np.conj(g))):
        for b in range(6):
            inside = (square >= EDGES[b]) & (square < EDGES[b + 1])
            weights, p = twice[inside], product[inside].real
            for column, legendre in enumerate((np.ones_like(p), 5 * (1.5 * mu[inside]**2 - 0.5))):
                assert values[pair, b, column] == pytest.approx((weights * p * legendre).sum() / weights.sum(), abs=1e-13)


def test_sums_of_slabs_are_those_of_the_whole(dtype):
    binning, modes = Binning(EDGES, second=Second.COSINE, second_edges=[0.0, 0.5, 1.0]), fixed(dtype)
    whole, parts = estimate.power_sums(Sums.zeros(binning), [modes]), Sums.zeros(binning)
    for first, planes in ((0, 5), (5, 11)):
        slab = fixpair.Brick.slab(N, first, planes, fixpair.Space.FOURIER)
        parts += estimate.power_sums(Sums.zeros(binning), [modes[first:first + planes]], brick=slab)
    (bins, values), (expected_bins, expected) = parts.read(), whole.read()
    assert np.array_equal(bins, expected_bins) and np.array_equal(values, expected) and values.shape == (1, 12, 1)


@pytest.mark.parametrize("interlaced", [False, True])
def test_points_without_clustering_have_shot_noise_alone(dtype, interlaced):
    rng = np.random.default_rng(1)
    x = rng.uniform(0, BOX, (20000, 3)).astype(dtype)
    power = fixpair.power_spectrum(x, BOX, Binning(EDGES), N * 2, interlaced=interlaced)
    assert power.noise == BOX**3 / 20000 and power.k[0] == pytest.approx(2 * np.pi / BOX * 1.4, rel=0.1)
    # Scatter of sqrt(2/modes), five times.
    assert (np.abs(power.multipoles[:, 0] / power.noise - 1) < 5 * np.sqrt(2 / power.modes)).all()
    pairs, noise = [(0, 0)], [power.noise]
    bins, values = Sums.zeros(Binning(EDGES)).read()
    bins.count = power.modes
    left = estimate.subtract_shot_noise(power.multipoles[None].copy(), pairs, bins, Multipole.MONOPOLE, noise)
    assert left == pytest.approx(power.multipoles[None] - power.noise, rel=1e-12)


def test_weights_change_shot_noise(dtype):
    weights = np.array([1.0, 1.0, 0.0, 0.0], dtype)
    assert estimate.shot_noise(4, 10.0) == 250.0 and estimate.shot_noise(4, 10.0, weights) == 500.0
    x = scattered(4, dtype, 10.0)
    halved = fixpair.power_spectrum(x, 10.0, Binning(EDGES), N, weights=weights)
    expected = fixpair.power_spectrum(x[:2], 10.0, Binning(EDGES), N).multipoles
    # Power of two particles, which cancels in part.
    assert halved.multipoles == pytest.approx(expected, rel=tolerance(dtype, 1000))


def test_the_correlation_function_is_the_transform_of_the_spectrum(dtype):
    fft = Fft(N, dtype)
    data = fft.mesh()
    modes = fft.modes(data)
    modes[...] = fixpair.white_modes(N, Realisation(3), dtype=dtype)
    expected = np.fft.irfftn(np.abs(modes.astype(complex))**2, s=(N, N, N), axes=(0, 1, 2)) * N**3
    estimate.correlation_modes(modes)
    xi = fft.inverse(data)
    assert np.abs(xi - expected).max() < tolerance(dtype, 30) * np.abs(expected).max()
    binning = Binning(EDGES)
    bins, values = estimate.correlation_sums(Sums.zeros(binning), [xi]).multipoles(1.0)
    i = np.fft.fftfreq(N, 1 / N)
    square = i[:, None, None]**2 + i[:, None]**2 + i**2
    assert values[0, 0, 0] == pytest.approx(xi[(square >= 1) & (square < 4)].mean(dtype=float), rel=1e-5)
    other = fixpair.white_modes(N, Realisation(4), dtype=dtype)
    cross = estimate.correlation_modes(other.copy(), fixed(dtype), scale=2.0)
    # A product of numbers of order 1.
    assert np.abs(cross - 2 * other * np.conj(fixed(dtype))).max() < tolerance(dtype, 20)


def test_compensation_divides_by_the_window(dtype):
    modes = np.ones((N, N, N // 2 + 1), np.result_type(dtype, np.complex64))
    estimate.compensate(modes, Compensation.WINDOW + Window.TSC, 0.5)
    sinc = np.sinc(np.fft.fftfreq(N))**3
    expected = 0.5 / (sinc[:, None, None] * sinc[:, None] * np.abs(sinc[:N // 2 + 1]))
    assert modes == pytest.approx(expected, rel=tolerance(dtype, 20))


def test_triangles():
    edges = estimate.edges_uniform(3, 1.5, 3.0)
    triangles = estimate.closed_triangles(edges)
    assert triangles.tolist() == [[0, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1]]
    assert len(estimate.closed_triangles(edges, [1.0, 3.0])) == 3
    assert estimate.triangle_counts(triangles, edges, 24).tolist() == [54066, 71166, 225724, 470232]
    assert estimate.squeezed_triangles(1, 4).tolist() == [[1, 1, 1], [1, 2, 2], [1, 3, 3]]


def test_a_bispectrum_of_shells_is_that_of_the_host(dtype):
    fft, edges = Fft(N, dtype), EDGES[:4].copy()
    triangles, data = estimate.closed_triangles(edges), fft.mesh()
    fft.modes(data)[...] = fixpair.white_modes(N, Realisation(5), dtype=dtype)
    fields = []
    for low, high in zip(edges[:-1], edges[1:]):
        shell = fft.mesh()
        estimate.shell_modes(fft.modes(data), int(low), int(high), out=fft.modes(shell))
        fields.append(fft.inverse(shell))
    sums = estimate.bispectrum_sums(None, triangles, fields)
    for meshes in (None, 3):
        assert np.array_equal(estimate.bispectrum(None, triangles, edges, data, fft, meshes=meshes), sums)
    values = estimate.bispectrum_values(sums)
    expected = [np.prod([fields[shell].astype(float) for shell in triangle], axis=0).sum() for triangle in triangles]
    # Sums of 16^3 products, which cancel.
    assert np.abs(values - expected).max() < tolerance(dtype, 10) * N**3 * np.abs(fields).max()**3
    counts = estimate.triangle_counts(triangles, edges, N)
    b = estimate.bispectrum_normalise(values.copy(), counts, N, BOX)
    assert b == pytest.approx(BOX**6 / N**3 * values / counts, rel=1e-12)
    power = np.array([3.0, 2.0, 1.0])
    first = triangles[0]
    assert estimate.bispectrum_shot_noise(triangles, power, 0.5)[0] == power[first].sum() * 0.5 + 0.25
    p = power[triangles.astype(int)]
    assert estimate.bispectrum_reduced(b, triangles, power) == pytest.approx(
        b / (p[:, 0] * p[:, 1] + p[:, 1] * p[:, 2] + p[:, 2] * p[:, 0]), rel=1e-12)


def test_lists_of_another_length_are_refused():
    with pytest.raises(ValueError, match="pairs"):
        estimate.power_sums(Sums.zeros(Binning(EDGES), 2), [fixed(np.float64)], [(0, 0)])
    with pytest.raises(ValueError, match="fields\\[1\\]"):
        estimate.power_sums(Sums.zeros(Binning(EDGES)), [fixed(np.float64), np.zeros((8, 8, 5), complex)])
