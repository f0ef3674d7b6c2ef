"""Forces on a mesh: what the modes of the density contrast are multiplied by."""

from typing import Any

import numpy as np

from .. import native
from .._arrays import alike, view
from .._library import library, twin
from .._members import Members
from ..mesh import Brick
from ..native import Space
from ..threads import current
from ..workspace import scratch


class ForceLaw(Members, native.ForceLaw):
    """phi_k = -S(k)/(W(k)^power K2(k)) delta_k, F_k = -i K_a(k) phi_k, S(k) = exp(-k^2 r_s^2).

    By name: laplacian (K2) and gradient (K_a), each a :class:`~fixpair.Difference`, exact by default; window (W, 0 for none) and window_power (2);
    split_scale (r_s, 0 for the whole force). fixpair.h has the laws of known codes.
    """

    def __init__(self, **members: Any):
        super().__init__()
        library.force_law_init(self)
        self._set(members)


def forces(x: np.ndarray, y: np.ndarray, z: np.ndarray, box_size: float, mass: float, *,
           law: native.Structure | None = None, brick: native.Structure | None = None) -> None:
    """From modes of the density in x to modes of F = -grad inverse-Laplacian delta, all components in one pass.

    x: complex numbers (n, n, n/2 + 1), the forward transform of deposited weights, replaced by F_x; y, z: written. mass: the sum of all
    weights. The inverse transforms, not normalised, are the force on the cells in the unit of L: for a linear field the Zel'dovich displacement;
    the peculiar acceleration is 3/2 Omega_m H0^2/a^2 times it.
    """
    views = [view(mesh, brick, Space.FOURIER, name, write=True) for mesh, name in ((x, "x"), (y, "y"), (z, "z"))]
    length = alike(views, "xyz")
    with scratch(library.force_scratch, views[0].brick.n) as (memory, size):
        twin("forces", views[0].real)(*(each.start for each in views), length, views[0].brick, ForceLaw() if law is None else law,
                                      box_size, mass, memory, size, current())


def force(density: np.ndarray, axis: int, box_size: float, mass: float, *, law: native.Structure | None = None,
          out: np.ndarray | None = None, brick: native.Structure | None = None) -> np.ndarray:
    """One component of :func:`forces`, the same bits, to another mesh, laid out as density is; new if None."""
    start = view(density, brick, Space.FOURIER, "density")
    if out is None:
        out = Brick.from_buffer_copy(start.brick).zeros(density.real.dtype)
    where = view(out, start.brick, Space.FOURIER, "out", write=True)
    length = alike((start, where), ("density", "out"))
    with scratch(library.force_scratch, start.brick.n) as (memory, size):
        twin("force", start.real)(where.start, start.start, length, start.brick, axis, ForceLaw() if law is None else law, box_size,
                                  mass, memory, size, current())
    return out


def potential(modes: np.ndarray, box_size: float, mass: float, *, law: native.Structure | None = None,
              brick: native.Structure | None = None) -> np.ndarray:
    """The inverse Laplacian of delta in place, in the unit of L^2: the peculiar potential is 3/2 Omega_m H0^2/a times it."""
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    with scratch(library.force_scratch, where.brick.n) as (memory, size):
        twin("potential", where.real)(where.start, where.length, where.brick, ForceLaw() if law is None else law, box_size, mass,
                                      memory, size, current())
    return modes
