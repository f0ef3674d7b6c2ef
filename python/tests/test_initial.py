"""Initial conditions: pairs, matched universes, and the same of stages as of one call."""

import numpy as np
import pytest

import fixpair
from fixpair import Amplitude, Conditions, Fft, Order, Phase, Shape, Species, cosmology, initial
from samples import BOX, SEED, tolerance

N = 12


def conditions(**members):
    return Conditions(SEED, box_size=BOX, redshift=9.0, **members)


def moved(position, dtype):
    """Displacements from the lattice, the shortest way round."""
    lattice = np.stack(np.meshgrid(*[np.arange(N) * (BOX / N)] * 3, indexing="ij"), -1).reshape(-1, 3)
    return (position.astype(float) - lattice + BOX / 2) % BOX - BOX / 2


def test_the_library_has_the_same_bits(low, dtype):
    fft, real = Fft(N, dtype), ("f32", "f64")[dtype.itemsize // 8]
    mine = conditions(f_nl=100.0, amplitude=Amplitude.FIXED)
    particles, layout = np.zeros((2, N**3, 3), dtype), fixpair.native.Layout()
    with fft.use() as hook:
        getattr(low, f"initial_conditions_scratch_{real}")(layout, mine, hook, None)
        memory = fixpair.workspace.aligned(layout.size)
        structures = [fixpair.native.Components(*(start + axis * dtype.itemsize for axis in range(3)), 3, N**3)
                      for start in (particles.ctypes.data, particles[1].ctypes.data)]
        getattr(low, f"initial_conditions_{real}")(*structures, mine, hook, None, memory, memory.size, None)
    found = fixpair.initial_conditions(mine, fft)
    assert np.array_equal(found[0], particles[0]) and np.array_equal(found[1], particles[1])


def test_a_pair_moves_opposite_ways_at_first_order(dtype):
    fft = Fft(N, dtype)
    one, other = (fixpair.initial_conditions(conditions(order=Order.FIRST, phase=phase), fft) for phase in Phase)
    assert np.array_equal(one[1], -other[1])
    # Positions are rounded at the size of the box.
    assert np.abs(moved(one[0], dtype) + moved(other[0], dtype)).max() < tolerance(dtype, 4) * BOX


def test_matched_universes_share_their_phases():
    fft = Fft(N)
    one, other = (fixpair.initial_conditions(conditions(f_nl=f_nl), fft)[1] for f_nl in (0.0, 100.0))
    assert not np.array_equal(one, other)
    assert np.corrcoef(one.ravel(), other.ravel())[0, 1] > 0.999


def test_particles_go_into_the_arrays_of_the_host(dtype):
    fft = Fft(N, dtype)
    record = np.zeros(N**3, [("id", np.uint64), ("pos", dtype, 3), ("vel", dtype, 3)])
    position, velocity = record["pos"], record["vel"]
    found = fixpair.initial_conditions(conditions(), fft, position=position, velocity=velocity)
    assert found[0] is position and found[1] is velocity
    expected = fixpair.initial_conditions(conditions(), fft)
    assert np.array_equal(record["pos"], expected[0]) and np.array_equal(record["vel"], expected[1])
    record["id"] = initial.particle_ids(N, 1)
    assert np.array_equal(record["id"], np.arange(1, N**3 + 1))


def stages(mine, fft, fine):
    """What initial_conditions does, one stage after another."""
    dtype, universe = fft.dtype, mine.cosmology
    table = cosmology.potential_amplitude_table(N, BOX, universe, mine.linear)
    phi = fixpair.white_modes(fft.fourier, mine.realisation, dtype=dtype, amplitude=table)
    initial.add_local(phi, mine.f_nl, mine.g_nl, fine)
    density = initial.scale_modes(phi, cosmology.alpha_table(N, BOX, universe, mine.linear, mine.redshift))
    source = initial.second_order_source(density, fine)
    a = 1 / (1 + mine.redshift)
    growth = cosmology.growth_factors(a, universe)[0]
    speed = 100 * a * cosmology.expansion(a, universe)[0]
    position, velocity = np.zeros((N**3, 3), dtype), np.zeros((N**3, 3), dtype)
    for axis in range(3):
        psi1 = initial.displacement(density, axis, BOX / (2 * np.pi), fft)
        psi2 = initial.displacement(source, axis, -growth.d2 / growth.d**2 * BOX / (2 * np.pi), fft)
        initial.displace(position, velocity, psi1, psi2, axis, BOX, speed * growth.f, speed * growth.f2)
    return position, velocity


def test_stages_are_initial_conditions(dtype):
    mine, fft, fine = conditions(f_nl=100.0), Fft(N, dtype), Fft(18, dtype)
    found, expected = stages(mine, fft, fine), fixpair.initial_conditions(mine, fft, fine)
    # Factors here and there are products in another order: roundings of the largest.
    for one, other in zip(found, expected):
        assert np.abs(one - other).max() <= tolerance(dtype, 4) * np.abs(other).max()


def test_the_third_order_is_that_of_its_sources(dtype):
    fft, mine = Fft(N, dtype), conditions()
    density = fft.mesh()
    table = cosmology.potential_amplitude_table(N, BOX, mine.cosmology, mine.linear)
    modes = fixpair.white_modes(N, mine.realisation, amplitude=table, out=fft.modes(density))
    initial.scale_modes(modes, cosmology.alpha_table(N, BOX, mine.cosmology, mine.linear, mine.redshift))
    sources = initial.third_order_sources(density, fft)
    growth, side = cosmology.growth_factors(0.1, mine.cosmology)[0], BOX / (2 * np.pi)
    second = fixpair.initial_conditions(conditions(), fft, Fft(18, dtype))[0]
    third = fixpair.initial_conditions(conditions(order=Order.THIRD), fft)[0]
    for axis in range(3):
        psi = sum(initial.displacement(source, axis, factor * side, fft).ravel() for source, factor in (
            (sources.determinant, growth.d3a / growth.d**3), (sources.mixed, growth.d3b / growth.d**3)))
        psi = psi + initial.transverse_displacement(sources, axis, growth.d3c / growth.d**3 * side, fft).ravel()
        found = (third[:, axis] - second[:, axis] + BOX / 2) % BOX - BOX / 2
        # Rounding of positions, of the size of the box; the second order aliases in neither.
        assert np.abs(found - psi).max() < tolerance(dtype, 4) * BOX


def test_glass_positions_on_the_lattice_are_the_lattice(dtype):
    fft, mine = Fft(N, dtype), conditions()
    lattice = np.stack(np.meshgrid(*[np.arange(N) * (BOX / N)] * 3, indexing="ij"), -1).reshape(-1, 3).astype(dtype)
    found, expected = initial.initial_conditions_at(lattice, mine, fft), fixpair.initial_conditions(mine, fft)
    assert np.abs(found[1] - expected[1]).max() < tolerance(dtype, 1000) * np.abs(expected[1]).max()


def test_shapes_are_rows(dtype):
    fft, rows = Fft(N, dtype), initial.shape_rows(Shape.EQUILATERAL)
    assert rows.dtype == initial.SHAPE_ROW and np.abs(rows["s_out"] + rows["s_a"] + rows["s_b"]).max() < 1e-12
    by_name, by_rows = (fixpair.initial_conditions(conditions(f_nl=500.0, **shape), fft)[0]
                        for shape in ({"shape": Shape.EQUILATERAL}, {"shape": Shape.ROWS, "rows": rows}))
    assert np.array_equal(by_name, by_rows)
    phi = fixpair.white_modes(N, fixpair.Realisation(1), dtype=dtype)
    one, other = phi.copy(), phi.copy()
    initial.add_local(one, 0.1, 0.0, fft)
    initial.add_shape(other, 0.1, 0.96, initial.shape_rows(Shape.LOCAL), fft)
    # Two ways to the same products.
    assert np.abs(one - other).max() < tolerance(dtype, 100)


def test_a_species_that_is_all_matter_is_all_matter():
    fft, k = Fft(N), np.geomspace(1e-4, 10, 100)
    f = cosmology.growth_factors(0.1, fixpair.Cosmology()).f[0]
    species = Species(k, np.ones(100), np.ones(100), np.full(100, f))
    one, other = fixpair.initial_conditions(conditions(species=species), fft), fixpair.initial_conditions(conditions(), fft)
    # Ratios of 1 are interpolated to rounding.
    assert np.abs(one[1] - other[1]).max() < 1e-9 * np.abs(other[1]).max()


def test_modes_travel_between_meshes(dtype):
    coarse, fine = (fixpair.white_modes(n, fixpair.Realisation(SEED), dtype=dtype) for n in (8, 12))
    copy = np.full_like(coarse, np.nan)
    assert np.array_equal(initial.copy_modes(copy, fine), coarse)


def test_arrays_of_another_size_are_refused(dtype):
    with pytest.raises(ValueError, match="particles"):
        fixpair.initial_conditions(conditions(), Fft(N, dtype), position=np.zeros((5, 3), dtype))
