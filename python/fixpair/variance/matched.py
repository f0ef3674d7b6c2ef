"""Matched simulations, whose seeds are the same, and control variates."""

import ctypes
from typing import Any

import numpy as np

from .. import native
from .._arrays import vector
from .._library import library
from ..native import Beta
from ..workspace import scratch
from .ensemble import rows_of
from .models import vectors

CONTROL_VARIATE = np.dtype(native.ControlVariate)
"""The expectation of y: mean, error, beta, correlation, deviation, gain."""


def matched_difference(first: Any, second: Any) -> native.Structure:
    """Delta f = f100 - f0 of the same seeds in the same order (Avila & Adame 2022, Eq. diff); a pair is one estimate.

    A structure: mean_first, mean_second, deviation_first, deviation_second, correlation, correlation_error, mean, deviation, error_of_mean.
    """
    arrays, difference = vectors(first=first, second=second), native.DifferenceOfMatched()
    library.matched_difference(difference, *arrays, arrays[0].size)
    return difference


def difference_sigma(first: float, second: float, correlation: float) -> float:
    """sqrt(s1^2 + s2^2 - 2 rho s1 s2) (Eq. correlation)."""
    sigma = ctypes.c_double()
    library.difference_sigma(sigma, first, second, correlation)
    return sigma.value


def effective_volume(reference: float, sigma: float, *, reference_simulations: int = 1, simulations: int = 1) -> float:
    """V_eff/V = (sigma_ref/sigma)^2 (m_ref/m): how many simulations of the reference one is worth; an estimate costs m simulations."""
    volume = ctypes.c_double()
    library.effective_volume(volume, reference, reference_simulations, sigma, simulations)
    return volume.value


def universality(b_g: float, b_g_error: float, f_nl: float, f_nl_error: float, f_true: float, *,
                 covariance: float = 0.0) -> tuple[float, float]:
    """p = b - (b - 1) f/f_true of halos whose f_NL was measured as if p = 1, in a universe of f_true (Eq. p), and its error."""
    p, error = ctypes.c_double(), ctypes.c_double()
    library.universality(p, error, b_g, b_g_error, f_nl, f_nl_error, covariance, f_true)
    return p.value, error.value


def control_variates(y: Any, c: Any, mu: Any, *, error: Any = None, beta: float | None = None) -> np.ndarray:
    """<y> - beta (<c> - mu): the expectation of y from few simulations, by controls c of the same seeds whose expectation mu is known.

    y, c: (N, values). error: standard error of mu, None where it is exact. beta: a number; None for cov(y, c)/(var(c) + N error^2), of least
    scatter. Returns an array of type CONTROL_VARIATE, one for each value (CARPool, Chartier et al. 2021, arXiv:2009.08970).
    """
    y = rows_of(y, "y")
    c, mu = vector(c, "c", shape=y.shape), vector(mu, "mu", length=y.shape[1])
    error = None if error is None else vector(error, "error", length=y.shape[1])
    values = np.empty(y.shape[1], CONTROL_VARIATE)
    choice = Beta.OPTIMAL if beta is None else Beta.GIVEN
    with scratch(library.control_variates_scratch, len(y)) as (memory, size):
        library.control_variates(values, values.size, y, c, len(y), mu, error, choice, 0.0 if beta is None else beta, memory, size)
    return values


def control_variate_gain(sigma_y: float, sigma_c: float, correlation: float, beta: float) -> float:
    """V_eff of y - beta c over that of y: 1/(1 - rho^2) for the optimum beta = rho sigma_y/sigma_c."""
    gain = ctypes.c_double()
    library.control_variate_gain(gain, sigma_y, sigma_c, correlation, beta)
    return gain.value


def control_variate_loss(estimates: int, controls: int = 1) -> float:
    """(N - 2)/(N - q - 2): how much the variance of a mean grows because q coefficients come from the same N samples."""
    loss = ctypes.c_double()
    library.control_variate_loss(loss, estimates, controls)
    return loss.value
