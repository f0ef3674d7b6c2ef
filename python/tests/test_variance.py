"""Statistics of ensembles, against numpy and against numbers of the paper."""

import numpy as np
import pytest

import fixpair
from fixpair import Bias, Ensemble, Free, Likelihood, Spectrum, Suppression, cosmology, variance

RNG = np.random.default_rng(2204)
SAMPLES = RNG.normal(size=(30, 4)) @ RNG.normal(size=(4, 4)) + 10.0
K = np.linspace(0.01, 0.09, 12)
UNIVERSE, FIT = fixpair.Cosmology(), fixpair.Linear(sigma8=0.8)
LINEAR, ALPHA = cosmology.linear_power(K, UNIVERSE, FIT, 1.0), cosmology.alpha(K, UNIVERSE, FIT, 1.0)


def test_an_ensemble_has_the_moments_of_numpy():
    whole, halves = Ensemble(4, covariance=True), [Ensemble(4, covariance=True) for _ in range(2)]
    whole.add(SAMPLES)
    for sample in SAMPLES[:13]:
        halves[0].add(sample)
    halves[1].add(SAMPLES[13:])
    halves[0].merge(halves[1])
    for ensemble in (whole, halves[0]):
        assert len(ensemble) == 30
        assert ensemble.mean() == pytest.approx(SAMPLES.mean(0), rel=1e-13)
        assert ensemble.deviation() == pytest.approx(SAMPLES.std(0, ddof=1), rel=1e-12)
        assert ensemble.error_of_mean() == pytest.approx(SAMPLES.std(0, ddof=1) / np.sqrt(30), rel=1e-12)
        assert ensemble.covariance() == pytest.approx(np.cov(SAMPLES.T), rel=1e-11)
        assert ensemble.correlation() == pytest.approx(np.corrcoef(SAMPLES.T), rel=1e-11)
    assert whole.covariance(slice(0, 1), slice(1, 4)) == pytest.approx(np.cov(SAMPLES.T)[:1, 1:], rel=1e-11)
    assert Ensemble(4).state.size == 11
    with pytest.raises(ValueError, match="4 values"):
        whole.add([1.0, 2.0])
    with pytest.raises(fixpair.SamplesError):
        Ensemble(4).deviation()


def test_pairs_count_once_and_cost_twice():
    assert variance.pair_average([1.0, 2.0], [3.0, 6.0]).tolist() == [2.0, 4.0]
    sigma, error = variance.sigma_per_simulation([3.0], 19, 2)
    assert sigma == pytest.approx([3 * np.sqrt(2)], rel=1e-15) and error == pytest.approx(sigma / 6, rel=1e-15)


def test_jackknife_and_bootstrap():
    deleted = variance.jackknife_means(SAMPLES)
    assert deleted[3] == pytest.approx(np.delete(SAMPLES, 3, 0).mean(0), rel=1e-13)
    corrected, error = variance.jackknife(SAMPLES.mean(0), deleted)
    # Of a mean the jackknife is the mean itself, with its standard error.
    assert corrected == pytest.approx(SAMPLES.mean(0), rel=1e-12)
    assert error == pytest.approx(SAMPLES.std(0, ddof=1) / np.sqrt(30), rel=1e-10)
    assert variance.jackknife_covariance(deleted) == pytest.approx(np.cov(SAMPLES.T) / 30, rel=1e-9)
    indices = variance.bootstrap_indices(30, 5, 7)
    assert indices.max() < 30 and np.array_equal(indices[:10], variance.bootstrap_indices(30, 5, 7, 10))
    assert variance.resampled_mean(SAMPLES, indices) == pytest.approx(SAMPLES[indices.astype(int)].mean(0), rel=1e-13)


def test_modes_and_their_scatter():
    assert variance.lattice_modes([1, 4, 9, 16, 25]).tolist() == [26, 66, 158, 234]
    assert variance.continuum_modes(0.1, 0.01, 1000.0) == pytest.approx([1e9 * 0.01 * 0.01 / (2 * np.pi**2)], rel=1e-14)
    sigma = variance.sigma_gaussian([10.0], [50.0], 2.0)
    assert sigma == pytest.approx([0.2 * 12], rel=1e-15)
    left = variance.sigma_suppressed(Suppression(0.1, 0.5, 0.9), [0.5], [10.0], [50.0], 2.0)
    assert left == pytest.approx([0.2 * (10 * (0.1 + 0.9 * 0.5) + 1.8)], rel=1e-14)


def test_a_suppression_is_fitted():
    k = np.linspace(0.01, 0.6, 40)
    power, modes, truth = 2e4 / (1 + 50 * k), 1e5 * k**2, Suppression(0.2, 0.15, 0.8)
    sigma = variance.sigma_suppressed(truth, k, power, modes, 300.0)
    for asked in ({"estimates": 41}, {"error": 0.1 * sigma}):
        fit = variance.fit_suppression(sigma, k, power, modes, 300.0, **asked)
        found = fit.value.cosmic_variance, fit.value.softening, fit.value.shot_noise
        # Where the search ends.
        assert found == pytest.approx((0.2, 0.15, 0.8), rel=1e-4) and fit.degrees == 37


def test_ratios_and_differences_of_means():
    ratio, error = variance.ratio_of_means([4.0], [0.4], [2.0], [0.1])
    assert ratio == [2.0] and error == pytest.approx([2 * np.hypot(0.1, 0.05)], rel=1e-14)
    assert variance.ratio_of_means([4.0], [0.4], [2.0], [0.2], [1.0])[1] == pytest.approx([0.0], abs=1e-8)
    difference, error = variance.difference_of_means([4.0], [0.3], [2.0], [0.4], [2.0])
    assert difference == [1.0] and error == pytest.approx([0.25], rel=1e-14)


def test_bias_is_that_of_the_paper():
    bias = Bias(b_g=2.5, f_nl=100.0)
    b = variance.bias_of_k(bias, ALPHA)
    assert b == pytest.approx(2.5 + 2 * 1.686 * 1.5 * 100 / ALPHA, rel=1e-13)
    assert variance.halo_power(bias, LINEAR, ALPHA) == pytest.approx(b**2 * LINEAR, rel=1e-13)
    cross = variance.halo_power(bias, LINEAR, ALPHA, Spectrum.HALO_MATTER)
    found, error = variance.measured_bias(cross, 0.1 * cross, LINEAR, Spectrum.HALO_MATTER)
    assert found == pytest.approx(b, rel=1e-13) and error == pytest.approx(0.1 * b, rel=1e-12)


def halos(bias):
    power = variance.halo_power(bias, LINEAR, ALPHA)
    return power, 0.02 * power


def test_f_nl_is_found():
    truth, likelihood = Bias(b_g=2.5, f_nl=80.0), Likelihood()
    power, sigma = halos(truth)
    likelihood.add(power, sigma, LINEAR, ALPHA)
    assert likelihood.bins == 12 and likelihood.chi_squared(truth) == pytest.approx(0, abs=1e-9)
    fit = likelihood.fit()
    assert (fit.value.b_g, fit.value.f_nl) == pytest.approx((2.5, 80.0), rel=1e-6) and fit.degrees == 10
    assert fit.error[2] == pytest.approx(np.sqrt(fit.covariance[2, 2]), rel=1e-12) and fit.error[1] == 0
    again, (b_g, f_nl) = likelihood.posterior(points=256)
    assert again.value.f_nl == fit.value.f_nl
    assert f_nl.peak == pytest.approx(80, abs=0.1 * fit.error[2]) and f_nl.deviation == pytest.approx(fit.error[2], rel=0.1)
    assert b_g.low < 2.5 < b_g.high
    ranges = likelihood.range()
    grid = likelihood.grid(ranges, (64, 48))
    density = variance.marginal(grid, 1, *ranges[1])
    assert density.size == 48 and density.sum() * (ranges[1, 1] - ranges[1, 0]) / 47 == pytest.approx(1, rel=1e-3)
    assert variance.read_posterior(density, *ranges[1]).peak == pytest.approx(f_nl.peak, abs=fit.error[2] / 10)
    segments = variance.contours(grid, ranges, grid.min() + 2.3)
    assert len(segments) > 10 and (segments[:, 0] > ranges[0, 0]).all() and (segments[:, 1] < ranges[1, 1]).all()


def test_correlated_spectra_weigh_as_their_covariance_says():
    truth, alone, together = Bias(b_g=2.0), Likelihood(), Likelihood()
    power, sigma = halos(truth)
    alone.add(power, sigma, LINEAR, ALPHA)
    together.add_correlated(power, LINEAR, ALPHA, variance.covariance_root(np.diag(sigma**2)), 12)
    other = Bias(b_g=2.1, f_nl=10.0)
    assert together.chi_squared(other) == pytest.approx(alone.chi_squared(other), rel=1e-10)
    alone.merge(together)
    assert alone.chi_squared(other) == pytest.approx(2 * together.chi_squared(other), rel=1e-10)
    assert alone.fit(Free.B_G).value.b_g == pytest.approx(2.0, rel=1e-8)
    with pytest.raises(fixpair.ChoiceError):
        alone.fit(Free.P | Free.F_NL)


def test_matched_differences():
    f0, f100 = SAMPLES[:, 0].copy(), SAMPLES[:, 0] + 0.1 * SAMPLES[:, 1] + 100
    found = variance.matched_difference(f100, f0)
    assert found.mean == pytest.approx((f100 - f0).mean(), rel=1e-13)
    assert found.deviation == pytest.approx((f100 - f0).std(ddof=1), rel=1e-10)
    assert found.correlation == pytest.approx(np.corrcoef(f100, f0)[0, 1], rel=1e-12)
    sigma = variance.difference_sigma(found.deviation_first, found.deviation_second, found.correlation)
    assert sigma == pytest.approx(found.deviation, rel=1e-8)
    assert variance.effective_volume(4.0, 1.0, simulations=2) == 8.0
    # p = b - (b - 1) f/f_true.
    assert variance.universality(3.0, 0.1, 50.0, 5.0, 100.0)[0] == 2.0


def test_control_variates():
    y, c = SAMPLES + 0.1, SAMPLES + 0.3 * RNG.normal(size=SAMPLES.shape)
    mu = np.full(4, 10.0)
    plain = variance.control_variates(y, c, mu, beta=1.0)
    assert plain["mean"] == pytest.approx(y.mean(0) - (c.mean(0) - mu), rel=1e-12)
    best = variance.control_variates(y, c, mu)
    covariance = [np.cov(y[:, i], c[:, i]) for i in range(4)]
    assert best["beta"] == pytest.approx([each[0, 1] / each[1, 1] for each in covariance], rel=1e-11)
    assert (best["gain"] > 1).all() and (variance.control_variates(y, c, mu, error=np.full(4, 0.1))["error"] > best["error"]).all()
    assert variance.control_variate_gain(2.0, 1.0, 0.9, 1.8) == pytest.approx(1 / (1 - 0.81), rel=1e-12)
    assert variance.control_variate_loss(12) == pytest.approx(10 / 9, rel=1e-15)
    pool = variance.carpool(y, c, mu)
    cross = np.cov(y.T, c.T)
    beta = cross[:4, 4:] @ np.linalg.inv(cross[4:, 4:])
    assert pool.beta == pytest.approx(beta, rel=1e-8, abs=1e-10)
    assert pool.mean == pytest.approx(y.mean(0) - beta @ (c.mean(0) - mu), rel=1e-10) and pool.covariance.shape == (4, 4)


def test_factors_of_measured_covariances():
    assert variance.hartlap_factor(41, 10) == pytest.approx(29 / 40, rel=1e-15)
    assert variance.percival_factor(100, 10, 2) > 1
    assert variance.delta_chi_squared(0.6826894921, 1) == pytest.approx(1, rel=1e-8)
    covariance = np.cov(SAMPLES.T)
    root = variance.covariance_root(covariance)
    assert root @ root.T == pytest.approx(covariance, rel=1e-12) and not np.triu(root, 1).any()
