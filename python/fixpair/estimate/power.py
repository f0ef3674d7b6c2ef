"""Power spectra of meshes and particles."""

import ctypes
from typing import Any, NamedTuple
from collections.abc import Sequence

import numpy as np

from .. import native
from .._arrays import Particles, alike, real_of, strided, vector, view
from .._library import library, twin
from ..fft import Fft, Transform
from ..native import Compensation, Space, Window
from ..pm.deposit import deposit, interlace
from ..threads import current
from ..workspace import scratch
from .binning import Binning, Sums


def power_sums(sums: Sums, fields: Sequence[np.ndarray], pairs: Any = ((0, 0),), *, compensation: Sequence[int] | None = None,
               brick: native.Structure | None = None) -> Sums:
    """Adds f_k g_k* L_l(mu), summed over modes bin by bin, for several pairs of fields in one sweep.

    fields: up to 8 arrays of modes, complex numbers (n, n, n/2 + 1), laid out alike. pairs: numbers of fields, (0, 0) for the spectrum of
    the first, (0, 1) for its cross spectrum with the second; as many as ``sums.spectra``. compensation: one for each field,
    Compensation.ALIASED + Window.CIC and so on. Then P_l = ``sums.multipoles(L**3)`` for modes of this library.
    """
    views = [view(field, brick, Space.FOURIER, f"fields[{number}]") for number, field in enumerate(fields)]
    length = alike(views, [f"fields[{number}]" for number in range(len(views))])
    starts = (ctypes.c_void_p * len(views))(*(each.start for each in views))
    pairs = np.ascontiguousarray(np.asarray(pairs), np.uintp)
    if pairs.shape != (sums.spectra, 2):
        raise ValueError(f"pairs must be {sums.spectra} pairs, as the sums have spectra, not {pairs.shape}")
    choices = None if compensation is None else vector(list(compensation), "compensation", np.int32, len(views))
    with scratch(library.power_sums_scratch, views[0].brick, sums.binning, sums.spectra) as (memory, size):
        twin("power_sums", views[0].real)(sums.words, sums.words.size, starts, len(views), length, pairs, sums.spectra, choices,
                                          views[0].brick, sums.binning, memory, size, current())
    return sums


def shot_noise(particles: int, box_size: float, weights: np.ndarray | None = None) -> float:
    """V sum w^2/(sum w)^2, or V/N without weights, V = L^3."""
    noise = ctypes.c_double()
    stride, real = (0, "f64") if weights is None else strided(weights, "weights")
    if weights is not None and len(weights) != particles:
        raise ValueError(f"weights must be {particles}, not {len(weights)}")
    twin("shot_noise", real)(noise, weights, stride, particles, box_size)
    return noise.value


def subtract_shot_noise(values: np.ndarray, pairs: Any, bins: np.ndarray, orders: int, noise: Any) -> np.ndarray:
    """Subtracts shot noise, one number a field, from the monopoles of auto spectra (spectra, bins, multipoles), in place."""
    values, noise = vector(values, "values", write=True), vector(noise, "noise")
    pairs = np.ascontiguousarray(np.asarray(pairs), np.uintp).reshape(-1, 2)
    library.subtract_shot_noise(values, values.size, pairs, len(pairs), vector(bins, "bins", native_bin(bins)), bins.size, orders, noise,
                                noise.size)
    return values


def native_bin(bins: np.ndarray) -> np.dtype:
    """The type of bins, also of a record array of them."""
    if bins.dtype != np.dtype(native.Bin) and np.dtype((np.record, np.dtype(native.Bin))) != bins.dtype:
        raise TypeError(f"bins must be of type BIN, not {bins.dtype}")
    return bins.dtype


def compensate(modes: np.ndarray, compensation: int, scale: float = 1.0, *, brick: native.Structure | None = None) -> np.ndarray:
    """f_k <- scale f_k, divided by the window, in place: for functions that take modes as they are, as bispectra do.

    scale: 1/(sum of weights) for the density contrast of a deposit after a transform that does not divide.
    """
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    with scratch(library.compensate_scratch, where.brick) as (memory, size):
        twin("compensate", where.real)(where.start, where.length, compensation, scale, where.brick, memory, size, current())
    return modes


class Power(NamedTuple):
    """A spectrum: wavenumbers (h/Mpc), P_l of shape (bins, multipoles) in (Mpc/h)^3, modes in each bin, shot noise (not subtracted)."""

    k: np.ndarray
    multipoles: np.ndarray
    modes: np.ndarray
    noise: float


def power_spectrum(position: Particles, box_size: float, binning: Binning, mesh: Any, *, weights: np.ndarray | None = None,
                   window: int = Window.TSC, interlaced: bool = False, dtype: Any = None) -> Power:
    """The spectrum of particles in one call: deposit, transform, compensate, bin.

    mesh: cells a side, or a transform. interlaced: two meshes, shifted by half a cell, of which images of the field cancel; else modes are
    divided by the root of the window's aliased power, so that shot noise is flat.
    """
    first = position if isinstance(position, np.ndarray) else position[0]
    fft = mesh if isinstance(mesh, Transform) else Fft(mesh, dtype or first.dtype)
    if real_of(first.dtype) != fft.real:
        raise TypeError(f"positions are {first.dtype}, but the transform is {fft.dtype}")
    data = fft.mesh()
    deposit(fft.cells(data), position, box_size, weights=weights, window=window)
    modes = fft.forward(data)
    if interlaced:
        shifted = fft.mesh()
        deposit(fft.cells(shifted), position, box_size, weights=weights, window=window, shift=0.5)
        interlace(modes, fft.forward(shifted))
    choice = (Compensation.WINDOW if interlaced else Compensation.ALIASED) + window
    sums = power_sums(Sums.zeros(binning), [modes], compensation=[choice])
    count = len(first)
    mass = float(count) if weights is None else float(np.sum(weights, dtype=np.float64))
    bins, values = sums.multipoles(box_size**3 / mass**2)
    return Power(bins.first * (2 * np.pi / box_size), values[0], bins.count, shot_noise(count, box_size, weights))
