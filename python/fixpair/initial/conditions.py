"""Fixed, Paired or Matched initial conditions with primordial non-Gaussianity, in the only right order.

noise -> fix -> invert -> colour -> PNG -> transfer -> displace.
"""

import contextlib
from typing import Any
from collections.abc import Iterator

import numpy as np

from .. import native
from .._arrays import REALS, Particles, output, same, triples, vector
from .._library import library, twin
from .._members import Members
from ..fft import Transform
from ..mesh import Brick
from ..native import Space
from ..threads import current
from ..workspace import scratch
from .png import SHAPE_ROW


class Conditions(Members, native.Conditions):
    """A universe, and when and how large to start it.

    ::

        conditions = fixpair.Conditions(seed, box_size=1000.0, redshift=32.0, f_nl=100.0, amplitude=Amplitude.FIXED,
                                        linear=Linear(k=k, power=power))
        conditions.realisation.phase = Phase.INVERTED          # the other half of the pair
        conditions.f_nl = 0.0                                  # the same seed: matched

    seed, and by name: cosmology, linear, redshift (32), box_size in Mpc/h (1000), f_nl, g_nl, convention, order (second), shape
    (local), rows (of SHAPE_ROW, for Shape.ROWS), species; and members of the realisation: scheme, amplitude, phase, selection, sample.
    Without `linear` the fit of Eisenstein & Hu with sigma8 = 0.8. The structures given are copied; the arrays they point into are kept.
    """

    _pointers = ("rows", "species")
    _lengths = ("rows_len",)

    def __init__(self, seed: int = 0, **members: Any):
        super().__init__()
        library.conditions_init(self, seed)
        for name in native.Realisation._fields_:
            if name[0] in members:
                setattr(self.realisation, name[0], members.pop(name[0]))
        self._set(members)

    def _point(self, name: str, value: Any) -> tuple[int | None, Any]:
        if name == "species":
            return (None if value is None else native.address(value)), value
        rows = vector(value, "rows", SHAPE_ROW)
        self._count("rows_len", rows.size)
        return native.address(rows), rows


@contextlib.contextmanager
def hooks(fft: Transform, fine: Transform | None) -> Iterator[tuple[native.Structure, native.Structure | None]]:
    """The structures of one or two transforms."""
    if fine is not None:
        same(fft.real, fine.real, "fine")
    with fft.use() as hook, (fine.use() if fine is not None else contextlib.nullcontext()) as fine_hook:
        yield hook, fine_hook


def initial_conditions(conditions: native.Structure, fft: Transform, fine: Transform | None = None, *,
                       position: Particles | None = None,
                       velocity: Particles | None = None) -> tuple[Particles, Particles]:
    """One particle for each cell of a transform's mesh, numbered with z fastest.

    Two calls that differ in phase give a pair; two that differ in f_nl, cosmology or redshift, with one seed, are matched.

    fft: the transform of side n. fine: one of side 3n/2 or more (2n with g_nl), on which products are free of aliasing; None to
    let f_nl, g_nl and the second order alias. position, velocity: where they go, (n^3, 3) in the precision of fft; new if None.
    Returns position in Mpc/h, in [0, L), and peculiar velocity in km/s.
    """
    cells = fft.n**3
    position, velocity, outputs = particles_out(position, velocity, cells, fft.real)
    with hooks(fft, fine) as (hook, fine_hook), \
            scratch(twin("initial_conditions_scratch", fft.real), conditions, hook, fine_hook) as (memory, size):
        twin("initial_conditions", fft.real)(*outputs, conditions, hook, fine_hook, memory, size, current())
    return position, velocity


def initial_conditions_at(pre_initial: Particles, conditions: native.Structure, fft: Transform,
                          fine: Transform | None = None, *, position: Particles | None = None,
                          velocity: Particles | None = None) -> tuple[Particles, Particles]:
    """The same for particles that begin at positions of your own: a glass, another lattice, another number of them.

    Displacements are read out by cloud in cell at pre_initial, q in Mpc/h of shape (N, 3): x = q + Psi(q). All else as
    :func:`initial_conditions`.
    """
    start = triples(pre_initial, "pre_initial")
    same(fft.real, start.real, "pre_initial")
    position, velocity, outputs = particles_out(position, velocity, start.particles, fft.real)
    with hooks(fft, fine) as (hook, fine_hook), \
            scratch(twin("initial_conditions_at_scratch", fft.real), conditions, start.particles, hook, fine_hook) as (memory, size):
        twin("initial_conditions_at", fft.real)(*outputs, start.structure, conditions, hook, fine_hook, memory, size, current())
    return position, velocity


def particles_out(position: Particles | None, velocity: Particles | None, count: int,
                  real: str) -> tuple[Particles, Particles, list[native.Structure]]:
    """Arrays for so many particles: the caller's or new ones, and the structures that the library takes."""
    arrays, structures = [], []
    for values, name in ((position, "position"), (velocity, "velocity")):
        values = np.empty((count, 3), REALS[real]) if values is None else values
        found = triples(values, name, write=True)
        same(real, found.real, name)
        if found.particles != count:
            raise ValueError(f"{name} must have room for {count} particles, not {found.particles}")
        arrays.append(values)
        structures.append(found.structure)
    return arrays[0], arrays[1], structures


def particle_ids(mesh: int | native.Structure, first_id: int = 0, *, out: np.ndarray | None = None) -> np.ndarray:
    """Ids ((x n) + y) n + z + first_id of the particles of a mesh of side n, or of a brick: uint64, numbered with z fastest."""
    brick = Brick.of(mesh, Space.CONFIGURATION)
    count = brick.count[0] * brick.count[1] * brick.count[2]
    ids = output(out, "out", count, np.uint64)
    library.particle_ids(ids, count, brick, first_id, current())
    return ids
