"""What spectra and correlation functions are binned by, and sums in bins."""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import native
from .._arrays import vector
from .._library import library
from .._members import Members
from ..native import Multipole, Second

BIN = np.dtype(native.Bin)
"""What a bin holds: count, first (mean |n| or n_perp), second (mean mu or |n.a|)."""


class Binning(Members, native.Binning):
    """Bins of |n|, n = k L/(2 pi) or x N/L an integer vector, and of a second coordinate.

    edges: increasing values of |n|^2, uint64: bin b holds edges[b] <= |n|^2 < edges[b+1]. By name: orders (:class:`~fixpair.Multipole` combined,
    the monopole), second (:class:`~fixpair.Second`: wedges of mu, or n_perp and |n.a|) with second_edges (float64), axis (the line of sight, z).
    The arrays are kept, not copied.
    """

    _pointers = ("edges", "second_edges")
    _lengths = ("edges_len", "second_edges_len")

    def __init__(self, edges: Any, *, orders: int = Multipole.MONOPOLE, second: int = Second.NONE, second_edges: Any = None,
                 axis: Any = (0.0, 0.0, 1.0)):
        super().__init__()
        edges = vector(edges, "edges", np.uint64)
        library.binning_init(self, edges, edges.size)
        self.edges, self.orders, self.second, self.axis = edges, orders, second, tuple(axis)
        if second_edges is not None:
            self.second_edges = second_edges

    def _point(self, name: str, value: Any) -> tuple[int, np.ndarray]:
        array = vector(value, name, np.uint64 if name == "edges" else np.float64)
        self._count(f"{name}_len", array.size)
        return native.address(array), array

    def lengths(self, spectra: int = 1) -> tuple[int, int, int]:
        """Bins, values of so many spectra, and int64 of their sums."""
        bins, values, words = (ctypes.c_size_t() for _ in range(3))
        library.binning_lengths(bins, values, words, self, spectra)
        return bins.value, values.value, words.value


@dataclass
class Sums:
    """Integers that kernels add to. Those of parts of a mesh, added one by one, are those of the whole mesh bit for bit."""

    binning: Binning
    spectra: int
    words: np.ndarray

    @classmethod
    def zeros(cls, binning: Binning, spectra: int = 1) -> "Sums":
        """Sums of nothing."""
        return cls(binning, spectra, np.zeros(binning.lengths(spectra)[2], np.int64))

    def __iadd__(self, other: "Sums") -> "Sums":
        self.words += other.words
        return self

    def read(self) -> tuple[np.recarray, np.ndarray]:
        """What each bin holds, of type BIN, and the sums (spectra, bins, multipoles), rounded once."""
        count, values_len, _ = self.binning.lengths(self.spectra)
        bins, values = np.empty(count, BIN), np.empty(values_len)
        library.binning_read(bins, count, values, values_len, self.words, self.words.size, self.binning, self.spectra)
        return bins.view(np.recarray), values.reshape(self.spectra, count, -1)

    def multipoles(self, factor: float) -> tuple[np.recarray, np.ndarray]:
        """The bins, and (2l + 1) factor sum_l / count, 0 in empty bins, of shape (spectra, bins, multipoles).

        For P_l in (Mpc/h)^3 the factor is L^3 times the scale of either field: L^3/(sum of weights)^2 for the density contrast of a deposit, L^3/n^6
        for any other field, both after a transform that does not divide, L^3 for modes of this library. For xi_l it is 1.
        """
        bins, values = self.read()
        library.binning_normalise(values, values.size, bins, bins.size, self.binning.orders, factor)
        return bins, values


def edges_uniform(count: int, first: float = 1.0, width: float = 1.0) -> np.ndarray:
    """`count` edges at |n| = first + b width, as |n|^2 in uint64: the least integers that are not below, to 1e-9."""
    edges = np.empty(count, np.uint64)
    library.edges_uniform(edges, count, first, width)
    return edges


def edges_wavenumbers(wavenumbers: Any, box_size: float) -> np.ndarray:
    """Edges at wavenumbers in h/Mpc, as |n|^2 in uint64."""
    wavenumbers = vector(wavenumbers, "wavenumbers")
    edges = np.empty(wavenumbers.size, np.uint64)
    library.edges_wavenumbers(edges, wavenumbers, edges.size, box_size)
    return edges


def edges_exact(count: int, first: int = 1) -> np.ndarray:
    """Every |n|^2 a bin of its own: first, first + 1, ..."""
    edges = np.empty(count, np.uint64)
    library.edges_exact(edges, count, first)
    return edges
