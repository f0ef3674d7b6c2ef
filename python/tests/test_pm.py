"""The particle mesh: masses are kept, forces are those of plane waves, runs go as linear theory."""

import numpy as np
import pytest

import fixpair
from fixpair import Brick, Fft, Gravity, Space, Stepper, Window, cosmology, pm
from samples import BOX, numbers, scattered, tolerance

N = 12


def bits(low, dtype, x, window, shift):
    """A deposit by the library alone."""
    real, layout, mesh, count = ("f32", "f64")[dtype.itemsize // 8], fixpair.native.Layout(), np.zeros((N, N, N), dtype), len(x)
    brick = fixpair.native.Brick(n=N, space=0, count=(N, N, N), stride=(N * N, N, 1))
    getattr(low, f"deposit_scratch_{real}")(layout, brick, count, window)
    memory, start = fixpair.workspace.aligned(layout.size), x.ctypes.data
    places = fixpair.native.Positions(*(start + axis * dtype.itemsize for axis in range(3)), 3, count)
    getattr(low, f"deposit_{real}")(mesh, mesh.size, brick, places, None, 0, BOX, window, shift, memory, memory.size, None)
    return mesh


@pytest.mark.parametrize("window", Window)
def test_a_deposit_has_the_bits_of_the_library_and_keeps_mass(low, dtype, window):
    x, weights = scattered(500, dtype), (1.25 + numbers(500)).astype(dtype)
    mesh = pm.deposit(np.zeros((N, N, N), dtype), x, BOX, window=window, shift=0.5)
    assert np.array_equal(mesh, bits(low, dtype, x, window, 0.5))
    heavy = pm.deposit(np.zeros((N, N, N), dtype), x, BOX, weights=weights, window=window)
    assert heavy.sum(dtype=float) == pytest.approx(weights.sum(dtype=float), rel=tolerance(dtype, 500))


def test_read_out_is_the_adjoint_of_the_deposit():
    x, weights, mesh = scattered(200, np.float64), numbers(200), numbers(N**3, 9).reshape(N, N, N)
    ways = pm.deposit(np.zeros((N, N, N)), x, BOX, weights=weights) * mesh, weights * pm.read_out(mesh, x, BOX)
    assert ways[0].sum() == pytest.approx(ways[1].sum(), rel=1e-12)


def test_slabs_add_up_to_the_whole(dtype):
    x = scattered(400, dtype)
    whole = pm.deposit(np.zeros((N, N, N), dtype), x, BOX, window=Window.TSC)
    meshes = []
    for first, planes in ((0, 5), (5, 7)):
        slab = Brick.slab(N, first, planes)
        inside = (x[:, 0] >= first * BOX / N) & (x[:, 0] < (first + planes) * BOX / N)
        ghosted = slab.with_ghosts(Window.TSC)
        memory = np.zeros(ghosted.reals, dtype)
        pm.deposit(memory, x[inside], BOX, window=Window.TSC, brick=ghosted)
        meshes.append((slab, ghosted, memory))
    for slab, _, _ in meshes:
        own = np.zeros(slab.reals, dtype)
        for _, ghosted, memory in meshes:
            pm.add_cells(own, slab, memory, ghosted)
        # Cells hold a few particles, summed in another order.
        expected = whole[slab.start[0]:slab.start[0] + slab.count[0]]
        assert slab.view(own) == pytest.approx(expected, abs=tolerance(dtype, 100))
        filled = np.zeros(slab.with_ghosts().reals, dtype)
        pm.copy_cells(filled, slab.with_ghosts(), own, slab)
        assert np.array_equal(slab.with_ghosts().view(filled)[:slab.count[0]], slab.view(own))


def test_interlacing_takes_the_mean_of_two_deposits():
    fft, x, modes = Fft(N), scattered(300, np.float64), []
    for shift in (0.0, 0.5):
        data = fft.mesh()
        pm.deposit(fft.cells(data), x, BOX, shift=shift)
        modes.append(fft.forward(data).copy())
    # exp(-i k.H/2), H = L/n (1, 1, 1).
    i = np.fft.fftfreq(N, 1 / N)
    turns = (i[:, None, None] + i[:, None] + np.arange(N // 2 + 1)) * (-1j * np.pi / N)
    inner = np.ix_(np.abs(i) < N / 2, np.abs(i) < N / 2, np.arange(N // 2 + 1) < N / 2)
    expected = (modes[0] + np.exp(turns) * modes[1]) / 2
    assert pm.interlace(modes[0], modes[1])[inner] == pytest.approx(expected[inner], abs=1e-12)


def test_the_force_of_a_plane_wave_is_its_displacement(dtype):
    fft, k = Fft(N, dtype), 2 * np.pi / BOX
    wave = np.cos(2 * np.pi * np.arange(N) / N)[:, None, None] * np.ones((N, N, N))
    data = [fft.mesh() for _ in range(3)]
    fft.cells(data[0])[...] = 1 + 0.1 * wave
    density = fft.forward(data[0]).copy()
    pm.forces(*map(fft.modes, data), BOX, float(N**3))
    one = pm.force(density, 0, BOX, float(N**3))
    assert np.array_equal(one, fft.modes(data[0]))
    # F = -grad phi, laplacian phi = delta = 0.1 cos kx: F = 0.1 sin(kx)/k (-1).
    expected = -0.1 / k * np.sin(2 * np.pi * np.arange(N) / N)
    assert np.abs(fft.inverse(data[0])[:, 0, 0] - expected).max() < tolerance(dtype, 100) / k
    assert np.abs(fft.inverse(data[1])).max() < tolerance(dtype, 100) / k
    phi = fft.mesh()
    fft.modes(phi)[...] = density
    pm.potential(fft.modes(phi), BOX, float(N**3))
    assert np.abs(fft.inverse(phi) + 0.1 * wave / k**2).max() < tolerance(dtype, 100) / k**2


def test_kick_and_drift_add_what_they_say(dtype):
    x, u, psi = scattered(50, dtype), numbers(150, 7).reshape(50, 3).astype(dtype), numbers(150, 99).reshape(50, 3).astype(dtype)
    meshes, before = [np.full((N, N, N), 1.0 + axis, dtype) for axis in range(3)], (x.copy(), u.copy())
    pm.kick(u, x, meshes, BOX, keep=0.5, factor=2.0, first=0.25, psi1=psi)
    assert u == pytest.approx(0.5 * before[1] + [2, 4, 6] + 0.25 * psi, abs=tolerance(dtype, 20))
    pm.drift(x, u, BOX, factor=0.5, first=1.0, second=-1.0, psi1=psi, psi2=psi)
    away = (x - before[0] - 0.5 * u + BOX / 2) % BOX - BOX / 2
    assert np.abs(away).max() < tolerance(dtype, 4) * BOX


def test_steps_and_their_factors():
    universe = fixpair.Cosmology(omega_m=1.0, omega_de=0.0)
    assert pm.linear_steps(4, 0.2, 1.0) == pytest.approx([0.2, 0.4, 0.6, 0.8, 1.0], rel=1e-15)
    assert pm.logarithmic_steps(2, 0.25, 1.0) == pytest.approx([0.25, 0.5, 1.0], rel=1e-15)
    # Einstein-de Sitter: D = a, G = a^2 E f D = a^(3/2).
    drift, kick = pm.drift_factors(universe, 0.2, 0.4, 0.3), pm.kick_factors(universe, 0.2, 0.4, 0.3)
    assert (drift.factor, drift.first) == (pytest.approx(0.2 / 0.3**1.5, rel=1e-7), 0)
    assert kick.factor == pytest.approx((0.4**1.5 - 0.2**1.5) / 0.3, rel=1e-7)


@pytest.mark.parametrize("stepper", Stepper)
def test_a_run_grows_as_linear_theory_says(stepper):
    fft, a = Fft(16), pm.linear_steps(10, 0.05, 0.2)
    conditions = fixpair.Conditions(4, box_size=1000.0, redshift=19.0, amplitude=fixpair.Amplitude.FIXED, order=fixpair.Order.FIRST)
    x, v = fixpair.initial_conditions(conditions, fft)
    lattice = np.stack(np.meshgrid(*[np.arange(16) * 62.5] * 3, indexing="ij"), -1).reshape(-1, 3)
    psi = (x - lattice + 500) % 1000 - 500
    displacements = pm.Displacements(psi, np.zeros_like(psi), 0.05) if stepper == Stepper.COLA else None
    run = fixpair.evolve(x, v, Gravity(1000.0, stepper=stepper), a, fft, displacements=displacements)
    assert run == (0.2, 0.2, True)
    growth = cosmology.growth_factors([0.05, 0.2], conditions.cosmology).d
    found = (x - lattice + 500) % 1000 - 500
    now, before = (np.fft.fftn(each[:, 0].reshape(16, 16, 16))[1, 0, 0] for each in (found, psi))
    # The window acts twice: sinc^4(1/16) = 0.975 of the force at the longest wave.
    assert abs(now / before) == pytest.approx(growth[1] / growth[0], rel=0.025)


def test_a_run_that_was_stopped_goes_on_to_the_same_bits(dtype):
    fft, a, events = Fft(N, dtype), pm.linear_steps(5, 0.2, 1.0), []

    def particles():
        conditions = fixpair.Conditions(6, box_size=BOX, redshift=4.0)
        return fixpair.initial_conditions(conditions, fft)
    outputs = pm.Outputs(np.array([0.3, 0.9]), np.zeros((N**3, 3), dtype), np.zeros((N**3, 3), dtype))
    x, v = particles()
    fixpair.evolve(x, v, Gravity(BOX), a, fft, outputs=outputs, observe=lambda each: events.append(fixpair.Event(each.event).name))
    assert events.count("STEP") == 5 and events.count("OUTPUT") == 2 and outputs.position.any()
    y, u = particles()
    half = fixpair.evolve(y, u, Gravity(BOX), a, fft, observe=lambda each: each.step == 2)
    assert not half.finished and half.position_at == a[2] > half.velocity_at
    fixpair.evolve(y, u, Gravity(BOX), a, fft, epoch=half[:2])
    assert np.array_equal(x, y) and np.array_equal(v, u)


def test_an_exception_of_an_observer_is_raised():
    def fails(_):
        raise OSError("disk full")
    x = scattered(64, np.float64)
    with pytest.raises(OSError, match="disk full"):
        fixpair.evolve(x, np.zeros_like(x), Gravity(BOX), pm.linear_steps(3, 0.5, 1.0), Fft(8), observe=fails)


def test_bricks_of_another_space_are_refused():
    with pytest.raises(ValueError, match="configuration"):
        pm.deposit(np.zeros(Brick.whole(8, Space.FOURIER).reals), scattered(3, np.float64), BOX, brick=Brick.whole(8, Space.FOURIER))
