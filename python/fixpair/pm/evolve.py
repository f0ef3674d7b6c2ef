"""Runs: particles through a list of scale factors, under their gravity."""

from dataclasses import dataclass
from typing import Any, NamedTuple
from collections.abc import Callable

import numpy as np

from .. import native
from .._arrays import Particles, same, triples, vector
from .._library import library, twin
from .._members import Members
from ..fft import Transform
from ..native import Event
from ..threads import current
from ..workspace import scratch


class Gravity(Members, native.Gravity):
    """What moves the particles of a run.

    box_size L, and by name: cosmology (that of the initial conditions), hubble (H0: 100 for km/s and Mpc/h), law (:class:`ForceLaw`; by default a
    gradient of four points, FastPM's kernel 1_4), cola_exponent, stepper (:class:`~fixpair.Stepper`, FastPM), window (CIC).
    """

    def __init__(self, box_size: float, **members: Any):
        super().__init__()
        library.gravity_init(self)
        self.box_size = box_size
        self._set(members)


@dataclass
class Displacements:
    """Displacements of both orders, x = q + first + second, when the scale factor was scale_factor: what COLA needs."""

    first: Particles
    second: Particles | None
    scale_factor: float


@dataclass
class Outputs:
    """Scale factors between those of a run, increasing, and the arrays that each of these outputs overwrites."""

    scale_factors: np.ndarray
    position: Particles
    velocity: Particles


class Run(NamedTuple):
    """Where a run is: what a later call goes on from, with the particles."""

    position_at: float
    velocity_at: float
    finished: bool


Observe = Callable[[native.Structure], Any]


def evolve(position: Particles, velocity: Particles, gravity: native.Structure, scale_factors: np.ndarray, fft: Transform, *,
           epoch: tuple[float, float] | None = None, displacements: Displacements | None = None,
           outputs: Outputs | None = None, observe: Observe | None = None) -> Run:
    """Moves particles of one mass, in place, by the particle-mesh method through a list of scale factors.

    position: wrapped into [0, L). velocity: peculiar, as initial_conditions makes them. scale_factors: increasing, see
    :func:`linear_steps`; a list of N entries costs N forces. fft: of side = particles a side times 1 or 2. epoch: scale factors of positions and
    velocities; the start of the list if None. displacements: for COLA. outputs: at times between steps. observe: called after each step
    and output with a structure of ``event`` (:class:`~fixpair.Event`), ``step``, ``steps``, ``output``, ``epoch``; it may read and save particles, and
    ends the run by returning True, after which a call with the same list and the epoch of the answer goes on, to the same bits. An exception
    of it ends the run after the step at hand, and is raised.
    """
    places, speed = triples(position, "position", write=True), triples(velocity, "velocity", write=True)
    same(fft.real, places.real, "position")
    same(fft.real, speed.real, "velocity")
    steps = vector(scale_factors, "scale_factors")
    if steps.size == 0:
        raise ValueError("scale_factors must hold the start of the run")
    at = native.Epoch(*(epoch or (steps[0], steps[0])))
    psi = None if displacements is None else _displacements(displacements, places.real)
    written = None if outputs is None else _outputs(outputs, places.real)
    errors: list[BaseException] = []
    observer = None if observe is None else native.Observer(None, native.Observe(_caught(observe, errors)))
    meshes = [fft.mesh() for _ in range(3)]
    finished = True
    with fft.use() as hook, scratch(twin("evolve_scratch", fft.real), hook, places.particles, gravity.window) as (memory, size):
        try:
            twin("evolve", fft.real)(places.structure, speed.structure, at, gravity, psi, steps, steps.size, written, *meshes,
                                     fft.length, hook, memory, size, observer, current())
        except native.Stopped:
            finished = False
    if errors:
        raise errors[0]
    return Run(at.position, at.velocity, finished)


def _caught(observe: Observe, errors: list[BaseException]) -> Callable[[Any, Any], int]:
    """An exception must not travel through the library: it stops the run."""
    def answer(_: Any, progress: Any) -> int:
        try:
            return 1 if observe(progress.contents) else 0
        except BaseException as error:  # noqa: BLE001
            errors.append(error)
            return 1
    return answer


def _displacements(given: Displacements, real: str) -> native.Structure:
    first = triples(given.first, "displacements.first")
    same(real, first.real, "displacements.first")
    second = None if given.second is None else triples(given.second, "displacements.second")
    if second is not None:
        same(real, second.real, "displacements.second")
    return native.Displacements(first.structure, second.structure if second else native.Positions(stride=1), given.scale_factor)


def _outputs(given: Outputs, real: str) -> native.Structure:
    given.scale_factors = vector(given.scale_factors, "outputs.scale_factors")
    places = triples(given.position, "outputs.position", write=True)
    speed = triples(given.velocity, "outputs.velocity", write=True)
    same(real, places.real, "outputs.position")
    same(real, speed.real, "outputs.velocity")
    return native.Outputs(native.address(given.scale_factors), given.scale_factors.size, places.structure, speed.structure)


__all__ = ["Displacements", "Event", "Gravity", "Outputs", "Run", "evolve"]
