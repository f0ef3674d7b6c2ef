"""Forces, kicks and drifts, steps in time, and runs: the cases of Rust, and what anyone knows of gravity."""

import ctypes

import fixpair_ctypes as fixpair
from ctypes_check import BOX, N, PADDING, Buffer, array, check, doubles, elements, integers, made, noise, triples
from ctypes_estimate import filled, positions, scratch_of, sizes
from fixpair_ctypes import (Brick, Components, Cosmology, Displacements, Epoch, ForceLaw, Gravity, Growth, Layout, Observe,
                            Observer, Outputs, Positions, StepFactors)

PARTICLES, LATTICE, STEPS = 500, 6, 5
STEPPERS = {"fastpm": fixpair.FASTPM, "leapfrog": fixpair.LEAPFROG, "cola": fixpair.COLA}
OUTPUT_TIMES = (0.125, 0.3125, 0.75, 1.0)
c_double, size_t = ctypes.c_double, ctypes.c_size_t


def laws(library):
    three = [made(ForceLaw, library.force_law_init) for _ in range(3)]
    three[1].laplacian, three[1].gradient, three[1].window, three[1].window_power = (
        fixpair.TWO_POINT, fixpair.FOUR_POINT, fixpair.CIC, 1)
    three[2].gradient, three[2].window, three[2].split_scale = fixpair.FOUR_POINT, fixpair.PCS, 1.25 * BOX / N
    return three


def of_law(law):
    return integers(law.laplacian, law.gradient, law.window, law.window_power) + doubles(law.split_scale)


def steps_in_time(universe):
    library = universe.library
    law, gravity = made(ForceLaw, library.force_law_init), made(Gravity, library.gravity_init)
    check(law.struct_size == ctypes.sizeof(law) and gravity.struct_size == ctypes.sizeof(gravity),
          "force law and gravity have the size of the header")
    universe.case("force_law_init", of_law(law))
    c = gravity.cosmology
    members = (c.omega_m, c.omega_de, c.omega_r, c.omega_b, c.h, c.n_s, c.w0, c.wa, c.t_cmb)
    universe.case("gravity_init", of_law(gravity.law), doubles(*members, gravity.box_size, gravity.hubble, gravity.cola_exponent),
                  integers(gravity.stepper, gravity.window))
    universe.case("force_scratch", sizes(made(Layout, library.force_scratch, N)))
    cosmology, pieces = made(Cosmology, library.cosmology_init), []
    for stepper in STEPPERS.values():
        for times in ((0.125, 0.25, 0.1875), (0.5, 0.25, 0.3125)):
            for ask in (library.drift_factors, library.kick_factors):
                pieces.append(made(StepFactors, ask, cosmology, stepper, fixpair.COLA_EXPONENT, *times))
    universe.case("step_factors", *pieces)
    linear, logarithmic = Buffer(c_double, STEPS), Buffer(c_double, STEPS)
    library.linear_steps(linear.start, STEPS, 0.125, 1.0)
    library.logarithmic_steps(logarithmic.start, STEPS, 0.125, 1.0)
    universe.case("steps", linear, logarithmic)


def numbers(twin, count, start, scale):
    return filled(twin.real, [scale * noise(i + start) for i in range(count)])


def forces(twin):
    scratch = scratch_of(made(Layout, twin.library.force_scratch, N))
    for name, brick in twin.universe.bricks().items():
        length, pieces, potentials = twin.universe.reals(brick), [], []
        for law in laws(twin.library):
            meshes = [numbers(twin, length, 0, 1.0) for _ in range(3)]
            modes, one = numbers(twin, length, 0, 1.0), Buffer(twin.real, length)
            twin.call("forces", *(mesh.start for mesh in meshes), length, brick, law, BOX, 500.0, scratch.start, scratch.size,
                      twin.run)
            pieces += [elements(mesh, brick) for mesh in meshes]
            twin.call("force", one.start, modes.start, length, brick, 1, law, BOX, 500.0, scratch.start, scratch.size, twin.run)
            check(elements(one, brick) == pieces[-2], "one component has the bits of three")
            twin.call("potential", modes.start, length, brick, law, BOX, 500.0, scratch.start, scratch.size, twin.run)
            potentials.append(elements(modes, brick))
        twin.case(f"forces.{name}", *pieces)
        twin.case(f"potential.{name}", *potentials)


def kicks_and_drifts(twin):
    region = made(Brick, twin.library.brick_whole, N, fixpair.CONFIGURATION, PADDING)
    length = twin.universe.reals(region)
    meshes = [numbers(twin, length, start, 1.0) for start in (10000, 20000, 30000)]
    places, speeds = numbers(twin, 3 * PARTICLES, 0, BOX), numbers(twin, 3 * PARTICLES, 5000, 300.0)
    psi = [positions(numbers(twin, 3 * PARTICLES, start, 2.0)) for start in (40000, 50000)]
    moved = [triples(buffer.start, twin.size, PARTICLES) for buffer in (places, speeds)]
    pieces = []
    for i, window in enumerate((fixpair.NGP, fixpair.CIC, fixpair.TSC, fixpair.PCS)):
        layout = twin.layout("kick_scratch", region, PARTICLES, window)
        scratch = scratch_of(layout)
        twin.call("kick", moved[1], positions(places), *(mesh.start for mesh in meshes), length, region, BOX, window, 0.25 * i,
                  0.875, 2.5, 0.25 if i > 0 else 0.0, -0.125 if i > 1 else 0.0, psi[0] if i > 0 else None,
                  psi[1] if i > 1 else None, scratch.start, scratch.size, twin.run)
        pieces += [sizes(layout), bytes(speeds)]
    twin.case("kick", *pieces)
    pieces = []
    for i in range(3):
        twin.call("drift", moved[0], positions(speeds), BOX, 0.125, 0.5 if i > 0 else 0.0, 0.25 if i > 1 else 0.0,
                  psi[0] if i > 0 else None, psi[1] if i > 1 else None, twin.run)
        pieces.append(bytes(places))
    twin.case("drift", *pieces)


class Run:
    """Three meshes, scratch and all else that a run of some particles borrows."""

    def __init__(self, twin, places, speeds, gravity, fft, displacements=None, times=()):
        self.twin, self.gravity, self.fft, self.displacements = twin, gravity, fft, displacements
        self.buffers, count = (places, speeds), len(places.array) // 3
        self.moved = [triples(buffer.start, twin.size, count) for buffer in self.buffers]
        self.layout = twin.layout("evolve_scratch", fft, count, gravity.window)
        self.scratch = scratch_of(self.layout)
        self.meshes = [Buffer(twin.real, fft.length) for _ in range(3)]
        self.steps, self.epoch = Buffer(c_double, STEPS), Epoch(0.125, 0.125)
        twin.library.logarithmic_steps(self.steps.start, STEPS, 0.125, 1.0)
        self.shown, self.times = [Buffer(twin.real, 3 * count) for _ in range(2)], array(list(times))
        self.outputs = Outputs(self.times.start, len(times),
                               *(triples(buffer.start, twin.size, count) for buffer in self.shown)) if times else None
        self.reports, self.stop = [], 0
        self.observer = Observer(None, Observe(self.observe))

    def observe(self, _, pointer):
        progress = pointer.contents
        shown = self.shown if progress.event == fixpair.EVENT_OUTPUT else self.buffers
        self.reports += [integers(progress.event, progress.step, progress.steps, progress.output),
                         doubles(progress.epoch.position, progress.epoch.velocity), *map(bytes, shown)]
        return progress.event == fixpair.EVENT_STEP and progress.step == self.stop

    def go(self):
        """True at the end, false if the observer stopped it."""
        try:
            self.twin.call("evolve", *self.moved, self.epoch, self.gravity, self.displacements, self.steps.start, STEPS,
                           self.outputs, *(mesh.start for mesh in self.meshes), self.fft.length, self.fft, self.scratch.start,
                           self.scratch.size, self.observer, self.twin.run)
        except fixpair.Refused as refused:
            check(refused.status == fixpair.STOPPED, f"a run is refused: {refused}")
            return False
        return True


def lattice(twin):
    """Positions, velocities, and displacements of both orders."""
    of = [Buffer(twin.real, 3 * LATTICE**3) for _ in range(4)]
    for i in range(3 * LATTICE**3):
        particle, axis = divmod(i, 3)
        cell = (particle // LATTICE**2, particle // LATTICE % LATTICE, particle % LATTICE)[axis]
        first, second = 2.0 * noise(i), 0.25 * noise(i + 1000)
        values = (cell * BOX / LATTICE + first + second, 150.0 * noise(i + 2000), first, second)
        for buffer, value in zip(of, values):
            buffer.array[i] = value
    return of


def runs(twin):
    fft = twin.transform(N)
    for number, (name, stepper) in enumerate(STEPPERS.items()):
        places, speeds, first, second = lattice(twin)
        gravity = made(Gravity, twin.library.gravity_init)
        gravity.box_size, gravity.stepper, gravity.window = BOX, stepper, fixpair.CIC + number
        gravity.law = laws(twin.library)[number]
        displacements = Displacements(positions(first), positions(second), 0.125) if name == "cola" else None
        run = Run(twin, places, speeds, gravity, fft, displacements, OUTPUT_TIMES)
        run.stop = number + 1
        check(not run.go(), "an observer stops a run")
        check(run.epoch.position == run.steps.array[run.stop] > run.epoch.velocity, "it stops after the step")
        run.stop = 0
        check(run.go(), "a run that was stopped goes on")
        twin.case(f"evolve.{name}", sizes(run.layout), places, speeds, doubles(run.epoch.position, run.epoch.velocity))
        twin.case(f"evolve.{name}.reports", *run.reports)


def gravity(twin):
    forces(twin)
    kicks_and_drifts(twin)
    runs(twin)


def growing_mode(library, run):
    """A particle displaced by D psi with velocity G psi: FastPM moves it as linear theory does, in a step of any length."""
    cosmology = made(Cosmology, library.cosmology_init)
    start, middle, end = times = (0.1, 0.25, 0.9)
    a, expansion, growth = array(list(times)), Buffer(c_double, 3), Buffer(Growth, 3)
    library.expansion(expansion.start, a.start, 3, cosmology)
    library.growth_factors(growth.start, a.start, 3, cosmology)
    d = [g.d for g in growth.array]
    # G = a^2 E f D.
    speed = [t * t * e * g.f * g.d for t, e, g in zip(times, expansion.array, growth.array)]
    drift, kick = (made(StepFactors, ask, cosmology, fixpair.FASTPM, 0.0, start, end, middle)
                   for ask in (library.drift_factors, library.kick_factors))
    check((drift.first, drift.second, kick.first, kick.second) == (0, 0, 0, 0), "FastPM needs no displacements")
    psi = (3.0, -4.0, 5.0)
    x, u = array([50.0 + d[0] * p for p in psi]), array([100.0 * speed[1] * p / middle for p in psi])
    moved = Components(x.start, x.at(1), x.at(2), 3, 1)
    library.drift_f64(moved, Positions(u.start, u.at(1), u.at(2), 3, 1), BOX, drift.factor * middle / 100.0, 0.0, 0.0, None,
                      None, run)
    # A few roundings of numbers near 50.
    check(all(abs(found - 50.0 - d[2] * p) < 1e-12 for found, p in zip(x.array, psi)), "FastPM drifts a growing mode exactly")
    # F = D(middle) psi everywhere.
    brick = made(Brick, library.brick_whole, N, fixpair.CONFIGURATION, 0)
    length = made(size_t, library.brick_reals, brick).value
    force = [array([d[1] * p] * length) for p in psi]
    u.array[:] = [100.0 * speed[0] * p / start for p in psi]
    scratch = scratch_of(made(Layout, library.kick_scratch_f64, brick, 1, fixpair.TSC))
    library.kick_f64(Components(u.start, u.at(1), u.at(2), 3, 1), Positions(x.start, x.at(1), x.at(2), 3, 1),
                     *(mesh.start for mesh in force), length, brick, BOX, fixpair.TSC, 0.0, start / end,
                     100.0 / end * kick.factor, 0.0, 0.0, None, None, scratch.start, scratch.size, run)
    check(all(abs(found * end / 100.0 - speed[2] * p) < 1e-12 for found, p in zip(u.array, psi)),
          "FastPM kicks a growing mode exactly")


def attraction(twin):
    """Two particles at rest: they approach one another, and their momenta cancel."""
    places, speeds = filled(twin.real, [65.0, 100.0, 100.0, 135.0, 100.0, 100.0]), Buffer(twin.real, 6)
    gravity = made(Gravity, twin.library.gravity_init)
    gravity.box_size = BOX
    run = Run(twin, places, speeds, gravity, twin.transform(N))
    # Each is half of the universe: later they fall through one another.
    run.stop = 1
    check(not run.go(), "two particles move one step")
    x, u = list(places.array), list(speeds.array)
    check(65.0 < x[0] < x[3] < 135.0 and u[0] > 0 > u[3], "two particles attract one another")
    # Rounding of a force on which the two agree.
    check(all(abs(u[axis] + u[axis + 3]) < 1e-9 * u[0] for axis in range(3)), "their momenta cancel")
    check(all(abs(x[axis] + x[axis + 3] - 200.0) < 1e-9 for axis in range(3)), "their centre stays")
