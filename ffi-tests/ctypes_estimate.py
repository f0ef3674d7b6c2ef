"""Particles and meshes, spectra, correlation functions and bispectra: the cases of Rust, and known answers."""

import ctypes

import fixpair_ctypes as fixpair
from ctypes_check import BOX, N, PADDING, SEED, Buffer, array, check, doubles, elements, integers, made, noise
from fixpair_ctypes import Bin, Binning, Brick, Layout, Positions, Realisation

PARTICLES, SHELLS = 500, 5
EDGES = (1, 4, 9, 16, 25, 36, 49)
size_t, c_uint64, c_double = ctypes.c_size_t, ctypes.c_uint64, ctypes.c_double


def filled(kind, values):
    buffer = Buffer(kind, len(values))
    buffer.array[:] = values
    return buffer


def sizes(layout):
    return integers(layout.size, layout.align)


def scratch_of(layout):
    return Buffer(ctypes.c_uint8, layout.size)


def pairs_of(*pairs):
    return filled(size_t, [number for pair in pairs for number in pair])


def edges_of(values=EDGES):
    return filled(c_uint64, values)


def binning_of(library, edges, **members):
    binning = made(Binning, library.binning_init, edges.start, len(edges.array))
    check(binning.struct_size == ctypes.sizeof(Binning) and ctypes.sizeof(Bin) == 24, "structs have the library's size")
    for name, value in members.items():
        setattr(binning, name, value)
    return binning


def lengths(library, binning, spectra):
    numbers = [size_t() for _ in range(3)]
    library.binning_lengths(*numbers, binning, spectra)
    return [number.value for number in numbers]


def read(library, sums, binning, spectra, factor=None, noises=None, pairs=None):
    """Bins and values."""
    bins_len, values_len, _ = lengths(library, binning, spectra)
    bins, values = Buffer(Bin, bins_len), Buffer(c_double, values_len)
    library.binning_read(bins.start, bins_len, values.start, values_len, sums.start, len(sums.array), binning, spectra)
    if factor is not None:
        library.binning_normalise(values.start, values_len, bins.start, bins_len, binning.orders, factor)
    if noises is not None:
        library.subtract_shot_noise(values.start, values_len, pairs.start, spectra, bins.start, bins_len, binning.orders,
                                    noises.start, len(noises.array))
    return bins, values


def closed(library, edges, centres=None):
    count = made(size_t, library.closed_triangle_count, edges.start, len(edges.array), centres and centres.start).value
    triangles = Buffer(ctypes.c_uint32, 3 * count)
    library.closed_triangles(triangles.start, count, edges.start, len(edges.array), centres and centres.start)
    return triangles, count


def counts_of(library, run, triangles, count, edges, n):
    layout = made(Layout, library.triangle_counts_scratch, triangles.start, count, edges.start, len(edges.array), n)
    scratch, counts = scratch_of(layout), Buffer(c_uint64, count)
    library.triangle_counts(counts.start, triangles.start, count, edges.start, len(edges.array), n, scratch.start,
                            scratch.size, run)
    return layout, counts


def bins(universe):
    library, wedges = universe.library, array([0.0, 0.25, 0.5, 0.75, 1.0])
    slab = made(Brick, library.brick_slab, N, fixpair.CONFIGURATION, 5, 7)
    ghosted = [made(Brick, library.brick_with_ghosts, slab, window, shift)
               for window in (fixpair.NGP, fixpair.CIC, fixpair.TSC, fixpair.PCS) for shift in (0.0, 0.5)]
    universe.case("brick_with_ghosts", *(integers(b.n, *b.start, *b.count, *b.stride) for b in ghosted))
    three, wavenumbers = Buffer(c_uint64, 15), array([0.03, 0.06, 0.1, 0.2, 0.4])
    library.edges_uniform(three.start, 5, 1.5, 3.0)
    library.edges_wavenumbers(three.at(5), wavenumbers.start, 5, BOX)
    library.edges_exact(three.at(10), 5, 3)
    universe.case("edges", three)
    binning = binning_of(library, edges_of(), second=fixpair.COSINE, second_edges=wedges.start, second_edges_len=5,
                         orders=3)
    universe.case("binning_lengths", integers(*lengths(library, binning, 3)))
    shells, squeezed = edges_of(EDGES[:SHELLS + 1]), Buffer(ctypes.c_uint32, 3 * (SHELLS - 1))
    triangles, count = closed(library, shells)
    library.squeezed_triangles(squeezed.start, SHELLS - 1, 1, SHELLS)
    universe.case("triangles", triangles, closed(library, shells, array([1.0, 2.0, 3.0, 4.0, 5.0]))[0], squeezed)
    layout, counts = counts_of(library, universe.run, triangles, count, shells, N)
    universe.case("triangle_counts", sizes(layout), counts)


def positions(buffer):
    size = ctypes.sizeof(buffer.array._type_)
    return Positions(buffer.start, buffer.start + size, buffer.start + 2 * size, 3, len(buffer.array) // 3)


def deposit(twin, mesh, region, places, weights, window, shift):
    layout = twin.layout("deposit_scratch", region, len(places.array) // 3, window)
    scratch = scratch_of(layout)
    twin.call("deposit", mesh.start, len(mesh.array), region, positions(places), weights and weights.start, 1, BOX, window,
              shift, scratch.start, scratch.size, twin.run)
    return sizes(layout)


def read_out(twin, mesh, region, places, window, shift):
    count = len(places.array) // 3
    scratch, values = scratch_of(twin.layout("read_out_scratch", region, count, window)), Buffer(twin.real, count)
    twin.call("read_out", values.start, 1, mesh.start, len(mesh.array), region, positions(places), BOX, window, shift,
              scratch.start, scratch.size, twin.run)
    return values


def particles(twin):
    """All cases of particles and meshes in one precision."""
    library = twin.library
    cells = made(Brick, library.brick_whole, N, fixpair.CONFIGURATION, PADDING)
    length = twin.universe.reals(cells)
    places = filled(twin.real, [BOX * noise(i) for i in range(3 * PARTICLES)])
    weights = filled(twin.real, [1.25 + noise(5 * i) for i in range(PARTICLES)])
    pieces = []
    for window in (fixpair.NGP, fixpair.CIC, fixpair.TSC, fixpair.PCS):
        for shift in (0.0, 0.5):
            mesh = Buffer(twin.real, length)
            pieces.append(deposit(twin, mesh, cells, places, weights if window > 2 else None, window, shift))
            pieces.append(elements(mesh, cells))
            total = sum(mesh.array)
            expected = sum(weights.array) if window > 2 else PARTICLES
            # Sums of 500 numbers near 1 in the precision of the mesh.
            check(abs(total / expected - 1) < (1e-5 if twin.suffix == "f32" else 1e-13), "mass is conserved")
    twin.case("deposit", *pieces)
    mesh = filled(twin.real, [noise(i) for i in range(length)])
    twin.case("read_out", *(read_out(twin, mesh, cells, places, window, 0.25 * (window - 1)) for window in range(1, 5)))
    fft, both = twin.transform(N), []
    for shift in (0.0, 0.5):
        mesh = Buffer(twin.real, fft.length)
        deposit(twin, mesh, fft.configuration, places, None, fixpair.TSC, shift)
        fft.forward(fft.context, mesh.start)
        both.append(mesh)
    twin.call("interlace", both[0].start, both[1].start, fft.length, fft.fourier, twin.run)
    twin.case("interlace", elements(both[0], fft.fourier))
    # Two ranks.
    ranks, planes = ([], []), ((0, 5), (5, 7))
    for i in range(PARTICLES):
        place = [twin.real(BOX * (noise(3 * i + axis) + 1.0) / 2.0).value for axis in range(3)]
        ranks[place[0] * N >= 5 * BOX].extend(place)
    own = [made(Brick, library.brick_slab, N, fixpair.CONFIGURATION, *plane) for plane in planes]
    wide = [made(Brick, library.brick_with_ghosts, brick, fixpair.PCS, 0.5) for brick in own]
    meshes = [Buffer(twin.real, twin.universe.reals(brick)) for brick in own]
    ghosts = [Buffer(twin.real, twin.universe.reals(brick)) for brick in wide]
    places = [filled(twin.real, rank) for rank in ranks]
    for rank in range(2):
        deposit(twin, ghosts[rank], wide[rank], places[rank], None, fixpair.PCS, 0.5)
    moves = [(rank, other) for rank in range(2) for other in range(2)]
    for rank, other in moves:
        twin.call("add_cells", meshes[rank].start, len(meshes[rank].array), own[rank], ghosts[other].start,
                  len(ghosts[other].array), wide[other], twin.run)
    twin.case("deposit.slabs", *map(elements, meshes, own))
    for ghost in ghosts:
        ctypes.memset(ghost.start, 0, ghost.size)
    for rank, other in moves:
        twin.call("copy_cells", ghosts[rank].start, len(ghosts[rank].array), wide[rank], meshes[other].start,
                  len(meshes[other].array), own[other], twin.run)
    twin.case("read_out.slabs", *(read_out(twin, *each, fixpair.PCS, 0.5) for each in zip(ghosts, wide, places)))


class Estimates:
    """All cases of spectra and what follows, in one precision."""

    def __init__(self, twin):
        self.twin, self.library = twin, twin.library
        self.fft = twin.transform(N)
        self.brick, self.length = self.fft.fourier, self.fft.length
        self.f = twin.white(self.brick, twin.realisation())
        self.g = twin.white(self.brick, twin.realisation(amplitude=fixpair.FIXED, phase=fixpair.INVERTED))

    def run(self):
        self.powers()
        self.compensations()
        self.correlations()
        self.bispectra()

    def sums(self, name, binning, meshes, brick, pairs=None, compensation=None):
        spectra = len(meshes) if pairs is None else len(pairs.array) // 2
        layout = made(Layout, getattr(self.library, name + "_scratch"), brick, binning, spectra)
        scratch, sums = scratch_of(layout), Buffer(ctypes.c_int64, lengths(self.library, binning, spectra)[2])
        pointers = filled(ctypes.c_void_p, [mesh.start for mesh in meshes])
        more = () if pairs is None else (pairs.start, spectra, compensation.start)
        self.twin.call(name, sums.start, len(sums.array), pointers.start, len(meshes), self.length, *more, brick, binning,
                       scratch.start, scratch.size, self.twin.run)
        return layout, sums

    def powers(self):
        library, both = self.library, (self.f, self.g)
        pairs, aliased = pairs_of((0, 0), (0, 1)), filled(ctypes.c_int32, [0, fixpair.ALIASED + fixpair.CIC])
        binning = binning_of(library, edges_of(), axis=(0, 0, 2), orders=21)
        layout, sums = self.sums("power_sums", binning, both, self.brick, pairs, aliased)
        self.twin.case("power_sums", sizes(layout), sums)
        self.twin.case("power", *read(library, sums, binning, 2, BOX * BOX * BOX, array([1.5, 2.5]), pairs))
        wedges = array([0.0, 0.25, 0.5, 0.75, 1.0])
        binning = binning_of(library, edges_of(), second=fixpair.COSINE, second_edges=wedges.start, second_edges_len=5,
                             orders=3)
        windows = filled(ctypes.c_int32, [fixpair.WINDOW + fixpair.TSC] * 2)
        _, sums = self.sums("power_sums", binning, both, self.brick, pairs_of((0, 0), (1, 1), (1, 0)), windows)
        self.twin.case("power.wedges", sums, *read(library, sums, binning, 3))
        weights, noises = filled(self.twin.real, [1.25 + noise(5 * i) for i in range(500)]), [c_double(), c_double()]
        self.twin.call("shot_noise", noises[1], None, 0, 500, BOX)
        self.twin.call("shot_noise", noises[0], weights.start, 1, 500, BOX)
        check(noises[1].value == BOX**3 / 500, "equal particles have the noise V/N")
        self.twin.case("shot_noise", doubles(*(noise.value for noise in noises)))

    def compensations(self):
        layout = made(Layout, self.library.compensate_scratch, self.brick)
        scratch, pieces = scratch_of(layout), [sizes(layout)]
        modes = filled(self.twin.real, list(self.f.array))
        for compensation, scale in ((fixpair.WINDOW + fixpair.TSC, 0.3), (fixpair.ALIASED + fixpair.PCS, -2.0)):
            self.twin.call("compensate", modes.start, self.length, compensation, scale, self.brick, scratch.start,
                           scratch.size, self.twin.run)
            pieces.append(elements(modes, self.brick))
        self.twin.case("compensate", *pieces)

    def correlations(self):
        layout = made(Layout, self.library.correlation_modes_scratch, self.brick)
        scratch, meshes, pieces = scratch_of(layout), [], [sizes(layout)]
        for other in (None, self.g):
            mesh = filled(self.twin.real, list(self.f.array))
            self.twin.call("correlation_modes", mesh.start, other and other.start, self.length,
                           fixpair.WINDOW + fixpair.CIC, fixpair.ALIASED + fixpair.PCS, 0.5, self.brick, scratch.start,
                           scratch.size, self.twin.run)
            pieces.append(elements(mesh, self.brick))
            self.fft.inverse(self.fft.context, mesh.start)
            meshes.append(mesh)
        self.twin.case("correlation_modes", *pieces)
        parallel = array([0.0, 1.0, 3.0, 7.0])
        binning = binning_of(self.library, edges_of(), second=fixpair.PARALLEL, second_edges=parallel.start,
                             second_edges_len=4)
        layout, sums = self.sums("correlation_sums", binning, meshes, self.fft.configuration)
        self.twin.case("correlation", sizes(layout), sums, *read(self.library, sums, binning, 2, 1.0))

    def bispectra(self):
        twin, library, fft, length = self.twin, self.library, self.fft, self.length
        edges = edges_of(EDGES[:SHELLS + 1])
        triangles, count = closed(library, edges)
        words = fixpair.BISPECTRUM_WORDS * count
        shells, pieces = [Buffer(twin.real, length) for _ in range(SHELLS)], []
        for number, shell in enumerate(shells):
            twin.call("shell_modes", shell.start, self.f.start, length, fft.fourier, EDGES[number], EDGES[number + 1],
                      twin.run)
            pieces.append(elements(shell, fft.fourier))
            fft.inverse(fft.context, shell.start)
        twin.case("shell_modes", *pieces)
        first = twin.layout("bispectrum_sums_scratch", fft.configuration, SHELLS, count)
        second = twin.layout("bispectrum_scratch", fft, SHELLS, count)
        scratch, sums, pieces = scratch_of(first), Buffer(ctypes.c_int64, words), [sizes(first), sizes(second)]
        pointers = filled(ctypes.c_void_p, [shell.start for shell in shells])
        twin.call("bispectrum_sums", sums.start, words, triangles.start, count, pointers.start, SHELLS, length, fft.configuration,
                  scratch.start, scratch.size, twin.run)
        twin.case("bispectrum_sums", sums)
        scratch = scratch_of(second)
        for meshes in (3, SHELLS):
            reals = size_t()
            twin.call("bispectrum_meshes", reals, fft, meshes)
            memory, transforms, again = Buffer(twin.real, reals.value), size_t(), Buffer(ctypes.c_int64, words)
            twin.call("bispectrum", again.start, words, transforms, triangles.start, count, edges.start, SHELLS + 1, self.f.start,
                      length, fft, memory.start, reals.value, scratch.start, scratch.size, twin.run)
            check(bytes(again) == bytes(sums), f"{meshes} meshes make the same sums")
            pieces.append(integers(reals.value, transforms.value))
        twin.case("bispectrum_sizes", *pieces)
        values, noises, reduced = (Buffer(c_double, count) for _ in range(3))
        _, counts = counts_of(library, twin.run, triangles, count, edges, N)
        power = array([100.0, 200.0, 300.0, 400.0, 500.0])
        library.bispectrum_values(values.start, count, sums.start, words)
        library.bispectrum_normalise(values.start, counts.start, count, N, BOX, 0.75)
        library.bispectrum_shot_noise(noises.start, triangles.start, count, power.start, SHELLS, 3.5)
        library.bispectrum_reduced(reduced.start, values.start, triangles.start, count, power.start, SHELLS)
        twin.case("bispectrum", values, noises, reduced)


def physics(library, run):
    """Numbers that anyone can check: modes and triangles of shells, the power of a fixed field."""
    shells = edges_of([n * n for n in range(1, 8)])
    brick = made(Brick, library.brick_whole, 16, fixpair.FOURIER, 0)
    realisation = made(Realisation, library.realisation_init, SEED)
    realisation.amplitude = fixpair.FIXED
    modes = Buffer(c_double, made(size_t, library.brick_reals, brick).value)
    library.white_modes_f64(modes.start, len(modes.array), brick, realisation, None, 0, run)
    binning = binning_of(library, shells)
    layout = made(Layout, library.power_sums_scratch, brick, binning, 1)
    scratch, sums = scratch_of(layout), Buffer(ctypes.c_int64, lengths(library, binning, 1)[2])
    pointers, pairs = filled(ctypes.c_void_p, [modes.start]), pairs_of((0, 0))
    library.power_sums_f64(sums.start, len(sums.array), pointers.start, 1, len(modes.array), pairs.start, 1, None, brick,
                           binning, scratch.start, scratch.size, run)
    found, power = read(library, sums, binning, 1, 8.0)
    check([each.count for each in found.array] == [26, 66, 158, 234, 410, 470], "floor shells hold 26, 66, 158... modes")
    # |w| = 1 to a few ulp.
    check(all(abs(value - 8) < 1e-14 for value in power.array), "a fixed field has exactly the input power")
    # Nearest-bin shells of 3 k_f; 24 is more than the sum of three upper radii of 7.5.
    edges = Buffer(c_uint64, 3)
    library.edges_uniform(edges.start, 3, 1.5, 3.0)
    triangles = filled(ctypes.c_uint32, [0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 1])
    _, counts = counts_of(library, run, triangles, 4, edges, 24)
    check(list(counts.array) == [54066, 71166, 225724, 470232], "shells of 3 k_f close 54066, 71166... triangles")
