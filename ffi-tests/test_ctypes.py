"""Every function from Python, with the standard library alone: the bits of Rust, and refusals that touch nothing.

test_ctypes.py LIBRARY CASES HEADER
"""

import ctypes
import re
import sys

import ctypes_estimate
import ctypes_gravity
import ctypes_halos
import ctypes_initial
import ctypes_shape
import ctypes_variance
import fixpair_ctypes as fixpair
from ctypes_check import (BOX, FINE, FINER, N, PADDING, ROWS, SEED, Buffer, array, check, claims, doubles, elements,
                          failures, fnv, integers, made, noise, parallel_for, triples)
from fixpair_ctypes import Brick, Conditions, Exec, Layout, Linear, Realisation

class Universe:
    """All cases through one library and executor."""

    def __init__(self, library, cases, run):
        self.library, self.cases, self.run = library, cases, run

    def case(self, name, *pieces):
        check(self.cases.get(name) == fnv(*pieces), f"{name} has the bits of Rust")

    def rows(self):
        squares = [float(row) * float(row) for row in range(1, ROWS + 1)]
        k = array([0.0005 * square for square in squares])
        power = array([20000.0 / (1.0 + 0.05 * square) for square in squares])
        transfer = array([1.0 / (1.0 + 0.05 * square) for square in squares])
        return k, power, transfer

    def bricks(self):
        whole = made(Brick, self.library.brick_whole, N, fixpair.FOURIER, 0)
        general = Brick(N, fixpair.FOURIER, (0, 0, 0), (N, N, N // 2 + 1), (1, N + 1, N * (N + 1) + 2))
        return {
            "whole": whole,
            "padded": made(Brick, self.library.brick_whole, N, fixpair.FOURIER, PADDING),
            "slab": made(Brick, self.library.brick_slab, N, fixpair.FOURIER, 3, 5),
            "transposed": made(Brick, self.library.brick_transposed_slab, N, 2, 7),
            "general": general,
        }

    def reals(self, brick):
        return made(ctypes.c_size_t, self.library.brick_reals, brick).value

    def scalars(self):
        library = self.library
        self.case("status_message", *(library.status_message(-i) for i in range(1 - fixpair.SINGULAR)))
        check(b"unknown" in library.status_message(fixpair.SINGULAR - 1), "an unknown status has a message")
        self.case("version", library.version())
        block = (ctypes.c_uint32 * 4)()
        library.philox4x32_10(block, (ctypes.c_uint32 * 4)(1, 2, 3, 4), (ctypes.c_uint32 * 2)(5, 6))
        self.case("philox4x32_10", block)
        uniforms = Buffer(ctypes.c_double, 40)
        library.ranlxd1(uniforms.start, 40, SEED)
        self.case("ranlxd1", uniforms)
        for name, brick in self.bricks().items():
            columns = brick.count[0] * brick.count[1]
            seeds = Buffer(ctypes.c_uint32, columns)
            library.ngenic_seeds(seeds.start, columns, brick, SEED)
            self.case(f"ngenic_seeds.{name}", seeds)
        r = made(Realisation, library.realisation_init, SEED)
        check(r.struct_size == ctypes.sizeof(r), "a realisation has the size of the header")
        self.case("realisation_init", integers(r.seed, r.scheme, r.amplitude, r.phase, r.nyquist, r.selection, r.sample))
        for name, b in self.bricks().items():
            numbers = [b.n, b.space, *b.start, *b.count, *b.stride, self.reals(b)]
            self.case(f"brick.{name}", integers(*numbers))
        self.case("fft_next_side", integers(*map(library.fft_next_side, range(400))))
        slab = made(Brick, library.brick_slab, N, fixpair.CONFIGURATION, 3, 5)
        ids = Buffer(ctypes.c_uint64, 5 * N * N)
        library.particle_ids(ids.start, 5 * N * N, slab, 1, self.run)
        self.case("particle_ids", ids)

    def cosmologies(self):
        library = self.library
        c = made(fixpair.Cosmology, library.cosmology_init)
        check(c.struct_size == ctypes.sizeof(c), "a cosmology has the size of the header")
        members = (c.omega_m, c.omega_de, c.omega_r, c.omega_b, c.h, c.n_s, c.w0, c.wa, c.t_cmb)
        self.case("cosmology_init", doubles(*members))
        full = made(fixpair.Cosmology, library.cosmology_init)
        full.omega_de, full.omega_r, full.w0, full.wa = 0.7, 1e-4, -0.9, 0.1
        double = ctypes.c_double
        self.case("radiation_density", made(double, library.radiation_density, 2.7255, 3.046, 0.7))
        a, e = array([i / 16.0 for i in range(1, 21)]), Buffer(double, 20)
        library.expansion(e.start, a.start, 20, full)
        self.case("expansion", e)
        growth = Buffer(fixpair.Growth, 20)
        library.growth_factors(growth.start, a.start, 20, full)
        self.case("growth_factors", growth)
        self.case("growth_suppression", made(double, library.growth_suppression, full))
        k, power, transfer = self.rows()
        kinds = [
            (fixpair.POWER, fixpair.AS_GIVEN, 0.0), (fixpair.POWER, fixpair.SIGMA8, 0.8),
            (fixpair.POWER, fixpair.AMPLITUDE, 1e6), (fixpair.TRANSFER, fixpair.SIGMA8, 0.8),
            (fixpair.TRANSFER, fixpair.AMPLITUDE, 1e6), (fixpair.TRANSFER, fixpair.A_S, 2e-9),
            (fixpair.EISENSTEIN_HU, fixpair.SIGMA8, 0.8), (fixpair.EISENSTEIN_HU_SMOOTH, fixpair.A_S, 2e-9),
        ]
        waves = array([0.0004 * float(i * i + 1) for i in range(30)])
        for number, (source, normalisation, amount) in enumerate(kinds):
            linear = Linear(ctypes.sizeof(Linear), source, normalisation, None, None, 0, amount)
            if source <= fixpair.TRANSFER:
                value = power if source == fixpair.POWER else transfer
                linear.k, linear.value, linear.rows = k.start, value.start, ROWS
            out = [Buffer(double, 30) for _ in range(4)]
            library.linear_power(out[0].start, waves.start, 30, c, linear, 1.0)
            library.linear_transfer(out[1].start, waves.start, 30, c, linear)
            sigma = made(double, library.linear_sigma, 5.0, c, linear)
            library.alpha(out[2].start, waves.start, 30, c, linear, 32.0, fixpair.CMB)
            library.alpha(out[3].start, waves.start, 30, c, linear, 32.0, fixpair.LSS)
            self.case(f"linear.{number}", out[0], out[1], sigma, out[2], out[3])
        length = made(ctypes.c_size_t, library.mode_table_length, N).value
        self.case("mode_table_length", integers(length))
        conditions = made(Conditions, library.conditions_init, SEED)
        self.amplitude, self.transfer = Buffer(double, length), Buffer(double, length)
        library.potential_amplitude_table(self.amplitude.start, length, N, BOX, conditions.cosmology, conditions.linear,
                                          fixpair.CMB, self.run)
        library.alpha_table(self.transfer.start, length, N, BOX, conditions.cosmology, conditions.linear, 32.0,
                            fixpair.CMB, self.run)
        self.case("potential_amplitude_table", self.amplitude)
        self.case("alpha_table", self.transfer)
        self.table_length = length


class Twin:
    """The cases of one precision."""

    def __init__(self, universe, suffix):
        self.universe, self.library, self.run = universe, universe.library, universe.run
        self.suffix = suffix
        self.real = ctypes.c_float if suffix == "f32" else ctypes.c_double
        self.size = ctypes.sizeof(self.real)

    def case(self, name, *pieces):
        self.universe.case(f"{name}.{self.suffix}", *pieces)

    def call(self, name, *arguments):
        return getattr(self.library, f"{name}_{self.suffix}")(*arguments)

    def layout(self, name, *arguments):
        layout = Layout()
        self.call(name, layout, *arguments)
        return layout

    def transform(self, n, padding=0):
        tables = Buffer(ctypes.c_uint8, self.layout("fft_tables_scratch", n).size)
        scratch = Buffer(ctypes.c_uint8, self.layout("fft_scratch", n).size)
        self.call("fft_tables_init", tables.start, tables.size, n)
        fft = fixpair.Fft()
        self.call("fft_init", fft, tables.start, tables.size, padding, scratch.start, scratch.size, self.run)
        return fft

    def transforms(self):
        self.case("fft_padding", integers(*(self.call("fft_padding", n) for n in range(300))))
        tables, scratch = self.layout("fft_tables_scratch", N), self.layout("fft_scratch", N)
        self.case("fft_sizes", integers(tables.size, tables.align, scratch.size, scratch.align))
        memory = Buffer(ctypes.c_uint8, tables.size)
        self.call("fft_tables_init", memory.start, memory.size, N)
        self.case("fft_tables", memory)
        for name, padding in (("fft_pair", 0), ("fft_pair_padded", PADDING)):
            fft = self.transform(N, padding)
            data = Buffer(self.real, fft.length)
            self.call("fft_self_test", fft, data.start, fft.length)
            data.array[:] = [noise(i) for i in range(fft.length)]
            fft.forward(fft.context, data.start)
            modes = elements(data, fft.fourier)
            fft.inverse(fft.context, data.start)
            self.case(name, modes, elements(data, fft.configuration))

    def white(self, brick, realisation, table=None):
        modes = Buffer(self.real, self.universe.reals(brick))
        length = self.universe.table_length if table else 0
        self.call("white_modes", modes.start, len(modes.array), brick, realisation, table and table.start, length,
                  self.run)
        return modes

    def realisation(self, **choices):
        realisation = made(Realisation, self.library.realisation_init, SEED)
        for name, value in choices.items():
            setattr(realisation, name, value)
        return realisation

    def whites(self):
        bricks, table = self.universe.bricks(), self.universe.amplitude
        fixed = self.realisation(amplitude=fixpair.FIXED)
        ngenic = self.realisation(scheme=fixpair.NGENIC, selection=fixpair.SPHERE, sample=N - 3)
        fast_pm = self.realisation(scheme=fixpair.FAST_PM, amplitude=fixpair.FIXED, nyquist=fixpair.FILLED)
        for name, brick in bricks.items():
            self.case(f"white_modes.{name}", elements(self.white(brick, self.realisation()), brick))
            self.case(f"white_modes.coloured_{name}", elements(self.white(brick, fixed, table), brick))
            self.case(f"white_modes.ngenic_{name}", elements(self.white(brick, ngenic), brick))
            self.case(f"white_modes.fastpm_{name}", elements(self.white(brick, fast_pm, table), brick))
        whole = bricks["whole"]
        mean = self.realisation(amplitude=fixpair.FIXED_TO_MEAN, phase=fixpair.INVERTED, nyquist=fixpair.FILLED)
        self.case("white_modes.mean", elements(self.white(whole, mean), whole))
        modes = self.white(whole, self.realisation())
        mean.amplitude = fixpair.FIXED
        self.call("impose", modes.start, len(modes.array), whole, mean, self.run)
        self.case("impose", elements(modes, whole))
        fft = self.transform(N)
        data = Buffer(self.real, fft.length)
        data.array[:] = [noise(i) for i in range(fft.length)]
        self.call("modes_from_field", data.start, fft.length, fft, self.realisation(phase=fixpair.INVERTED), self.run)
        self.case("modes_from_field", elements(data, fft.fourier))

    def stages(self):
        library, run = self.library, self.run
        brick = made(Brick, library.brick_whole, N, fixpair.FOURIER, 0)
        cells = made(Brick, library.brick_whole, N, fixpair.CONFIGURATION, 0)
        fine = made(Brick, library.brick_whole, FINE, fixpair.FOURIER, 0)
        phi = self.white(brick, self.realisation(), self.universe.amplitude)
        length = len(phi.array)
        for name, side, g_nl in (("aliased", N, 0.0), ("exact", FINER, 1e7)):
            modes, work = Buffer(self.real, length), self.transform(side)
            ctypes.memmove(modes.start, phi.start, phi.size)
            mesh, scratch = Buffer(self.real, work.length), Buffer(ctypes.c_uint8, self.layout("add_local_scratch", work).size)
            self.call("add_local", modes.start, length, brick, 5000.0, g_nl, work, mesh.start, work.length, scratch.start,
                      scratch.size, run)
            self.case(f"add_local.{name}", elements(modes, brick))
        density = phi
        self.call("scale_modes", density.start, length, brick, self.universe.transfer.start, self.universe.table_length,
                  run)
        self.case("scale_modes", elements(density, brick))
        copy = Buffer(self.real, self.universe.reals(fine))
        self.call("copy_modes", copy.start, len(copy.array), fine, density.start, length, brick, run)
        self.case("copy_modes", elements(copy, fine))
        work, source = self.transform(FINE), Buffer(self.real, length)
        meshes = [Buffer(self.real, work.length) for _ in range(3)]
        self.call("second_order_source", source.start, length, density.start, length, brick, work,
                  *(mesh.start for mesh in meshes), work.length, run)
        self.case("second_order_source", elements(source, brick))
        fft = self.transform(N)
        psi = [Buffer(self.real, fft.length) for _ in range(2)]
        for out, modes, scale in ((psi[0], density, 32.0), (psi[1], source, 13.5)):
            self.call("displacement", out.start, fft.length, modes.start, length, brick, 1, scale, fft, run)
        self.case("displacement", *(elements(out, cells) for out in psi))
        particles = [Buffer(self.real, 3 * N**3) for _ in range(2)]
        position, velocity = (triples(buffer.start, self.size, N**3) for buffer in particles)
        self.call("displace", position, velocity, psi[0].start, psi[1].start, fft.length, cells, 1, BOX, 600.0, 1200.0,
                  run)
        self.case("displace", *particles)

    def universes(self):
        k, power, _ = self.universe.rows()
        fft, fine, finer = (self.transform(n) for n in (N, FINE, FINER))

        def conditions(pair, **members):
            result = made(Conditions, self.library.conditions_init, SEED)
            result.box_size = BOX
            if pair:
                result.realisation.amplitude, result.realisation.phase, result.f_nl = fixpair.FIXED, fixpair.INVERTED, 100.0
            for name, value in members.items():
                setattr(result, name, value)
            return result

        first = conditions(True, order=fixpair.FIRST, redshift=49.0, convention=fixpair.LSS)
        first.linear = Linear(ctypes.sizeof(Linear), fixpair.POWER, fixpair.AS_GIVEN, k.start, power.start, ROWS, 0.0)
        self.particles("gaussian", conditions(False), fft, None)
        self.particles("cubic", conditions(True, g_nl=1e5), fft, finer)
        self.particles("first", first, fft, None)
        self.particles("local", conditions(True), fft, fine)

    def particles(self, name, conditions, fft, fine):
        layout = self.layout("initial_conditions_scratch", conditions, fft, fine)
        scratch = Buffer(ctypes.c_uint8, layout.size)
        memory = [Buffer(self.real, 3 * N**3) for _ in range(2)]
        position, velocity = (triples(buffer.start, self.size, N**3) for buffer in memory)
        self.call("initial_conditions", position, velocity, conditions, fft, fine, scratch.start, scratch.size, self.run)
        self.case(f"initial.{name}", integers(layout.size, layout.align), *memory)


# Pointers that may be null, by their place among the arguments; the last one, exec, may be wherever there is one.
OPTIONAL = {"white_modes": [3, 4, 6], "fft_init": [6], "initial_conditions_scratch": [3], "initial_conditions": [4, 7],
            "initial_conditions_at_scratch": [4], "initial_conditions_at": [5, 8],
            "displace": [3, 10], "exec_self_test": [0], "deposit": [4, 11], "read_out": [11], "power_sums": [7, 12],
            "shot_noise": [1], "correlation_modes": [1, 9], "correlation_sums": [9], "closed_triangle_count": [3],
            "closed_triangles": [4], "triangle_counts": [8], "bispectrum_sums": [10], "bispectrum": [2, 14], "kick": [14, 15, 18],
            "drift": [6, 7, 8], "evolve": [4, 7, 15, 16], "halos": [6, 12], "halo_sums": [6, 13], "fof_labels": [9],
            "fit_suppression": [2], "ratio_of_means": [6], "difference_of_means": [6], "control_variates": [6], "carpool": [8]}
EXEC = ("particle_ids", "potential_amplitude_table", "alpha_table", "species_table", "impose", "modes_from_field",
        "scale_modes", "copy_modes", "add_local", "add_shape", "second_order_source", "displacement", "third_order_sources",
        "transverse_displacement", "add_cells", "copy_cells", "interlace", "shell_modes", "compensate", "forces", "force",
        "potential", "fof_relabel", "halo_count", "spheres", "refine_centres")
# Sizes that follow a pointer and are not its length: sides, an axis, a number of threads.
NO_LENGTH = {"mode_table_length": 1, "fft_tables_scratch": 1, "fft_scratch": 1, "brick_whole": 1, "brick_slab": 1,
             "brick_transposed_slab": 1, "threads_create": 2, "displacement": 5, "displace": 6,
             "initial_conditions_at_scratch": 2, "deposit_scratch": 2, "read_out_scratch": 2, "force": 4,
             "kick_scratch": 2, "evolve_scratch": 2, "bias_posterior_scratch": 1}
# Where more than a few are refused as a length.
AT_MOST = {"power_sums": 3, "correlation_sums": 3}


def snapshot():
    return [bytes(buffer.raw) for buffer in Buffer.everything]


def refusals(library):
    """Repeats the last good call of each function with one pointer null or misaligned, or one length too large."""
    for name, signature in fixpair.SIGNATURES.items():
        good = list(library.calls[name])
        plain = name.removesuffix("_f32").removesuffix("_f64")
        optional = OPTIONAL.get(plain, []) + ([len(good) - 1] if plain in EXEC else [])
        function = getattr(library.shared, "fixpair_" + name)
        for place, letter in enumerate(signature):
            faults = []
            if letter == "p" and place not in optional:
                faults.append((None, -1))
            if letter == "p" and good[place] is not None:
                faults.append((fixpair.address(good[place]) + 1, -3))
            array = letter == "n" and place > 0 and signature[place - 1] == "p" and place - 1 not in optional
            if array and NO_LENGTH.get(plain) != place:
                huge = 2**(8 * ctypes.sizeof(ctypes.c_size_t)) - 1
                faults.append((huge, -2 if AT_MOST.get(plain) == place else -8))
            for value, status in faults:
                arguments = [fixpair.address(argument) for argument in good]
                arguments[place] = value
                before = snapshot()
                found = function(*arguments)
                check(found == status, f"{name}, argument {place} = {value}: status {found}, not {status}")
                check(snapshot() == before, f"{name}, argument {place} = {value}: touched memory")
    for name, arguments, status in (
            ("fft_tables_scratch_f64", (Layout(), 0), -6), ("fft_tables_scratch_f32", (Layout(), 11), -6),
            ("fft_tables_scratch_f64", (Layout(), 22), -6), ("mode_table_length", (ctypes.c_size_t(), 7), -6),
            ("brick_whole", (Brick(), 2**62, 1, 0), -8), ("brick_whole", (Brick(), N, 5, 0), -14),
            ("radiation_density", (ctypes.c_double(), float("nan"), 3.0, 0.7), -5)):
        try:
            getattr(library, name)(*arguments)
            check(False, f"{name} refuses")
        except fixpair.Refused as refused:
            check(refused.status == status and str(refused) == library.status_message(status).decode(),
                  f"{name} is refused with {status}")


def main(path, vectors, header):
    with open(vectors, encoding="ascii") as lines:
        cases = {name: int(value, 16) for name, value in map(str.split, lines)}
    library = fixpair.Library(path)
    own = Exec(None, fixpair.ParallelFor(parallel_for))
    pool, exec_of_pool = ctypes.c_void_p(), Exec()
    library.threads_create(pool, exec_of_pool, 2)
    for run in (exec_of_pool, own):
        library.exec_self_test(run)
        universe = Universe(library, cases, run)
        universe.scalars()
        universe.cosmologies()
        ctypes_initial.tables(universe)
        ctypes_estimate.bins(universe)
        ctypes_gravity.steps_in_time(universe)
        ctypes_halos.scalars(universe)
        ctypes_variance.Statistics(universe).run()
        for suffix in ("f32", "f64"):
            twin = Twin(universe, suffix)
            twin.transforms()
            twin.whites()
            twin.stages()
            ctypes_shape.shapes(twin)
            twin.universes()
            ctypes_initial.initial(twin)
            ctypes_estimate.particles(twin)
            ctypes_estimate.Estimates(twin).run()
            ctypes_gravity.gravity(twin)
            ctypes_halos.halos(twin)
        if run is exec_of_pool:
            ctypes_estimate.physics(library, run)
            ctypes_gravity.growing_mode(library, run)
            ctypes_initial.einstein_de_sitter(library)
            ctypes_variance.known_answers(universe)
            for suffix in ("f32", "f64"):
                ctypes_halos.two_clumps(Twin(universe, suffix))
            ctypes_gravity.attraction(twin)
        check(all(buffer.canaries_live() for buffer in Buffer.everything), "canaries live")
        if run is exec_of_pool:
            # The calls that refusals() repeats are those of the second round.
            Buffer.everything.clear()
    library.threads_destroy(pool)
    refusals(library)
    with open(header, encoding="utf-8") as text:
        code = re.sub(r"/\*.*?\*/", "", text.read(), flags=re.S)
    declared = set(re.findall(r"\bfixpair_(\w+)\(", code))
    check(declared == set(library.calls), f"functions not called: {declared ^ set(library.calls)}")
    for failure in failures:
        print("not so:", failure)
    print(f"test_ctypes: {len(claims)} checks, {len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
