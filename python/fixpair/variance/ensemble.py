"""Ensembles of estimates, pairs, jackknife and bootstrap."""

import ctypes
from typing import Any

import numpy as np

from .._arrays import vector
from .._library import library
from ..native import Moments


def rows_of(samples: Any, name: str) -> np.ndarray:
    """Samples of shape (N, values), an estimate a row."""
    samples = vector(samples, name)
    if samples.ndim != 2:
        raise ValueError(f"{name} must have the shape (N, values), not {samples.shape}")
    return samples


class Ensemble:
    """Mean, scatter and covariance of samples that come one by one (Welford 1962; Chan, Golub & LeVeque 1979).

    ::

        ensemble = Ensemble(bins)
        for each estimate: ensemble.add(power)            # a simulation, or the average of a pair: a pair counts once
        ensemble.deviation()

    values: numbers in a sample. covariance: whether pairs of values are kept too. ``state`` is all of it, float64: to be saved, sent, and
    given back by :meth:`merge`.
    """

    def __init__(self, values: int, covariance: bool = False):
        length = ctypes.c_size_t()
        moments = Moments.COVARIANCE if covariance else Moments.VARIANCE
        library.ensemble_length(length, values, moments)
        self.values, self.state = values, np.empty(length.value)
        library.ensemble_init(self.state, length.value, values, moments)

    def add(self, samples: Any) -> None:
        """Adds a sample of shape (values,), or several of shape (N, values)."""
        samples = vector(samples, "samples")
        if samples.shape[-1] != self.values:
            raise ValueError(f"samples must have {self.values} values, not {samples.shape[-1]}")
        library.ensemble_add(self.state, self.state.size, samples, samples.size)

    def merge(self, other: "Ensemble") -> None:
        """Adds all samples of another ensemble."""
        state = vector(other.state, "other.state", length=self.state.size)
        library.ensemble_merge(self.state, self.state.size, state)

    def __len__(self) -> int:
        count = ctypes.c_uint64()
        library.ensemble_count(count, self.state, self.state.size)
        return count.value

    def mean(self) -> np.ndarray:
        """Mean of each value."""
        return self._moment(library.ensemble_mean)

    def deviation(self) -> np.ndarray:
        """Standard deviation of each value, with N - 1."""
        return self._moment(library.ensemble_deviation)

    def error_of_mean(self) -> np.ndarray:
        """The deviation over sqrt(N)."""
        return self._moment(library.ensemble_error_of_mean)

    def _moment(self, function: Any) -> np.ndarray:
        out = np.empty(self.values)
        function(out, out.size, self.state, self.state.size)
        return out

    def covariance(self, rows: slice | None = None, columns: slice | None = None) -> np.ndarray:
        """The covariance, with N - 1, or a block of it: of the values of one slice with those of another, both of step 1."""
        return self._block(library.ensemble_covariance, rows, columns)

    def correlation(self, rows: slice | None = None, columns: slice | None = None) -> np.ndarray:
        """The same of correlation coefficients."""
        return self._block(library.ensemble_correlation, rows, columns)

    def _block(self, function: Any, rows: slice | None, columns: slice | None) -> np.ndarray:
        ranges = [range(self.values)[each or slice(None)] for each in (rows, columns)]
        if any(each.step != 1 for each in ranges):
            raise ValueError("rows and columns must be slices of step 1")
        out = np.empty([len(each) for each in ranges])
        function(out, *out.shape, self.state, self.state.size, *(each.start for each in ranges))
        return out


def pair_average(original: Any, inverted: Any) -> np.ndarray:
    """P_paired = (P_original + P_inverted)/2 (Avila & Adame 2022, Eq. pair): one estimate that costs two simulations."""
    original, inverted = vector(original, "original"), vector(inverted, "inverted")
    if original.shape != inverted.shape:
        raise ValueError(f"inverted must have the shape {original.shape}, not {inverted.shape}")
    out = np.empty(original.shape)
    library.pair_average(out, original, inverted, out.size)
    return out


def sigma_per_simulation(deviation: Any, estimates: int, simulations: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """sqrt(simulations) times the deviation of estimates (Eq. sigma_paired), and its error sigma/sqrt(2 (N - 1)) (Eq. errerr).

    estimates: N independent ones; 41 pairs are 41. simulations: that one estimate costs, 2 for a pair.
    """
    deviation = vector(deviation, "deviation")
    sigma, error = np.empty(deviation.shape), np.empty(deviation.shape)
    library.sigma_per_simulation(sigma, error, deviation, deviation.size, estimates, simulations)
    return sigma, error


def bootstrap_indices(estimates: int, seed: int, replicate: int, count: int | None = None) -> np.ndarray:
    """Which estimates make up a replicate, uint64: a function of seed, replicate and place alone, the same for matched ensembles."""
    indices = np.empty(estimates if count is None else count, np.uint64)
    library.bootstrap_indices(indices, indices.size, estimates, seed, replicate)
    return indices


def resampled_mean(samples: Any, indices: Any) -> np.ndarray:
    """Mean of the rows of (N, values) that indices name."""
    samples, indices = rows_of(samples, "samples"), vector(indices, "indices", np.uint64)
    out = np.empty(samples.shape[1])
    library.resampled_mean(out, out.size, samples, len(samples), indices, indices.size)
    return out


def jackknife_means(samples: Any) -> np.ndarray:
    """The mean of all rows but one, for each row of (N, values)."""
    samples = rows_of(samples, "samples")
    out = np.empty(samples.shape)
    library.jackknife_means(out, samples, *samples.shape)
    return out


def jackknife(whole: Any, deleted: Any) -> tuple[np.ndarray, np.ndarray]:
    """N whole - (N - 1) <deleted>, and the error sqrt((N - 1)/N sum (deleted - <deleted>)^2) (Quenouille 1956, Tukey 1958).

    whole: statistics of all rows. deleted: (N, values), the same without row 0, without row 1, ...
    """
    deleted = rows_of(deleted, "deleted")
    whole = vector(whole, "whole", length=deleted.shape[1])
    corrected, error = np.empty(whole.size), np.empty(whole.size)
    library.jackknife(corrected, error, whole, whole.size, deleted, len(deleted))
    return corrected, error


def jackknife_covariance(deleted: Any) -> np.ndarray:
    """(N - 1)/N sum of products about their mean."""
    deleted = rows_of(deleted, "deleted")
    out = np.empty((deleted.shape[1],) * 2)
    library.jackknife_covariance(out, deleted, *deleted.shape)
    return out
