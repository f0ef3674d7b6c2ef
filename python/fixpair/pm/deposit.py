"""From particles to meshes and back, ghost planes, interlacing."""


import numpy as np

from .. import native
from .._arrays import REALS, Particles, alike, same, strided, triples, view
from .._library import twin
from ..native import Space, Window
from ..threads import current
from ..workspace import scratch


def deposit(mesh: np.ndarray, position: Particles, box_size: float, *, weights: np.ndarray | None = None,
            window: int = Window.CIC, shift: float = 0.0, brick: native.Structure | None = None) -> np.ndarray:
    """Adds the masses of particles to cells: mesh_c += sum_i w_i W(x_c - x_i), W the product of B-splines of a :class:`~fixpair.Window`.

    mesh: real numbers (n, n, n), or memory of the brick; added to, so begin with zeros. position: wrapped into the box. weights: one a
    particle, any stride; 1 each if None. shift: mesh point i lies at (i + shift) L/n; 1/2 for the second mesh of interlacing. For k != 0 the
    density contrast has the modes F_k/F_0, F the forward transform. After a NaN among positions, or a particle outside the brick, the mesh
    holds some of the particles.
    """
    where, places = view(mesh, brick, Space.CONFIGURATION, "mesh", write=True), triples(position, "position")
    same(where.real, places.real, "position")
    stride = 0
    if weights is not None:
        stride, real = strided(weights, "weights")
        same(where.real, real, "weights")
        if len(weights) != places.particles:
            raise ValueError(f"weights must be {places.particles}, not {len(weights)}")
    with scratch(twin("deposit_scratch", where.real), where.brick, places.particles, window) as (memory, size):
        twin("deposit", where.real)(where.start, where.length, where.brick, places.structure, weights, stride, box_size, window,
                                    shift, memory, size, current())
    return mesh


def read_out(mesh: np.ndarray, position: Particles, box_size: float, *, window: int = Window.CIC, shift: float = 0.0,
             out: np.ndarray | None = None, brick: native.Structure | None = None) -> np.ndarray:
    """What a mesh is worth at particles: value_i = sum_c W(x_c - x_i) mesh_c, the adjoint of :func:`deposit`.

    out: one number a particle, any stride; new if None.
    """
    where, places = view(mesh, brick, Space.CONFIGURATION, "mesh"), triples(position, "position")
    same(where.real, places.real, "position")
    out = np.empty(places.particles, REALS[where.real]) if out is None else out
    stride, real = strided(out, "out", write=True)
    same(where.real, real, "out")
    if len(out) != places.particles:
        raise ValueError(f"out must have room for {places.particles} values, not {len(out)}")
    with scratch(twin("read_out_scratch", where.real), where.brick, places.particles, window) as (memory, size):
        twin("read_out", where.real)(out, stride, where.start, where.length, where.brick, places.structure, box_size, window, shift,
                                     memory, size, current())
    return out


def add_cells(target: np.ndarray, target_brick: native.Structure, source: np.ndarray, source_brick: native.Structure) -> np.ndarray:
    """Adds to a part of a mesh the cells that another part holds too: folds ghost planes after a deposit."""
    return _shared_cells("add_cells", target, target_brick, source, source_brick)


def copy_cells(target: np.ndarray, target_brick: native.Structure, source: np.ndarray, source_brick: native.Structure) -> np.ndarray:
    """Sets the cells of a part that another part holds too: fills ghost planes before a read-out."""
    return _shared_cells("copy_cells", target, target_brick, source, source_brick)


def _shared_cells(name: str, target: np.ndarray, target_brick: native.Structure, source: np.ndarray,
                  source_brick: native.Structure) -> np.ndarray:
    to = view(target, target_brick, Space.CONFIGURATION, "target", write=True)
    start = view(source, source_brick, Space.CONFIGURATION, "source")
    same(to.real, start.real, "source")
    twin(name, to.real)(to.start, to.length, to.brick, start.start, start.length, start.brick, current())
    return target


def interlace(modes: np.ndarray, shifted: np.ndarray, *, brick: native.Structure | None = None) -> np.ndarray:
    """Modes become (modes + exp(-i k.H/2) shifted)/2, H = (L/n)(1, 1, 1): odd images cancel (Sefusatti et al. 2016, arXiv:1512.07295).

    modes, shifted: of deposits of the same particles with shift 0 and 1/2.
    """
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    other = view(shifted, brick, Space.FOURIER, "shifted")
    length = alike((where, other), ("modes", "shifted"))
    twin("interlace", where.real)(where.start, other.start, length, where.brick, current())
    return modes
