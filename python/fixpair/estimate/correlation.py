"""Correlation functions by transforms."""

import ctypes
from collections.abc import Sequence

import numpy as np

from .. import native
from .._arrays import alike, view
from .._library import library, twin
from ..native import Compensation, Space
from ..threads import current
from ..workspace import scratch
from .binning import Sums


def correlation_modes(modes: np.ndarray, other: np.ndarray | None = None, *, compensation: int = Compensation.NONE,
                      other_compensation: int = Compensation.NONE, scale: float = 1.0,
                      brick: native.Structure | None = None) -> np.ndarray:
    """f_k <- scale f_k g_k*, compensated, in place; the inverse transform then gives xi(x) = <f(y + x) g(y)> on the mesh.

    other: g, laid out as f; None for f itself. scale: of both fields together, 1/(sum of weights)^2 for the density contrast of a deposit.
    """
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    second = None if other is None else view(other, brick, Space.FOURIER, "other")
    length = where.length if second is None else alike((where, second), ("modes", "other"))
    with scratch(library.correlation_modes_scratch, where.brick) as (memory, size):
        twin("correlation_modes", where.real)(where.start, second and second.start, length, compensation, other_compensation, scale,
                                              where.brick, memory, size, current())
    return modes


def correlation_sums(sums: Sums, meshes: Sequence[np.ndarray], *, brick: native.Structure | None = None) -> Sums:
    """Adds xi(x) L_l(mu), summed over separations bin by bin; |n|^2 of the binning is that of the separation in cells.

    meshes: as many as ``sums.spectra``, real numbers (n, n, n) laid out alike. Then xi_l = ``sums.multipoles(1.0)``.
    """
    names = [f"meshes[{number}]" for number in range(len(meshes))]
    views = [view(mesh, brick, Space.CONFIGURATION, name) for mesh, name in zip(meshes, names)]
    length = alike(views, names)
    if len(views) != sums.spectra:
        raise ValueError(f"the sums are of {sums.spectra} meshes, not {len(views)}")
    starts = (ctypes.c_void_p * len(views))(*(each.start for each in views))
    with scratch(library.correlation_sums_scratch, views[0].brick, sums.binning, len(views)) as (memory, size):
        twin("correlation_sums", views[0].real)(sums.words, sums.words.size, starts, len(views), length, views[0].brick, sums.binning,
                                                memory, size, current())
    return sums
