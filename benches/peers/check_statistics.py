"""Runs the statistics of fixpair's shared library beside numpy and scipy on the same numbers; check_statistics.py PATH. Each line is an agreement
that is asserted: what, whose, and the relative difference."""

import ctypes
import sys

import numpy as np
from scipy.optimize import curve_fit
from scipy.stats import chi2, pearsonr

from fixpair import Library

COVARIANCE, HALO_HALO, B_G, F_NL = 1, 0, 1, 4
# Sums of a thousand terms round to 1e-13. scipy ends where chi^2 changes by 1e-8: parameters agree to its root, errors to some times that.
ROUNDING, MINIMUM = 1e-11, 1e-3


class Bias(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("b_g", "p", "f_nl", "delta_c")]


class Likelihood(ctypes.Structure):
    _fields_ = [("bins", ctypes.c_uint64), ("root", ctypes.c_double * 36)]


class BiasFit(ctypes.Structure):
    _fields_ = [("value", Bias), ("error", ctypes.c_double * 3), ("covariance", ctypes.c_double * 9),
                ("chi_squared", ctypes.c_double), ("degrees", ctypes.c_uint64)]


class SuppressionFit(ctypes.Structure):
    _fields_ = [("value", ctypes.c_double * 3), ("error", ctypes.c_double * 3), ("covariance", ctypes.c_double * 9),
                ("chi_squared", ctypes.c_double), ("degrees", ctypes.c_uint64)]


class Difference(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in
                ("mean_first", "mean_second", "deviation_first", "deviation_second", "correlation", "correlation_error", "mean",
                 "deviation", "error_of_mean")]


def agree(what, peer, ours, theirs, limit):
    ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
    difference = np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs))
    print(f"{what:<40} {peer:<28} {difference:9.1e}  of {limit:.0e}")
    assert difference <= limit, what


def ensembles(library, rng):
    samples = rng.normal(3e4, 2.0, (1000, 40)) + rng.normal(0.0, 1.0, (1000, 1))
    length = ctypes.c_size_t()
    library.call("ensemble_length", length, 40, COVARIANCE)
    state, covariance = np.zeros(length.value), np.zeros((40, 40))
    library.call("ensemble_init", state, state.size, 40, COVARIANCE)
    library.call("ensemble_add", state, state.size, samples, samples.size)
    library.call("ensemble_covariance", covariance, 40, 40, state, state.size, 0, 0)
    # numpy subtracts a mean that is rounded to 1e-16 of 3e4.
    agree("covariance", "numpy.cov", covariance, np.cov(samples, rowvar=False), 1e-9)
    root = np.zeros((40, 40))
    library.call("covariance_root", root, covariance, 40, *library.scratch("covariance_root_scratch", 40))
    agree("Cholesky factor", "numpy.linalg.cholesky", root, np.linalg.cholesky(covariance), ROUNDING)
    found = Difference()
    first, second = samples[:, 0].copy(), samples[:, 1].copy()
    library.call("matched_difference", found, first, second, 1000)
    agree("correlation of two lists", "scipy.stats.pearsonr", found.correlation, pearsonr(first, second)[0], ROUNDING)
    agree("deviation of their difference", "numpy.std", found.deviation, np.std(first - second, ddof=1), ROUNDING)
    delta = ctypes.c_double()
    for parameters in (1, 2):
        library.call("delta_chi_squared", delta, 0.9, parameters)
        agree(f"Delta chi^2 of {parameters} parameters", "scipy.stats.chi2.ppf", delta.value, chi2.ppf(0.9, parameters), ROUNDING)


def fits(library, rng):
    b = np.arange(1.0, 15.0)
    k = 0.006283 * b
    linear = 4e5 * k / (1.0 + (k / 0.02) ** 2) ** 1.2
    alpha = 1.05e7 * k * k / (1.0 + (k / 0.05) ** 2)

    def model(_, b_g, f_nl):
        return (b_g + 2.0 * 1.686 * (b_g - 1.0) * f_nl / alpha) ** 2 * linear

    power = model(k, 2.32, 100.0)
    sigma = 0.3 * (power + 4000.0) * np.sqrt(2.0 / (4.0 * np.pi * b * b))
    power = power + sigma * rng.normal(size=14)
    likelihood, start, fit = Likelihood(), Bias(), BiasFit()
    library.call("likelihood_init", likelihood)
    library.call("likelihood_add", likelihood, power, sigma, linear, alpha, 14, HALO_HALO)
    library.call("bias_init", start)
    library.call("fit_bias", fit, likelihood, start, B_G | F_NL)
    best, covariance = curve_fit(model, k, power, p0=[2.0, 50.0], sigma=sigma, absolute_sigma=True)
    agree("b_g and f_NL", "scipy.optimize.curve_fit", np.array([fit.value.b_g, fit.value.f_nl]) / best, [1.0, 1.0], MINIMUM)
    agree("their errors", "scipy.optimize.curve_fit", np.array([fit.error[0], fit.error[2]]) / np.sqrt(np.diag(covariance)), [1.0, 1.0], MINIMUM)
    agree("chi^2", "numpy", fit.chi_squared, np.sum(((power - model(k, *best)) / sigma) ** 2), 1e-7)

    b = np.arange(1.0, 64.0)
    k, modes = 0.006283 * b, 4.0 * np.pi * b * b
    linear = 4e5 * k / (1.0 + (k / 0.02) ** 2) ** 1.2

    def suppressed(_, r_cv, k_soft, f_sn):
        return np.sqrt(2.0 / modes) * (linear * (r_cv + (1.0 - r_cv) * 2.0 / np.pi * np.arctan(k / k_soft)) + f_sn * 4000.0)

    sigma = suppressed(k, 0.141, 0.114, 1.174) * (1.0 + 0.11 * rng.normal(size=63))
    error = sigma / np.sqrt(80.0)
    found = SuppressionFit()
    library.call("fit_suppression", found, sigma, error, k, linear, modes, 63, 4000.0, 41)
    best, covariance = curve_fit(suppressed, k, sigma, p0=[0.2, 0.1, 1.0], sigma=error, absolute_sigma=True)
    agree("R_cv, k_soft, f_sn", "scipy.optimize.curve_fit", np.array(found.value) / best, np.ones(3), MINIMUM)
    agree("their errors", "scipy.optimize.curve_fit", np.array(found.error) / np.sqrt(np.diag(covariance)), np.ones(3), MINIMUM)


if __name__ == "__main__":
    shared = Library(sys.argv[1])
    ensembles(shared, np.random.default_rng(1))
    fits(shared, np.random.default_rng(2))
