"""Groups, halos and spherical overdensities: the cases of Rust, and two clumps that anyone can see."""

import ctypes

import fixpair_ctypes as fixpair
from ctypes_check import BOX, Buffer, array, check, made, noise
from ctypes_estimate import filled, positions, scratch_of, sizes
from fixpair_ctypes import Cosmology, Halo, HaloSums, Layout, Sphere

PARTICLES, CLUMPED, THREADED, CLUMPS, LEAST, MASS, BORDER = 400, 300, 350, 10, 10, 1e10, 80.0
DENSITIES = (50.0, 200.0, 1000.0)
c_uint64, c_double, size_t = ctypes.c_uint64, ctypes.c_double, ctypes.c_size_t


def scalars(universe):
    library = universe.library
    check((ctypes.sizeof(Halo), ctypes.sizeof(HaloSums), ctypes.sizeof(Sphere)) == (112, 176, 24), "halos have their size")
    universe.case("linking_length", made(c_double, library.linking_length, 0.2, BOX, PARTICLES))
    universe.case("particle_mass", made(c_double, library.particle_mass, 0.27, BOX, PARTICLES))
    cosmology = made(Cosmology, library.cosmology_init)
    universe.case("overdensity", *(made(c_double, library.overdensity, kind, 200.0, cosmology, 0.5) for kind in range(3)))
    universe.case("halos_scratch", sizes(made(Layout, library.halos_scratch, PARTICLES)))


def place(i, axis):
    if CLUMPED <= i < THREADED:
        return (BOX * (i - CLUMPED) / 50.0, 77.0, 33.0)[axis]
    clump = i % CLUMPS
    centre = 0.0 if clump == 0 else BOX * (noise(7 * clump + axis) + 1.0) / 2.0
    return centre + 4.0 * noise(3 * i + axis + 9000) if i < CLUMPED else BOX * (noise(3 * i + axis) + 1.0) / 2.0


def labels_of(twin, places, ids, length):
    count = len(places.array) // 3
    labels, scratch = Buffer(c_uint64, count), scratch_of(twin.layout("fof_labels_scratch", count))
    twin.call("fof_labels", labels.start, count, positions(places), ids and ids.start, count if ids else 0, BOX, length,
              scratch.start, scratch.size, twin.run)
    return labels


def catalogue(twin, labels, places, speeds, mass=MASS):
    count, needed, found = len(labels.array), size_t(), size_t()
    scratch = scratch_of(made(Layout, twin.library.halos_scratch, count))
    twin.library.halo_count(needed, labels.start, count, LEAST, scratch.start, scratch.size, twin.run)
    halos = Buffer(Halo, needed.value)
    twin.call("halos", halos.start, needed.value, found, labels.start, count, positions(places), speeds and positions(speeds),
              BOX, LEAST, mass, scratch.start, scratch.size, twin.run)
    return halos, found.value


def first(buffer, count):
    return bytes(buffer)[:count * ctypes.sizeof(buffer.array._type_)]


def sums_of(twin, labels, places, speeds, pairs, entries):
    count, most, found = len(places.array) // 3, len(places.array) // 3 // LEAST + entries, size_t()
    sums, scratch = Buffer(HaloSums, most), scratch_of(made(Layout, twin.library.halos_scratch, count))
    twin.call("halo_sums", sums.start, most, found, labels.start, count, positions(places), positions(speeds), BOX, LEAST,
              pairs and pairs.start, entries, scratch.start, scratch.size, twin.run)
    return sums, found.value


def halos(twin):
    library = twin.library
    places = filled(twin.real, [place(i // 3, i % 3) for i in range(3 * PARTICLES)])
    speeds = filled(twin.real, [300.0 * noise(i + 5000) for i in range(3 * PARTICLES)])
    ids = filled(c_uint64, [i * 7919 % 100003 for i in range(PARTICLES)])
    length = made(c_double, library.linking_length, 0.2, BOX, PARTICLES).value
    labels, named = labels_of(twin, places, None, length), labels_of(twin, places, ids, length)
    twin.case("fof_labels", sizes(twin.layout("fof_labels_scratch", PARTICLES)), labels, named)
    without, count = catalogue(twin, named, places, None)
    found, count = catalogue(twin, named, places, speeds)
    twin.case("halo_count", filled(c_uint64, [count]))
    twin.case("halos", first(without, count), first(found, count))
    twin.case("halo_sums", first(*sums_of(twin, named, places, speeds, None, 0)))
    centres = array([x for halo in found.array[:count] for x in halo.centre])
    radii = array([min(2.0 * halo.radius, 20.0) for halo in found.array[:count]])
    layout = twin.layout("spheres_scratch", PARTICLES)
    scratch, densities, spheres = scratch_of(layout), array(list(DENSITIES)), Buffer(Sphere, 3 * count)
    twin.call("refine_centres", centres.start, count, radii.start, positions(places), BOX, 0.975, 5, scratch.start, scratch.size,
              twin.run)
    twin.case("refine_centres", centres)
    twin.call("spheres", spheres.start, 3 * count, centres.start, count, densities.start, 3, positions(places), BOX, PARTICLES,
              MASS, 5, scratch.start, scratch.size, twin.run)
    twin.case("spheres", sizes(layout), spheres)
    slabs(twin, places, speeds, ids, length)


def slabs(twin, places, speeds, ids, length):
    """Two ranks with ghosts from each other."""
    home = [x + BOX if x < 0.0 else x for x in places.array[::3]]
    rank_of, deep = [int(x >= BORDER) for x in home], 1.001 * length
    near = [abs(x - BORDER) <= deep or x <= deep or BOX - x <= deep for x in home]
    own = [[i for i in range(PARTICLES) if rank_of[i] == rank] for rank in range(2)]
    ghosts = [[i for i in range(PARTICLES) if rank_of[i] != rank and near[i]] for rank in range(2)]

    def pick(of, which):
        return filled(twin.real, [of.array[3 * i + axis] for i in which for axis in range(3)])

    labels = [labels_of(twin, pick(places, own[rank] + ghosts[rank]),
                        filled(c_uint64, [ids.array[i] for i in own[rank] + ghosts[rank]]), length) for rank in range(2)]
    there = {i: labels[rank].array[j] for rank in range(2) for j, i in enumerate(own[rank])}
    pairs = [number for rank in range(2) for j, i in enumerate(ghosts[rank])
             for number in (labels[rank].array[len(own[rank]) + j], there[i])]
    pairs, entries = filled(c_uint64, pairs), size_t()
    table = Buffer(c_uint64, 2 * len(pairs.array))
    twin.library.fof_merge(table.start, len(pairs.array), entries, pairs.start, len(pairs.array) // 2)
    entries, pieces, sums = entries.value, [first(table, 2 * entries.value)], b""
    for rank in range(2):
        sums += first(*sums_of(twin, labels[rank], pick(places, own[rank]), pick(speeds, own[rank]), table, entries))
        twin.library.fof_relabel(labels[rank].start, len(own[rank]), table.start, entries, twin.run)
        pieces.append(first(labels[rank], len(own[rank])))
    twin.case("fof_labels.slabs", *pieces)
    total, groups, count = len(sums) // ctypes.sizeof(HaloSums), size_t(), size_t()
    together = Buffer(HaloSums, total)
    ctypes.memmove(together.start, sums, len(sums))
    twin.library.halo_sums_merge(together.start, total, groups, BOX)
    found = Buffer(Halo, groups.value)
    merged = first(together, groups.value)
    twin.library.halos_finish(found.start, groups.value, count, together.start, groups.value, BOX, LEAST, MASS)
    twin.case("halos.slabs", merged, first(found, count.value))


def two_clumps(twin):
    """One across the edge of the box: both are found as they were put there."""
    centres, counts = ((0.0, 0.0, 0.0), (100.0, 50.0, 150.0)), (200, 100)
    owner = [0] * counts[0] + [1] * counts[1]
    places = filled(twin.real, [centres[clump][axis] + noise(3 * i + axis) for i, clump in enumerate(owner) for axis in range(3)])
    speeds = filled(twin.real, [speed for clump in owner for speed in ((100.0, 0.0, 0.0), (0.0, -200.0, 0.0))[clump]])
    length = made(c_double, twin.library.linking_length, 0.2, BOX, 300).value
    labels = labels_of(twin, places, None, length)
    check(list(labels.array) == [0] * 200 + [200] * 100, "two clumps are two groups")
    mass = made(c_double, twin.library.particle_mass, 0.27, BOX, 300).value
    # The critical density of the IAU's solar mass.
    check(abs(mass * 300 / (0.27 * BOX**3) / 2.77536627e11 - 1) < 1e-8, "particles make up the mean density")
    halos, count = catalogue(twin, labels, places, speeds, mass)
    check([halo.members for halo in halos.array[:count]] == [200, 100], "the larger comes first")
    check([tuple(halo.velocity) for halo in halos.array[:count]] == [(100.0, 0.0, 0.0), (0.0, -200.0, 0.0)], "each has its velocity")
    # The mean of 100 places between -1 and 1 is 0 to 0.06.
    distances = [abs((x - centre + BOX / 2) % BOX - BOX / 2) for halo, place_of in zip(halos.array, centres)
                 for x, centre in zip(halo.centre, place_of)]
    check(max(distances) < 0.3, "halos are where they were put")
