"""Species, shapes, the third order and positions of the host's own: the cases of Rust, and what anyone knows of them."""

import ctypes

import fixpair_ctypes as fixpair
from ctypes_check import BOX, FINE, FINER, N, PADDING, ROWS, SEED, Buffer, array, check, elements, integers, made, noise, triples
from ctypes_estimate import filled, positions, scratch_of, sizes
from fixpair_ctypes import Conditions, Realisation, ShapeRow, Species

OWN = 500
KERNEL = ((2.0, 0.0, 0.0, 0.0), (-1.5, -1.0, 0.0, 1.0), (0.5, 1.0, -0.5, -0.5))
# Order, shape, side of the finer mesh, g_NL, species (and whether it has a reference), and whether from positions of its own too.
UNIVERSES = {
    "third": (fixpair.THIRD, fixpair.LOCAL, None, 0.0, None, True),
    "third_exact": (fixpair.THIRD, fixpair.LOCAL, FINE, 0.0, None, False),
    "equilateral": (fixpair.SECOND, fixpair.EQUILATERAL, None, 0.0, None, False),
    "equilateral_exact": (fixpair.SECOND, fixpair.EQUILATERAL, FINE, 0.0, None, True),
    "rows": (fixpair.SECOND, fixpair.ROWS, None, 0.0, None, False),
    "rows_cubic": (fixpair.SECOND, fixpair.ROWS, FINER, 1e5, None, False),
    "species": (fixpair.SECOND, fixpair.LOCAL, None, 0.0, False, False),
    "species_reference": (fixpair.SECOND, fixpair.LOCAL, FINE, 0.0, True, False),
    "species_first": (fixpair.FIRST, fixpair.LOCAL, None, 0.0, False, True),
    "species_third": (fixpair.THIRD, fixpair.LOCAL, None, 0.0, True, False),
    "everything": (fixpair.THIRD, fixpair.ROWS, FINER, 1e5, True, True),
}


def columns(universe):
    """k, T_m, T_s, V_s, and what the linear spectrum stands for."""
    squares = [float(row) * float(row) for row in range(1, ROWS + 1)]
    k, _, matter = universe.rows()
    others = ((1.25, 0.0625), (0.875, 0.04), (1.0, 0.045))
    return [k, matter] + [array([top / (1.0 + slope * square) for square in squares]) for top, slope in others]


def species(library, of, reference):
    result = made(Species, library.species_init)
    result.rows = ROWS
    result.k, result.matter, result.density, result.velocity = (column.start for column in of[:4])
    result.reference = of[4].start if reference else None
    return result


def tables(universe):
    library = universe.library
    empty, of, pieces = made(Species, library.species_init), columns(universe), []
    check(empty.struct_size == ctypes.sizeof(empty), "a species has the size of the header")
    check(not any((empty.k, empty.matter, empty.density, empty.velocity, empty.reference, empty.rows)), "a species has no columns")
    for reference in (False, True):
        for ratio in (fixpair.RATIO_MATTER, fixpair.RATIO_DENSITY, fixpair.RATIO_VELOCITY):
            table = Buffer(ctypes.c_double, universe.table_length)
            library.species_table(table.start, universe.table_length, species(library, of, reference), ratio, N, BOX, universe.run)
            pieces.append(table)
    universe.case("species_table", *pieces)


def conditions(twin, order, shape, g_nl, one):
    result = made(Conditions, twin.library.conditions_init, SEED)
    check(result.struct_size == ctypes.sizeof(result), "conditions have the size of the header")
    result.box_size, result.f_nl, result.g_nl, result.order, result.shape = BOX, 100.0, g_nl, order, shape
    result.realisation.amplitude, result.realisation.phase = fixpair.FIXED, fixpair.INVERTED
    rows = (ShapeRow * len(KERNEL))(*KERNEL)
    result.rows_len, result.rows = len(KERNEL), ctypes.addressof(rows)
    result.species = ctypes.addressof(one) if one else None
    # Structures do not keep alive what they point to by address.
    result._borrowed = rows, one
    return result


def universes(twin):
    of = columns(twin.universe)
    transforms = {side: twin.transform(side) for side in (N, FINE, FINER)}
    for name, (order, shape, side, g_nl, reference, at) in UNIVERSES.items():
        one = None if reference is None else species(twin.library, of, reference)
        fine = transforms.get(side)
        asked = conditions(twin, order, shape, g_nl, one)
        twin.particles(name, asked, transforms[N], fine)
        if at:
            particles_at(twin, name, asked, transforms[N], fine)


def particles_at(twin, name, asked, fft, fine):
    begin = filled(twin.real, [BOX * noise(i) for i in range(3 * OWN)])
    layout = twin.layout("initial_conditions_at_scratch", asked, OWN, fft, fine)
    scratch, memory = scratch_of(layout), [Buffer(twin.real, 3 * OWN) for _ in range(2)]
    position, velocity = (triples(buffer.start, twin.size, OWN) for buffer in memory)
    before = bytes(begin)
    twin.call("initial_conditions_at", position, velocity, positions(begin), asked, fft, fine, scratch.start, scratch.size,
              twin.run)
    check(bytes(begin) == before, "where particles begin is only read")
    twin.case(f"initial_at.{name}", sizes(layout), *memory)


def third_order(twin):
    fft, universe = twin.transform(N, PADDING), twin.universe
    normal = made(Realisation, twin.library.realisation_init, SEED)
    length = universe.reals(fft.fourier)
    density = Buffer(twin.real, length)
    twin.call("white_modes", density.start, length, fft.fourier, normal, universe.amplitude.start, universe.table_length, twin.run)
    twin.call("scale_modes", density.start, length, fft.fourier, universe.transfer.start, universe.table_length, twin.run)
    layout = twin.layout("third_order_sources_scratch", fft)
    scratch, out = scratch_of(layout), [Buffer(twin.real, length) for _ in range(6)]
    twin.call("third_order_sources", *(modes.start for modes in out), density.start, length, fft, scratch.start, scratch.size,
              twin.run)
    twin.case("third_order_sources", sizes(layout), *(elements(modes, fft.fourier) for modes in out))
    pieces = []
    for axis in range(3):
        psi = Buffer(twin.real, fft.length)
        twin.call("transverse_displacement", psi.start, fft.length, *(modes.start for modes in out[3:]), length, axis, 32.0, fft,
                  twin.run)
        pieces.append(elements(psi, fft.configuration))
    twin.case("transverse_displacement", *pieces)


def einstein_de_sitter(library):
    """D2 = -3/7 a^2, D3a = -1/3 a^3, D3b = 5/21 a^3, D3c = 1/7 a^3 where there is nothing but matter."""
    cosmology = made(fixpair.Cosmology, library.cosmology_init)
    cosmology.omega_m, cosmology.omega_de, cosmology.omega_r = 1.0, 0.0, 0.0
    a, growth = array([0.1, 0.5, 1.0]), Buffer(fixpair.Growth, 3)
    library.growth_factors(growth.start, a.start, 3, cosmology)
    for time, g in zip(a.array, growth.array):
        found = (g.d, g.d2, g.d3a, g.d3b, g.d3c, g.f, g.f2, g.f3a, g.f3b, g.f3c)
        expected = (time, -3 / 7 * time**2, -1 / 3 * time**3, 5 / 21 * time**3, 1 / 7 * time**3, 1, 2, 3, 3, 3)
        # The header gives 1e-9 for the higher orders.
        check(all(abs(x / y - 1) < 1e-8 for x, y in zip(found, expected)), f"growth without dark energy at a = {time}")


def initial(twin):
    universes(twin)
    third_order(twin)
