"""Ensembles, scatter, bias and f_NL, matched simulations, matrices: the cases of Rust, and the numbers of a paper."""

import ctypes

import fixpair_ctypes as fixpair
from ctypes_check import SEED, Buffer, array, check, doubles, integers, made, noise
from ctypes_estimate import filled, scratch_of, sizes
from fixpair_ctypes import (Bias, BiasFit, ControlVariate, Difference, Layout, Likelihood, Posterior, Suppression,
                            SuppressionFit)

VALUES, SAMPLES, FIRST, BINS, HALO_HALO, CONTROLS, SIDE, DOWN, ACROSS, WIDE = 5, 12, 7, 14, 9, 3, 40, 20, 30, 64
SHOT_NOISE = 250.0
TRUTH, START = (2.32, 1.0, 100.0, 1.686), (2.2, 1.0, 80.0, 1.686)
c_uint64, c_double, size_t = ctypes.c_uint64, ctypes.c_double, ctypes.c_size_t


def empty(count):
    return Buffer(c_double, count)


def matrix(count, of):
    return array([of(i, j) for i in range(count) for j in range(count)])


class Statistics:
    """All cases through one library."""

    def __init__(self, universe):
        self.library, self.case = universe.library, universe.case
        rows = range(SAMPLES * VALUES)
        self.y = array([100.0 + 10.0 * float(i % VALUES) + 3.0 * noise(i) + 2.0 * noise(i + 7000) for i in rows])
        self.c = array([90.0 + 5.0 * float(i % VALUES) + 2.0 * noise(i) + 0.5 * noise(i + 9000) for i in rows])
        self.spectra()

    def run(self):
        sizes_of = [ctypes.sizeof(kind) for kind in (Suppression, SuppressionFit, Bias, Likelihood, BiasFit, Posterior,
                                                     Difference, ControlVariate)]
        check(sizes_of == [24, 136, 32, 296, 144, 64, 72, 48], "structs of statistics have their size")
        mean = self.ensembles()
        self.resampling(mean)
        self.scatters()
        likelihood = self.biases()
        self.posteriors(likelihood)
        self.matched()
        self.matrices()

    def ensembles(self):
        library, size = self.library, ctypes.sizeof(c_double)
        lengths = [made(size_t, library.ensemble_length, n, of).value
                   for of in (fixpair.VARIANCE, fixpair.COVARIANCE) for n in range(1, 11)]
        self.case("ensemble_length", integers(*lengths))
        pieces = []
        for of in (fixpair.VARIANCE, fixpair.COVARIANCE):
            length = made(size_t, library.ensemble_length, VALUES, of).value
            state, other = empty(length), empty(length)
            for one in (state, other):
                library.ensemble_init(one.start, length, VALUES, of)
            library.ensemble_add(state.start, length, self.y.start, FIRST * VALUES)
            for i in range(FIRST, SAMPLES):
                library.ensemble_add(other.start, length, self.y.at(i * VALUES), VALUES)
            pieces += [bytes(state), bytes(other)]
            library.ensemble_merge(state.start, length, other.start)
            pieces.append(bytes(state))
        self.case("ensemble_state", *pieces)
        moments = [empty(VALUES) for _ in range(3)]
        library.ensemble_mean(moments[0].start, VALUES, state.start, length)
        library.ensemble_deviation(moments[1].start, VALUES, state.start, length)
        library.ensemble_error_of_mean(moments[2].start, VALUES, state.start, length)
        self.case("ensemble_moments", made(c_uint64, library.ensemble_count, state.start, length), *moments)
        for name in ("covariance", "correlation"):
            whole, cross = empty(VALUES * VALUES), empty(6)
            function = getattr(library, "ensemble_" + name)
            function(whole.start, VALUES, VALUES, state.start, length, 0, 0)
            function(cross.start, 2, 3, state.start, length, 0, 2)
            self.case("ensemble_" + name, whole, cross)
        average, sigma, error = empty(SAMPLES * VALUES), empty(VALUES), empty(VALUES)
        library.pair_average(average.start, self.y.start, self.c.start, SAMPLES * VALUES)
        self.case("pair_average", average)
        library.sigma_per_simulation(sigma.start, error.start, moments[1].start, VALUES, SAMPLES, 2)
        self.case("sigma_per_simulation", sigma, error)
        return moments[0]

    def resampling(self, mean):
        library, indices = self.library, Buffer(c_uint64, SAMPLES)
        of_draws, corrected, error = (empty(VALUES) for _ in range(3))
        deleted, covariance = empty(SAMPLES * VALUES), empty(VALUES * VALUES)
        library.bootstrap_indices(indices.start, SAMPLES, SAMPLES, SEED, 2**40 + 3)
        self.case("bootstrap_indices", indices)
        library.resampled_mean(of_draws.start, VALUES, self.y.start, SAMPLES, indices.start, SAMPLES)
        self.case("resampled_mean", of_draws)
        library.jackknife_means(deleted.start, self.y.start, SAMPLES, VALUES)
        self.case("jackknife_means", deleted)
        library.jackknife(corrected.start, error.start, mean.start, VALUES, deleted.start, SAMPLES)
        self.case("jackknife", corrected, error)
        library.jackknife_covariance(covariance.start, deleted.start, SAMPLES, VALUES)
        self.case("jackknife_covariance", covariance)

    def spectra(self):
        """Spectra of halos (0) and of halos with matter (1), bin by bin, and what they are made of."""
        x = [float(b + 1) for b in range(BINS)]
        self.k = array([0.005 * x for x in x])
        self.linear = array([20000.0 / (1.0 + 0.5 * x) for x in x])
        self.alpha = array([500.0 * x * x / (1.0 + 0.1 * x) for x in x])
        self.modes = array([26.0 * x * x for x in x])
        self.power, self.sigma = [], []
        for which in range(2):
            power = self.halo_power(which)
            power.array[:] = [p * (1.0 + 0.02 * noise(b + 300)) for b, p in enumerate(power.array)]
            self.power.append(power)
            self.sigma.append(array([0.05 * p / float(b + 1) for b, p in enumerate(power.array)]))

    def halo_power(self, which):
        power = empty(BINS)
        self.library.halo_power(power.start, Bias(*TRUTH), self.linear.start, self.alpha.start, BINS, which)
        return power

    def scatters(self):
        library, k, modes, power = self.library, self.k, self.modes, self.power[0]
        out, error, counts = empty(BINS), empty(BINS), Buffer(c_uint64, 5)
        library.continuum_modes(out.start, k.start, BINS, 0.005, 1000.0)
        self.case("continuum_modes", out)
        library.lattice_modes(counts.start, filled(c_uint64, [0, 1, 4, 9, 16, 1000]).start, 6)
        self.case("lattice_modes", counts)
        library.sigma_gaussian(out.start, power.start, modes.start, BINS, SHOT_NOISE)
        self.case("sigma_gaussian", out)
        library.sigma_suppressed(out.start, Suppression(0.25, 0.04, 0.9), k.start, power.start, modes.start, BINS, SHOT_NOISE)
        self.case("sigma_suppressed", out)
        sigma = array([s * (1.0 + 0.05 * noise(b + 500)) for b, s in enumerate(out.array)])
        errors = array([0.1 * s for s in sigma.array])
        rho = array([0.5 * noise(b + 600) for b in range(BINS)])
        fits = [made(SuppressionFit, library.fit_suppression, sigma.start, given, k.start, power.start, modes.start, BINS,
                     SHOT_NOISE, estimates) for given, estimates in ((errors.start, 0), (None, 41))]
        self.case("fit_suppression", *fits)
        means = [self.power[0].start, self.sigma[0].start, self.power[1].start, self.sigma[1].start]
        ratios, differences = [], []
        for given in (None, rho.start):
            library.ratio_of_means(out.start, error.start, *means, given, BINS)
            ratios += [bytes(out), bytes(error)]
            library.difference_of_means(out.start, error.start, *means, given, sigma.start, BINS)
            differences += [bytes(out), bytes(error)]
        self.case("ratio_of_means", *ratios)
        self.case("difference_of_means", *differences)

    def biases(self):
        library, truth, linear, alpha = self.library, Bias(*TRUTH), self.linear, self.alpha
        self.case("bias_init", made(Bias, library.bias_init))
        out, error = empty(BINS), empty(BINS)
        library.bias_of_k(out.start, truth, alpha.start, BINS)
        self.case("bias_of_k", out)
        self.case("halo_power", *(self.halo_power(which) for which in range(2)))
        measured, likelihoods = [], []
        for which, (power, sigma) in enumerate(zip(self.power, self.sigma)):
            library.measured_bias(out.start, error.start, power.start, sigma.start, linear.start, BINS, which)
            measured += [bytes(out), bytes(error)]
            likelihoods.append(made(Likelihood, library.likelihood_init))
            library.likelihood_add(likelihoods[which], power.start, sigma.start, linear.start, alpha.start, BINS, which)
        self.case("measured_bias", *measured)
        self.case("likelihood_add", *likelihoods)
        mixed = array([self.power[b >= HALO_HALO].array[b] for b in range(BINS)])
        sigma = self.sigma[0].array
        root = matrix(BINS, lambda i, j: sigma[i] if i == j else 0.1 * sigma[i] * noise(17 * i + j) if j < i else 0.0)
        layout = made(Layout, library.likelihood_add_correlated_scratch, BINS)
        scratch, correlated = scratch_of(layout), made(Likelihood, library.likelihood_init)
        library.likelihood_add_correlated(correlated, mixed.start, linear.start, alpha.start, root.start, BINS, HALO_HALO,
                                          0.75, scratch.start, scratch.size)
        self.case("likelihood_add_correlated", sizes(layout), correlated)
        likelihood = likelihoods[0]
        for other in (likelihoods[1], correlated):
            library.likelihood_merge(likelihood, other)
        self.case("likelihood_merge", likelihood)
        self.case("likelihood_chi_squared", made(c_double, library.likelihood_chi_squared, likelihood, truth))
        return likelihood

    def posteriors(self, likelihood):
        library, start, both = self.library, Bias(*START), fixpair.FREE_B_G | fixpair.FREE_F_NL
        layout = made(Layout, library.bias_posterior_scratch, WIDE)
        scratch, fits, read = scratch_of(layout), [], [sizes(layout)]
        for free in (fixpair.FREE_B_G, fixpair.FREE_P, fixpair.FREE_F_NL, fixpair.FREE_B_G | fixpair.FREE_P, both):
            fits.append(made(BiasFit, library.fit_bias, likelihood, start, free))
            fit, posterior = BiasFit(), (Posterior * bin(free).count("1"))()
            library.bias_posterior(fit, posterior, len(posterior), likelihood, start, free, WIDE, 0.68, scratch.start,
                                   scratch.size)
            read += [fit, posterior]
        self.case("fit_bias", *fits)
        self.case("bias_posterior", *read)
        ranges, grid, points = empty(4), empty(DOWN * ACROSS), filled(size_t, [DOWN, ACROSS])
        library.bias_range(ranges.start, 2, likelihood, start, both)
        self.case("bias_range", ranges)
        library.bias_grid(grid.start, DOWN * ACROSS, likelihood, start, both, ranges.start, points.start, 2)
        self.case("bias_grid", grid)
        densities, read = [], []
        for axis, count in enumerate((DOWN, ACROSS)):
            density, ends = empty(count), ranges.array[2 * axis:2 * axis + 2]
            library.marginal(density.start, grid.start, DOWN, ACROSS, axis, *ends)
            densities.append(density)
            read.append(made(Posterior, library.read_posterior, density.start, count, *ends, 0.95))
        self.case("marginal", *densities)
        self.case("read_posterior", *read)
        levels = [made(c_double, library.delta_chi_squared, probability, of) for of in (1, 2) for probability in (0.68, 0.95)]
        self.case("delta_chi_squared", *levels)
        level, count = min(grid.array) + levels[2].value, size_t()
        library.contours(None, 0, count, grid.start, DOWN, ACROSS, ranges.start, level)
        segments = empty(4 * count.value)
        library.contours(segments.start, count.value, count, grid.start, DOWN, ACROSS, ranges.start, level)
        self.case("contours", integers(count.value), segments)
        self.case("factors", made(c_double, library.hartlap_factor, 41, 14), made(c_double, library.percival_factor, 41, 14, 2))

    def matched(self):
        library = self.library
        self.case("matched_difference", made(Difference, library.matched_difference, self.y.start, self.c.start, SAMPLES))
        p, error = c_double(), c_double()
        library.universality(p, error, 2.32, 0.01, 109.2, 8.3, -0.05, 100.0)
        self.case("matched_numbers", made(c_double, library.difference_sigma, 12.1, 11.8, 0.76),
                  made(c_double, library.effective_volume, 60.5, 1, 12.1, 2), p, error,
                  made(c_double, library.control_variate_gain, 12.1, 11.8, 0.76, 0.5),
                  made(c_double, library.control_variate_loss, 12, 3))
        layout = made(Layout, library.control_variates_scratch, SAMPLES)
        scratch, values, pieces = scratch_of(layout), Buffer(ControlVariate, VALUES), [sizes(layout)]
        mu, errors = array([90.0 + 5.0 * float(i) for i in range(VALUES)]), array([0.125] * VALUES)
        for given, choice in ((None, fixpair.BETA_GIVEN), (None, fixpair.BETA_OPTIMAL), (errors.start, fixpair.BETA_OPTIMAL)):
            library.control_variates(values.start, VALUES, self.y.start, self.c.start, SAMPLES, mu.start, given, choice, 1.0,
                                     scratch.start, scratch.size)
            pieces.append(bytes(values))
        self.case("control_variates", *pieces)

    def matrices(self):
        library = self.library
        covariance = matrix(SIDE, lambda i, j: (1.5 if i == j else 1.0 / (1.0 + float(abs(i - j)))) * float((i + 1) * (j + 1)))
        layout, root = made(Layout, library.covariance_root_scratch, SIDE), empty(SIDE * SIDE)
        scratch = scratch_of(layout)
        library.covariance_root(root.start, covariance.start, SIDE, scratch.start, scratch.size)
        self.case("covariance_root", sizes(layout), root)
        controls = array([self.c.array[i * VALUES + j] for i in range(SAMPLES) for j in range(CONTROLS)])
        mu, of_mu = array([90.0 + 5.0 * float(i) for i in range(CONTROLS)]), matrix(CONTROLS, lambda i, j: (i == j) / 64)
        layout, pieces = made(Layout, library.carpool_scratch, VALUES, CONTROLS), []
        scratch, mean, spread, beta = scratch_of(layout), empty(VALUES), empty(VALUES * VALUES), empty(VALUES * CONTROLS)
        for given in (None, of_mu.start):
            library.carpool(mean.start, spread.start, beta.start, self.y.start, controls.start, SAMPLES, VALUES, mu.start,
                            given, CONTROLS, scratch.start, scratch.size)
            pieces += [bytes(mean), bytes(spread), bytes(beta)]
        self.case("carpool", sizes(layout), *pieces)


def known_answers(universe):
    """What Avila & Adame print, and a universe of their halos without noise, whose parameters come back."""
    library, of, free = universe.library, Statistics(universe), fixpair.FREE_B_G | fixpair.FREE_F_NL
    sigma = made(c_double, library.difference_sigma, 12.1, 11.8, 0.76).value
    check(round(sigma, 1) == 8.3, "matched simulations scatter by 8.3")
    volume = made(c_double, library.effective_volume, 60.5, 1, 7.3, 1).value
    check(round(volume) == 69, "a matched pair is worth 69 simulations")
    p, error = c_double(), c_double()
    library.universality(p, error, 2.32, 0.0, 109.2, 5.2, 0.0, 100.0)
    check(round(p.value, 4) == 0.8786 and abs(error.value - 1.32 * 0.052) < 1e-12, "p is 0.8786 +- 0.0686")
    likelihood, power = made(Likelihood, library.likelihood_init), of.halo_power(fixpair.HALO_HALO)
    library.likelihood_add(likelihood, power.start, of.sigma[0].start, of.linear.start, of.alpha.start, BINS, fixpair.HALO_HALO)
    fit, posterior, scratch = BiasFit(), (Posterior * 2)(), scratch_of(made(Layout, library.bias_posterior_scratch, 128))
    library.bias_posterior(fit, posterior, 2, likelihood, made(Bias, library.bias_init), free, 128, 0.68, scratch.start,
                           scratch.size)
    check(abs(fit.value.b_g - 2.32) < 1e-9 and abs(fit.value.f_nl - 100.0) < 1e-6, "b_g and f_NL come back")
    check(fit.chi_squared < 1e-12 and fit.degrees == BINS - 2 and fit.value.p == 1.0, "the fit is perfect")
    check(abs(posterior[1].deviation / fit.error[2] - 1) < 0.1, "the posterior is as wide as the curvature says")
    check(abs(posterior[0].half_width / posterior[0].deviation - 0.9945) < 0.02, "0.68 lie within a deviation")
    # Matched halves: their difference scatters less by sqrt(2 (1 - rho)).
    matched = made(Difference, library.matched_difference, of.y.start, of.c.start, SAMPLES)
    of_both = made(c_double, library.difference_sigma, matched.deviation_first, matched.deviation_second, matched.correlation)
    check(abs(matched.deviation / of_both.value - 1) < 1e-12, "the scatter of differences is Eq. correlation")
