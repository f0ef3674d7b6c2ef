"""Bispectra: sums over cells of D_i D_j D_k, D_s the field of shell s."""

import ctypes
from typing import Any
from collections.abc import Sequence

import numpy as np

from .. import native
from .._arrays import alike, vector, view
from .._library import library, twin
from ..fft import Transform
from ..mesh import Brick
from ..native import BISPECTRUM_WORDS, Space
from ..threads import current
from ..workspace import aligned, scratch
from .triangles import triangles_of


def shell_modes(modes: np.ndarray, low: int, high: int, *, out: np.ndarray | None = None,
                brick: native.Structure | None = None) -> np.ndarray:
    """Copies the modes of one shell, low <= |n|^2 < high, and makes all others zero; `out` is laid out as `modes`, new if None."""
    start = view(modes, brick, Space.FOURIER, "modes")
    if out is None:
        out = Brick.from_buffer_copy(start.brick).zeros(modes.real.dtype)
    where = view(out, start.brick, Space.FOURIER, "out", write=True)
    length = alike((start, where), ("modes", "out"))
    twin("shell_modes", start.real)(where.start, start.start, length, start.brick, low, high, current())
    return out


def bispectrum_sums(sums: np.ndarray | None, triangles: Any, fields: Sequence[np.ndarray], *,
                    brick: native.Structure | None = None) -> np.ndarray:
    """Adds sum over cells of D_i D_j D_k, for each triangle (T, 3) of shells, to int64 (T, BISPECTRUM_WORDS); zeros if None.

    fields: of each shell, real numbers (n, n, n) laid out alike: inverse transforms of :func:`shell_modes`.
    """
    triangles = triangles_of(triangles)
    sums = _sums(sums, len(triangles))
    names = [f"fields[{number}]" for number in range(len(fields))]
    views = [view(field, brick, Space.CONFIGURATION, name) for field, name in zip(fields, names)]
    length = alike(views, names)
    starts = (ctypes.c_void_p * len(views))(*(each.start for each in views))
    where, real = views[0].brick, views[0].real
    with scratch(twin("bispectrum_sums_scratch", real), where, len(views), len(triangles)) as (memory, size):
        twin("bispectrum_sums", real)(sums, sums.size, triangles, len(triangles), starts, len(views), length, where, memory, size,
                                      current())
    return sums


def bispectrum(sums: np.ndarray | None, triangles: Any, edges: Any, modes: np.ndarray, fft: Transform, *,
               meshes: int | None = None) -> np.ndarray:
    """From modes to the sums of all triangles, with the shells' transforms.

    modes: data of ``fft`` that holds delta(x) = sum_k delta_k exp(+i k.x); those of a deposit compensated before. edges: |n|^2, uint64; the last at
    most (n/2)^2. meshes: how many to work on, at least 3; with fewer than shells they come and go, and the bits are the same.
    """
    triangles, edges = triangles_of(triangles), vector(edges, "edges", np.uint64)
    sums, shells = _sums(sums, len(triangles)), edges.size - 1
    fft.check(modes, "modes")
    reals = ctypes.c_size_t()
    with fft.use() as hook:
        twin("bispectrum_meshes", fft.real)(reals, hook, max(shells, 3) if meshes is None else meshes)
        fields = aligned(reals.value, fft.dtype)
        with scratch(twin("bispectrum_scratch", fft.real), hook, shells, len(triangles)) as (memory, size):
            twin("bispectrum", fft.real)(sums, sums.size, None, triangles, len(triangles), edges, edges.size, modes, modes.size, hook,
                                         fields, fields.size, memory, size, current())
    return sums


def _sums(sums: np.ndarray | None, triangles: int) -> np.ndarray:
    shape = (triangles, BISPECTRUM_WORDS)
    return np.zeros(shape, np.int64) if sums is None else vector(sums, "sums", np.int64, shape=shape, write=True)


def bispectrum_values(sums: np.ndarray) -> np.ndarray:
    """Sums (T, BISPECTRUM_WORDS) as numbers, one a triangle, each rounded once."""
    sums = vector(sums, "sums", np.int64)
    values = np.empty(len(sums))
    library.bispectrum_values(values, values.size, sums, sums.size)
    return values


def bispectrum_normalise(values: np.ndarray, counts: np.ndarray, n: int, box_size: float, scale: float = 1.0) -> np.ndarray:
    """B = V^2 (scale^3/n^3) value/count, V = L^3, in place; 0 where no modes close the triangle. In L^6.

    counts: of triangle_counts. scale: of the field, 1 for modes of this library and those that `compensate` brought to scale.
    """
    values, counts = vector(values, "values", write=True), vector(counts, "counts", np.uint64, values.size)
    library.bispectrum_normalise(values, counts, values.size, n, box_size, scale)
    return values


def bispectrum_shot_noise(triangles: Any, power: Any, noise: float) -> np.ndarray:
    """(P_i + P_j + P_k) noise + noise^2 of points of equal weight; power: one value a shell, free of shot noise."""
    triangles, power = triangles_of(triangles), vector(power, "power")
    out = np.empty(len(triangles))
    library.bispectrum_shot_noise(out, triangles, len(triangles), power, power.size, noise)
    return out


def bispectrum_reduced(values: Any, triangles: Any, power: Any) -> np.ndarray:
    """Q = B/(P_i P_j + P_j P_k + P_k P_i); 0 where the denominator is."""
    triangles, power = triangles_of(triangles), vector(power, "power")
    values = vector(values, "values", length=len(triangles))
    out = np.empty(len(triangles))
    library.bispectrum_reduced(out, values, triangles, len(triangles), power, power.size)
    return out
