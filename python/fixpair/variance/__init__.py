"""What fixing, pairing and matching gain: ensembles, models of scatter, bias and f_NL, matched differences, control variates."""

from .bias import (
    Bias, BiasFit, Likelihood, bias_of_k, contours, delta_chi_squared, halo_power, hartlap_factor, marginal, measured_bias,
    percival_factor, read_posterior,
)
from .covariance import Carpool, carpool, covariance_root
from .ensemble import (
    Ensemble, bootstrap_indices, jackknife, jackknife_covariance, jackknife_means, pair_average, resampled_mean,
    sigma_per_simulation,
)
from .matched import (
    CONTROL_VARIATE, control_variate_gain, control_variate_loss, control_variates, difference_sigma, effective_volume,
    matched_difference, universality,
)
from .models import (
    Suppression, continuum_modes, difference_of_means, fit_suppression, lattice_modes, ratio_of_means, sigma_gaussian,
    sigma_suppressed,
)

__all__ = [
    "Bias", "BiasFit", "CONTROL_VARIATE", "Carpool", "Ensemble", "Likelihood", "Suppression", "bias_of_k", "bootstrap_indices",
    "carpool", "continuum_modes", "contours", "control_variate_gain", "control_variate_loss", "control_variates",
    "covariance_root", "delta_chi_squared", "difference_of_means", "difference_sigma", "effective_volume", "fit_suppression",
    "halo_power", "hartlap_factor", "jackknife", "jackknife_covariance", "jackknife_means", "lattice_modes", "marginal",
    "matched_difference", "measured_bias", "pair_average", "percival_factor", "ratio_of_means", "read_posterior",
    "resampled_mean", "sigma_gaussian", "sigma_per_simulation", "sigma_suppressed", "universality",
]
