"""Primordial non-Gaussianity on modes of the potential."""

import ctypes

import numpy as np

from .. import native
from .._arrays import same, vector, view
from .._library import library, twin
from ..fft import Transform
from ..native import Space
from ..threads import current
from ..workspace import scratch

SHAPE_ROW = np.dtype(native.ShapeRow)
"""One separable product c X_out[(X_a Phi)(X_b Phi)]: coefficient, s_out, s_a, s_b."""


def shape_rows(shape: int) -> np.ndarray:
    """The rows of a :class:`~fixpair.Shape`, of type SHAPE_ROW: to see them, to change them, or to add others."""
    rows, count = np.empty(8, SHAPE_ROW), ctypes.c_size_t()
    library.shape_rows(rows, rows.size, count, shape)
    return rows[:count.value].copy()


def add_local(modes: np.ndarray, f_nl: float, g_nl: float, work: Transform, *,
              brick: native.Structure | None = None) -> np.ndarray:
    """Local non-Gaussianity, in place: Phi -> Phi + f_nl (Phi^2 - <Phi^2>) + g_nl (Phi^3 - 3 <Phi^2> Phi).

    modes: of Phi, complex numbers (n, n, n/2 + 1), after fixing and inverting and before alpha. work: the transform on which products are
    taken: of side n (they alias), or of side 3n/2 or more (2n with g_nl: exact).
    """
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    same(work.real, where.real, "modes")
    mesh = work.mesh()
    with work.use() as hook, scratch(twin("add_local_scratch", work.real), hook) as (memory, size):
        twin("add_local", work.real)(where.start, where.length, where.brick, f_nl, g_nl, hook, mesh, mesh.size, memory, size,
                                     current())
    return modes


def add_shape(modes: np.ndarray, f_nl: float, n_s: float, rows: np.ndarray, work: Transform, *,
              brick: native.Structure | None = None) -> np.ndarray:
    """Quadratic non-Gaussianity of any shape, in place: Phi -> Phi + f_nl sum over rows of c X_out[(X_a Phi)(X_b Phi)].

    (X_s f)_k is |n|^(e s) f_k, e = (4 - n_s)/3, n = k L/(2 pi). rows: of :func:`shape_rows` or your own; exponents of a row sum to
    0. modes and work as for :func:`add_local`.
    """
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    same(work.real, where.real, "modes")
    rows = vector(rows, "rows", SHAPE_ROW)
    with work.use() as hook, scratch(twin("add_shape_scratch", work.real), where.brick, hook) as (memory, size):
        twin("add_shape", work.real)(where.start, where.length, where.brick, f_nl, n_s, rows, rows.size, hook, memory, size,
                                     current())
    return modes
