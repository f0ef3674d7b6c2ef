"""Models of scatter: Eq. sigma_th and Eq. sigma_fix of Avila & Adame 2022 (arXiv:2204.11103)."""

from typing import Any

import numpy as np

from .. import native
from .._arrays import vector
from .._library import library
from .._members import Members


class Suppression(Members, native.Suppression):
    """What fixing, or fixing and pairing, leaves of the scatter: cosmic_variance R_cv, softening k_soft (h/Mpc), shot_noise f_sn."""

    def __init__(self, cosmic_variance: float, softening: float, shot_noise: float = 1.0):
        super().__init__(cosmic_variance, softening, shot_noise)


def vectors(length: int | None = None, **values: Any) -> list[np.ndarray]:
    """Several arrays of one length."""
    found: list[np.ndarray] = []
    for name, each in values.items():
        found.append(vector(each, name, length=found[0].size if found else length))
    return found


def continuum_modes(k: Any, width: float, box_size: float) -> np.ndarray:
    """N_k = L^3 k^2 dk/(2 pi^2), counting k and -k."""
    k = vector(k, "k")
    out = np.empty(k.shape)
    library.continuum_modes(out, k, k.size, width, box_size)
    return out


def lattice_modes(edges: Any) -> np.ndarray:
    """The exact number of modes with edges[b] <= |n|^2 < edges[b + 1], uint64: 26, 66, 158, 234, ... of edges 1, 4, 9, 16, ..."""
    edges = vector(edges, "edges", np.uint64)
    counts = np.empty(max(edges.size - 1, 0), np.uint64)
    library.lattice_modes(counts, edges, edges.size)
    return counts


def sigma_gaussian(power: Any, modes: Any, noise: float = 0.0) -> np.ndarray:
    """sqrt(2/N_k) (P + noise), the scatter of P of a Gaussian field sampled by Poisson points (Eq. sigma_th). noise: 1/n."""
    power, modes = vectors(power=power, modes=modes)
    out = np.empty(power.shape)
    library.sigma_gaussian(out, power, modes, out.size, noise)
    return out


def sigma_suppressed(suppression: native.Structure, k: Any, power: Any, modes: Any, noise: float = 0.0) -> np.ndarray:
    """sqrt(2/N_k) (P [R_cv + (1 - R_cv) (2/pi) atan(k/k_soft)] + f_sn noise), per fixed simulation (Eq. sigma_fix)."""
    k, power, modes = vectors(k=k, power=power, modes=modes)
    out = np.empty(k.shape)
    library.sigma_suppressed(out, suppression, k, power, modes, out.size, noise)
    return out


def fit_suppression(sigma: Any, k: Any, power: Any, modes: Any, noise: float = 0.0, *, error: Any = None,
                    estimates: int = 0) -> native.Structure:
    """Fits R_cv, k_soft and f_sn to a measured scatter per simulation by weighted least squares.

    error: of the scatter; without it sigma_r/sqrt(2 (N - 1)) of the model with N = estimates, by iteration. Returns a structure: value and error
    (each with cosmic_variance, softening, shot_noise), covariance (9 numbers), chi_squared, degrees.
    """
    sigma, k, power, modes = vectors(sigma=sigma, k=k, power=power, modes=modes)
    error = None if error is None else vector(error, "error", length=sigma.size)
    fit = native.SuppressionFit()
    library.fit_suppression(fit, sigma, error, k, power, modes, sigma.size, noise, estimates)
    return fit


def ratio_of_means(above: Any, above_error: Any, below: Any, below_error: Any, correlation: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """a/b, Fixed over Normal, and its error |a/b| sqrt(r_a^2 + r_b^2 - 2 rho r_a r_b), r the relative errors.

    correlation: rho of the two means, for simulations that share their seeds that of their values; None for independent ones.
    """
    means = vectors(above=above, above_error=above_error, below=below, below_error=below_error)
    correlation = None if correlation is None else vector(correlation, "correlation", length=means[0].size)
    ratio, error = np.empty(means[0].shape), np.empty(means[0].shape)
    library.ratio_of_means(ratio, error, *means, correlation, ratio.size)
    return ratio, error


def difference_of_means(first: Any, first_error: Any, second: Any, second_error: Any, sigma: Any,
                        correlation: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """(first - second)/sigma, as of (B_Fixed - B_Normal)/sigma_Normal, and its error; correlation as for :func:`ratio_of_means`."""
    *means, sigma = vectors(first=first, first_error=first_error, second=second, second_error=second_error, sigma=sigma)
    correlation = None if correlation is None else vector(correlation, "correlation", length=sigma.size)
    difference, error = np.empty(sigma.shape), np.empty(sigma.shape)
    library.difference_of_means(difference, error, *means, correlation, sigma, sigma.size)
    return difference, error
