"""Bias with local primordial non-Gaussianity, and what spectra say of it."""

import ctypes
from typing import Any, NamedTuple
from collections.abc import Sequence

import numpy as np

from .. import native
from .._arrays import vector
from .._library import library
from .._members import Members
from ..native import Free, Spectrum
from ..workspace import scratch
from .models import vectors


class Bias(Members, native.Bias):
    """b(k) = b_g + 2 delta_c (b_g - p) f_NL/alpha(k, z) (Avila & Adame 2022, Eq. bk).

    By name: b_g (1), p (1 for universality), f_nl (0), delta_c (1.686).
    """

    def __init__(self, **members: float):
        super().__init__()
        library.bias_init(self)
        self._set(members)


def bias_of_k(bias: native.Structure, alpha: Any) -> np.ndarray:
    """b(k). alpha: of fixpair.cosmology.alpha at the redshift of the halos, in the convention of f_NL."""
    alpha = vector(alpha, "alpha")
    out = np.empty(alpha.shape)
    library.bias_of_k(out, bias, alpha, out.size)
    return out


def halo_power(bias: native.Structure, linear: Any, alpha: Any, spectrum: int = Spectrum.HALO_HALO) -> np.ndarray:
    """b^2 P_lin or b P_lin, P_lin of matter at the redshift of the halos."""
    linear, alpha = vectors(linear=linear, alpha=alpha)
    out = np.empty(linear.shape)
    library.halo_power(out, bias, linear, alpha, out.size, spectrum)
    return out


def measured_bias(power: Any, sigma: Any, linear: Any, spectrum: int = Spectrum.HALO_HALO) -> tuple[np.ndarray, np.ndarray]:
    """sqrt(P_hh/P_lin) or P_hm/P_lin, and the error that sigma makes. P_hh without shot noise."""
    power, sigma, linear = vectors(power=power, sigma=sigma, linear=linear)
    out, error = np.empty(power.shape), np.empty(power.shape)
    library.measured_bias(out, error, power, sigma, linear, out.size, spectrum)
    return out, error


class BiasFit(NamedTuple):
    """The best parameters, errors and covariance of (b_g, p, f_NL), 0 for those that are not free, chi^2, degrees of freedom."""

    value: native.Structure
    error: np.ndarray
    covariance: np.ndarray
    chi_squared: float
    degrees: int


def _fit(found: native.Structure) -> BiasFit:
    return BiasFit(found.value, np.array(found.error), np.array(found.covariance).reshape(3, 3), found.chi_squared, found.degrees)


class Likelihood:
    """All that measured spectra say of b_g, p and f_NL, exp(-chi^2/2) with chi^2 = (d - m)^T C^-1 (d - m).

    ::

        likelihood = Likelihood()
        likelihood.add(power, sigma, linear, alpha)
        fit, (b_g, f_nl) = likelihood.posterior(Free.B_G | Free.F_NL)

    Spectra of P_hh, of P_hm, or of both, at one redshift; b_g > 0. p and f_NL enter as one product and cannot be free together.
    """

    def __init__(self) -> None:
        self.structure = native.BiasLikelihood()
        library.likelihood_init(self.structure)

    def add(self, power: Any, sigma: Any, linear: Any, alpha: Any, spectrum: int = Spectrum.HALO_HALO) -> None:
        """Adds bins that do not correlate: P without shot noise, its standard deviation, P_lin and alpha."""
        arrays = vectors(power=power, sigma=sigma, linear=linear, alpha=alpha)
        library.likelihood_add(self.structure, *arrays, arrays[0].size, spectrum)

    def add_correlated(self, power: Any, linear: Any, alpha: Any, root: Any, halo_halo: int, precision: float = 1.0) -> None:
        """Adds bins that correlate: first those of P_hh, `halo_halo` of them, then those of P_hm.

        root: L of their covariance L L^T, of :func:`covariance_root`. precision: what the inverse is multiplied by, hartlap_factor for a covariance
        that was measured.
        """
        arrays = vectors(power=power, linear=linear, alpha=alpha)
        root = vector(root, "root", shape=(arrays[0].size,) * 2)
        with scratch(library.likelihood_add_correlated_scratch, arrays[0].size) as (memory, size):
            library.likelihood_add_correlated(self.structure, *arrays, root, arrays[0].size, halo_halo, precision, memory, size)

    def merge(self, other: "Likelihood") -> None:
        """Adds the data of another likelihood, independent of these."""
        library.likelihood_merge(self.structure, other.structure)

    @property
    def bins(self) -> int:
        """Values that were added."""
        return self.structure.bins

    def chi_squared(self, bias: native.Structure) -> float:
        """chi^2 of given parameters."""
        chi_squared = ctypes.c_double()
        library.likelihood_chi_squared(chi_squared, self.structure, bias)
        return chi_squared.value

    def fit(self, free: int = Free.B_G | Free.F_NL, start: native.Structure | None = None) -> BiasFit:
        """The best parameters. start: those that are not free, and a place to begin; Bias() if None."""
        found = native.BiasFit()
        library.fit_bias(found, self.structure, start or Bias(), free)
        return _fit(found)

    def posterior(self, free: int = Free.B_G | Free.F_NL, start: native.Structure | None = None, *, points: int = 128,
                  probability: float = 0.68) -> tuple[BiasFit, list[native.Structure]]:
        """The fit, and the posterior of each free parameter in the order b_g, p, f_NL, of flat priors.

        Each has peak (the paper's estimate of f_NL), mean, deviation, low and high of the central region, centre, half_width, edge.
        """
        found = native.BiasFit()
        posteriors = (native.Posterior * bin(free).count("1"))()
        with scratch(library.bias_posterior_scratch, points) as (memory, size):
            library.bias_posterior(found, posteriors, len(posteriors), self.structure, start or Bias(), free, points, probability, memory,
                                   size)
        return _fit(found), list(posteriors)

    def range(self, free: int = Free.B_G | Free.F_NL, start: native.Structure | None = None) -> np.ndarray:
        """(parameters, 2): lowest and highest of each free parameter, beyond which its density is below exp(-12.5) of the peak."""
        ranges = np.empty((bin(free).count("1"), 2))
        library.bias_range(ranges, len(ranges), self.structure, start or Bias(), free)
        return ranges

    def grid(self, ranges: Any, points: Sequence[int], free: int = Free.B_G | Free.F_NL,
             fixed: native.Structure | None = None) -> np.ndarray:
        """chi^2 on a grid of uniform steps, ends included, the second free parameter along the last axis."""
        ranges = vector(ranges, "ranges", shape=(len(points), 2))
        out = np.empty(tuple(points))
        library.bias_grid(out, out.size, self.structure, fixed or Bias(), free, ranges, np.array(points, np.uintp), len(points))
        return out


def marginal(chi_squared: Any, axis: int, low: float, high: float) -> np.ndarray:
    """The posterior density of one parameter of a grid of chi^2, integrated over the other and normalised, on its points."""
    chi_squared = vector(chi_squared, "chi_squared")
    shape = chi_squared.shape if chi_squared.ndim == 2 else (chi_squared.size, 1)
    density = np.empty(shape[axis])
    library.marginal(density, chi_squared, *shape, axis, low, high)
    return density


def read_posterior(density: Any, low: float, high: float, probability: float = 0.68) -> native.Structure:
    """Peak, mean, deviation and central region of a density on a uniform grid from low to high."""
    density, posterior = vector(density, "density"), native.Posterior()
    library.read_posterior(posterior, density, density.size, low, high, probability)
    return posterior


def contours(chi_squared: Any, ranges: Any, level: float) -> np.ndarray:
    """A contour of a grid of two parameters, as segments (x0, y0, x1, y1), x the first parameter. level: a value of chi^2."""
    chi_squared, ranges = vector(chi_squared, "chi_squared"), vector(ranges, "ranges", shape=(2, 2))
    if chi_squared.ndim != 2:
        raise ValueError(f"chi_squared must have two axes, not {chi_squared.ndim}")
    count = ctypes.c_size_t()
    library.contours(None, 0, count, chi_squared, *chi_squared.shape, ranges, level)
    segments = np.empty((count.value, 4))
    library.contours(segments, len(segments), count, chi_squared, *chi_squared.shape, ranges, level)
    return segments


def delta_chi_squared(probability: float, parameters: int) -> float:
    """Delta chi^2 of the region that holds a probability of 1 or 2 Gaussian parameters."""
    delta = ctypes.c_double()
    library.delta_chi_squared(delta, probability, parameters)
    return delta.value


def hartlap_factor(estimates: int, values: int) -> float:
    """(N - p - 2)/(N - 1): what the inverse of a measured covariance must be multiplied by (Hartlap, Simon & Schneider 2007)."""
    factor = ctypes.c_double()
    library.hartlap_factor(factor, estimates, values)
    return factor.value


def percival_factor(estimates: int, values: int, parameters: int) -> float:
    """What the variance of parameters fitted with such an inverse must be multiplied by (Percival et al. 2014, Eq. 18)."""
    factor = ctypes.c_double()
    library.percival_factor(factor, estimates, values, parameters)
    return factor.value
