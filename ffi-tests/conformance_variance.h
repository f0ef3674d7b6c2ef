/*
 * The part of conformance.c about statistics: ensembles, scatter, bias and f_NL, matched simulations, matrices. For host.cpp too.
 */

enum { VALUES = 5, SAMPLES = 12, FIRST = 7, BINS = 14, HALO_HALO = 9, CONTROLS = 3, SIDE = 40, DOWN = 20, ACROSS = 30, WIDE = 64 };
#define SHOT_NOISE 250.0

static double wanted[SAMPLES * VALUES], cheap[SAMPLES * VALUES];
static const fixpair_bias truth = {2.32, 1.0, 100.0, 1.686}, beginning = {2.2, 1.0, 80.0, 1.686};

static uint64_t hash_doubles(uint64_t hash, const double *values, size_t count) {
    return hash_bytes(hash, values, count * sizeof *values);
}

/* Rows of what is wanted and of what correlates with it. */
static void make_samples(void) {
    size_t i;
    for (i = 0; i < SAMPLES * VALUES; i++) {
        wanted[i] = 100.0 + 10.0 * (double)(i % VALUES) + 3.0 * noise(i) + 2.0 * noise(i + 7000);
        cheap[i] = 90.0 + 5.0 * (double)(i % VALUES) + 2.0 * noise(i) + 0.5 * noise(i + 9000);
    }
}

static void ensembles(double *mean) {
    uint64_t lengths[20], count, hash = HASH_START;
    double moments[3 * VALUES], whole[VALUES * VALUES], cross[6], sigma[2 * VALUES], average[SAMPLES * VALUES];
    double *state = NULL, *other;
    size_t length = 0, i;
    int32_t of;
    for (of = FIXPAIR_MOMENTS_VARIANCE; of <= FIXPAIR_MOMENTS_COVARIANCE; of++) {
        for (i = 1; i <= 10; i++) {
            MUST(fixpair_ensemble_length(&length, i, of));
            lengths[10 * (size_t)of + i - 1] = length;
        }
    }
    check_case("ensemble_length", hash_bytes(HASH_START, lengths, sizeof lengths));
    for (of = FIXPAIR_MOMENTS_VARIANCE; of <= FIXPAIR_MOMENTS_COVARIANCE; of++) {
        MUST(fixpair_ensemble_length(&length, VALUES, of));
        if (state != NULL) {
            give_back(state);
        }
        state = (double *)take(length * sizeof *state);
        other = (double *)take(length * sizeof *other);
        MUST(fixpair_ensemble_init(state, length, VALUES, of));
        MUST(fixpair_ensemble_init(other, length, VALUES, of));
        /* All at once, and one by one. */
        MUST(fixpair_ensemble_add(state, length, wanted, FIRST * VALUES));
        for (i = FIRST; i < SAMPLES; i++) {
            MUST(fixpair_ensemble_add(other, length, wanted + i * VALUES, VALUES));
        }
        hash = hash_doubles(hash_doubles(hash, state, length), other, length);
        MUST(fixpair_ensemble_merge(state, length, other));
        hash = hash_doubles(hash, state, length);
        give_back(other);
    }
    check_case("ensemble_state", hash);
    MUST(fixpair_ensemble_mean(moments, VALUES, state, length));
    MUST(fixpair_ensemble_deviation(moments + VALUES, VALUES, state, length));
    MUST(fixpair_ensemble_error_of_mean(moments + 2 * VALUES, VALUES, state, length));
    MUST(fixpair_ensemble_count(&count, state, length));
    check_case("ensemble_moments", hash_doubles(hash_bytes(HASH_START, &count, sizeof count), moments, 3 * VALUES));
    MUST(fixpair_ensemble_covariance(whole, VALUES, VALUES, state, length, 0, 0));
    MUST(fixpair_ensemble_covariance(cross, 2, 3, state, length, 0, 2));
    check_case("ensemble_covariance", hash_doubles(hash_doubles(HASH_START, whole, VALUES * VALUES), cross, 6));
    MUST(fixpair_ensemble_correlation(whole, VALUES, VALUES, state, length, 0, 0));
    MUST(fixpair_ensemble_correlation(cross, 2, 3, state, length, 0, 2));
    check_case("ensemble_correlation", hash_doubles(hash_doubles(HASH_START, whole, VALUES * VALUES), cross, 6));
    MUST(fixpair_pair_average(average, wanted, cheap, SAMPLES * VALUES));
    check_case("pair_average", hash_doubles(HASH_START, average, SAMPLES * VALUES));
    MUST(fixpair_sigma_per_simulation(sigma, sigma + VALUES, moments + VALUES, VALUES, SAMPLES, 2));
    check_case("sigma_per_simulation", hash_doubles(HASH_START, sigma, 2 * VALUES));
    memcpy(mean, moments, VALUES * sizeof *mean);
    give_back(state);
}

static void resampling(const double *mean) {
    uint64_t indices[SAMPLES];
    double of_draws[VALUES], deleted[SAMPLES * VALUES], corrected[2 * VALUES], covariance[VALUES * VALUES];
    MUST(fixpair_bootstrap_indices(indices, SAMPLES, SAMPLES, SEED, (UINT64_C(1) << 40) + 3));
    check_case("bootstrap_indices", hash_bytes(HASH_START, indices, sizeof indices));
    MUST(fixpair_resampled_mean(of_draws, VALUES, wanted, SAMPLES, indices, SAMPLES));
    check_case("resampled_mean", hash_doubles(HASH_START, of_draws, VALUES));
    MUST(fixpair_jackknife_means(deleted, wanted, SAMPLES, VALUES));
    check_case("jackknife_means", hash_doubles(HASH_START, deleted, SAMPLES * VALUES));
    MUST(fixpair_jackknife(corrected, corrected + VALUES, mean, VALUES, deleted, SAMPLES));
    check_case("jackknife", hash_doubles(HASH_START, corrected, 2 * VALUES));
    MUST(fixpair_jackknife_covariance(covariance, deleted, SAMPLES, VALUES));
    check_case("jackknife_covariance", hash_doubles(HASH_START, covariance, VALUES * VALUES));
}

/* Spectra of halos (0) and of halos with matter (1), bin by bin, and what they are made of. */
typedef struct {
    double k[BINS], linear[BINS], alpha[BINS], modes[BINS], power[2][BINS], sigma[2][BINS];
} spectra_of_halos;

static void make_spectra(spectra_of_halos *of) {
    int b, which;
    for (b = 0; b < BINS; b++) {
        double x = (double)(b + 1);
        of->k[b] = 0.005 * x;
        of->linear[b] = 20000.0 / (1.0 + 0.5 * x);
        of->alpha[b] = 500.0 * x * x / (1.0 + 0.1 * x);
        of->modes[b] = 26.0 * x * x;
    }
    for (which = 0; which < 2; which++) {
        MUST(fixpair_halo_power(of->power[which], &truth, of->linear, of->alpha, BINS, which));
        for (b = 0; b < BINS; b++) {
            of->power[which][b] = of->power[which][b] * (1.0 + 0.02 * noise((size_t)b + 300));
            of->sigma[which][b] = 0.05 * of->power[which][b] / (double)(b + 1);
        }
    }
}

static void scatters(const spectra_of_halos *of) {
    static const uint64_t edges[6] = {0, 1, 4, 9, 16, 1000};
    const fixpair_suppression left = {0.25, 0.04, 0.9};
    const double *power = of->power[0];
    fixpair_suppression_fit fits[2];
    uint64_t counts[5], ratios = HASH_START, differences = HASH_START;
    double out[2 * BINS], sigma[BINS], errors[BINS], rho[BINS];
    int b, with;
    MUST(fixpair_continuum_modes(out, of->k, BINS, 0.005, 1000.0));
    check_case("continuum_modes", hash_doubles(HASH_START, out, BINS));
    MUST(fixpair_lattice_modes(counts, edges, 6));
    check_case("lattice_modes", hash_bytes(HASH_START, counts, sizeof counts));
    MUST(fixpair_sigma_gaussian(out, power, of->modes, BINS, SHOT_NOISE));
    check_case("sigma_gaussian", hash_doubles(HASH_START, out, BINS));
    MUST(fixpair_sigma_suppressed(out, &left, of->k, power, of->modes, BINS, SHOT_NOISE));
    check_case("sigma_suppressed", hash_doubles(HASH_START, out, BINS));
    for (b = 0; b < BINS; b++) {
        sigma[b] = out[b] * (1.0 + 0.05 * noise((size_t)b + 500));
        errors[b] = 0.1 * sigma[b];
        rho[b] = 0.5 * noise((size_t)b + 600);
    }
    MUST(fixpair_fit_suppression(&fits[0], sigma, errors, of->k, power, of->modes, BINS, SHOT_NOISE, 0));
    MUST(fixpair_fit_suppression(&fits[1], sigma, NULL, of->k, power, of->modes, BINS, SHOT_NOISE, 41));
    check_case("fit_suppression", hash_bytes(HASH_START, fits, sizeof fits));
    for (with = 0; with < 2; with++) {
        MUST(fixpair_ratio_of_means(out, out + BINS, power, of->sigma[0], of->power[1], of->sigma[1], with ? rho : NULL, BINS));
        ratios = hash_doubles(ratios, out, 2 * BINS);
        MUST(fixpair_difference_of_means(out, out + BINS, power, of->sigma[0], of->power[1], of->sigma[1], with ? rho : NULL,
                                         sigma, BINS));
        differences = hash_doubles(differences, out, 2 * BINS);
    }
    check_case("ratio_of_means", ratios);
    check_case("difference_of_means", differences);
}

static void biases(const spectra_of_halos *of, fixpair_bias_likelihood *likelihood) {
    fixpair_bias_likelihood of_both[2], correlated;
    fixpair_bias none;
    fixpair_layout layout;
    double out[2 * BINS], mixed[BINS], root[BINS * BINS], chi_squared;
    uint64_t power = HASH_START, measured = HASH_START;
    void *scratch;
    int which, i, j;
    MUST(fixpair_bias_init(&none));
    check_case("bias_init", hash_bytes(HASH_START, &none, sizeof none));
    MUST(fixpair_bias_of_k(out, &truth, of->alpha, BINS));
    check_case("bias_of_k", hash_doubles(HASH_START, out, BINS));
    for (which = FIXPAIR_SPECTRUM_HALO_HALO; which <= FIXPAIR_SPECTRUM_HALO_MATTER; which++) {
        MUST(fixpair_halo_power(out, &truth, of->linear, of->alpha, BINS, which));
        power = hash_doubles(power, out, BINS);
        MUST(fixpair_measured_bias(out, out + BINS, of->power[which], of->sigma[which], of->linear, BINS, which));
        measured = hash_doubles(measured, out, 2 * BINS);
        MUST(fixpair_likelihood_init(&of_both[which]));
        MUST(fixpair_likelihood_add(&of_both[which], of->power[which], of->sigma[which], of->linear, of->alpha, BINS, which));
    }
    check_case("halo_power", power);
    check_case("measured_bias", measured);
    check_case("likelihood_add", hash_bytes(HASH_START, of_both, sizeof of_both));
    for (i = 0; i < BINS; i++) {
        mixed[i] = of->power[i >= HALO_HALO][i];
        for (j = 0; j < BINS; j++) {
            double below = j < i ? 0.1 * of->sigma[0][i] * noise((size_t)(17 * i + j)) : 0.0;
            root[i * BINS + j] = i == j ? of->sigma[0][i] : below;
        }
    }
    MUST(fixpair_likelihood_add_correlated_scratch(&layout, BINS));
    scratch = take_scratch(layout.size);
    MUST(fixpair_likelihood_init(&correlated));
    MUST(fixpair_likelihood_add_correlated(&correlated, mixed, of->linear, of->alpha, root, BINS, HALO_HALO, 0.75, scratch,
                                           layout.size));
    check_case("likelihood_add_correlated",
               hash_bytes(hash_layout(HASH_START, layout), &correlated, sizeof correlated));
    *likelihood = of_both[0];
    MUST(fixpair_likelihood_merge(likelihood, &of_both[1]));
    MUST(fixpair_likelihood_merge(likelihood, &correlated));
    check_case("likelihood_merge", hash_bytes(HASH_START, likelihood, sizeof *likelihood));
    MUST(fixpair_likelihood_chi_squared(&chi_squared, likelihood, &truth));
    check_case("likelihood_chi_squared", hash_doubles(HASH_START, &chi_squared, 1));
    give_back(scratch);
}

static void posteriors_of(const fixpair_bias_likelihood *likelihood) {
    static const uint32_t sets[5] = {FIXPAIR_FREE_B_G, FIXPAIR_FREE_P, FIXPAIR_FREE_F_NL, FIXPAIR_FREE_B_G | FIXPAIR_FREE_P,
                                     FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL};
    static const double probabilities[2] = {0.68, 0.95};
    const uint32_t both = FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL;
    const size_t points[2] = {DOWN, ACROSS};
    fixpair_bias_fit fit;
    fixpair_posterior posterior[2];
    fixpair_layout layout;
    uint64_t fits = HASH_START, read, hash = HASH_START, found;
    double ranges[4], grid[DOWN * ACROSS], density[ACROSS], levels[4], factors[2], least, *segments;
    void *scratch;
    size_t i, count = 0;
    int axis;
    MUST(fixpair_bias_posterior_scratch(&layout, WIDE));
    scratch = take_scratch(layout.size);
    read = hash_layout(HASH_START, layout);
    for (i = 0; i < 5; i++) {
        size_t parameters = i < 3 ? 1 : 2;
        MUST(fixpair_fit_bias(&fit, likelihood, &beginning, sets[i]));
        fits = hash_bytes(fits, &fit, sizeof fit);
        MUST(fixpair_bias_posterior(&fit, posterior, parameters, likelihood, &beginning, sets[i], WIDE, 0.68, scratch,
                                    layout.size));
        read = hash_bytes(hash_bytes(read, &fit, sizeof fit), posterior, parameters * sizeof *posterior);
    }
    check_case("fit_bias", fits);
    check_case("bias_posterior", read);
    MUST(fixpair_bias_range(ranges, 2, likelihood, &beginning, both));
    check_case("bias_range", hash_doubles(HASH_START, ranges, 4));
    MUST(fixpair_bias_grid(grid, DOWN * ACROSS, likelihood, &beginning, both, ranges, points, 2));
    check_case("bias_grid", hash_doubles(HASH_START, grid, DOWN * ACROSS));
    for (axis = 0; axis < 2; axis++) {
        const double *range = ranges + 2 * axis;
        MUST(fixpair_marginal(density, grid, DOWN, ACROSS, axis, range[0], range[1]));
        hash = hash_doubles(hash, density, points[axis]);
        MUST(fixpair_read_posterior(&posterior[axis], density, points[axis], range[0], range[1], 0.95));
    }
    check_case("marginal", hash);
    check_case("read_posterior", hash_bytes(HASH_START, posterior, sizeof posterior));
    for (i = 0; i < 4; i++) {
        MUST(fixpair_delta_chi_squared(&levels[i], probabilities[i % 2], i < 2 ? 1 : 2));
    }
    check_case("delta_chi_squared", hash_doubles(HASH_START, levels, 4));
    least = grid[0];
    for (i = 1; i < DOWN * ACROSS; i++) {
        least = grid[i] < least ? grid[i] : least;
    }
    MUST(fixpair_contours(NULL, 0, &count, grid, DOWN, ACROSS, ranges, least + levels[2]));
    segments = (double *)take(4 * count * sizeof *segments);
    MUST(fixpair_contours(segments, count, &count, grid, DOWN, ACROSS, ranges, least + levels[2]));
    found = count;
    check_case("contours", hash_doubles(hash_bytes(HASH_START, &found, sizeof found), segments, 4 * count));
    MUST(fixpair_hartlap_factor(&factors[0], 41, 14));
    MUST(fixpair_percival_factor(&factors[1], 41, 14, 2));
    check_case("factors", hash_doubles(HASH_START, factors, 2));
    give_back(scratch);
    give_back(segments);
}

static void matched(void) {
    fixpair_difference difference;
    fixpair_control_variate values[VALUES];
    fixpair_layout layout;
    double numbers[6], mu[VALUES], error[VALUES];
    uint64_t hash;
    void *scratch;
    int i;
    MUST(fixpair_matched_difference(&difference, wanted, cheap, SAMPLES));
    check_case("matched_difference", hash_bytes(HASH_START, &difference, sizeof difference));
    MUST(fixpair_difference_sigma(&numbers[0], 12.1, 11.8, 0.76));
    MUST(fixpair_effective_volume(&numbers[1], 60.5, 1, 12.1, 2));
    MUST(fixpair_universality(&numbers[2], &numbers[3], 2.32, 0.01, 109.2, 8.3, -0.05, 100.0));
    MUST(fixpair_control_variate_gain(&numbers[4], 12.1, 11.8, 0.76, 0.5));
    MUST(fixpair_control_variate_loss(&numbers[5], 12, 3));
    check_case("matched_numbers", hash_doubles(HASH_START, numbers, 6));
    for (i = 0; i < VALUES; i++) {
        mu[i] = 90.0 + 5.0 * (double)i;
        error[i] = 0.125;
    }
    MUST(fixpair_control_variates_scratch(&layout, SAMPLES));
    scratch = take_scratch(layout.size);
    hash = hash_layout(HASH_START, layout);
    for (i = 0; i < 3; i++) {
        MUST(fixpair_control_variates(values, VALUES, wanted, cheap, SAMPLES, mu, i == 2 ? error : NULL,
                                      i == 0 ? FIXPAIR_BETA_GIVEN : FIXPAIR_BETA_OPTIMAL, 1.0, scratch, layout.size));
        hash = hash_bytes(hash, values, sizeof values);
    }
    check_case("control_variates", hash);
    give_back(scratch);
}

#ifndef FIXPAIR_NO_LINALG
static void matrices(void) {
    static double matrix[SIDE * SIDE], root[SIDE * SIDE];
    double controls[SAMPLES * CONTROLS], mu[CONTROLS], of_mu[CONTROLS * CONTROLS], mean[VALUES], covariance[VALUES * VALUES];
    double beta[VALUES * CONTROLS];
    fixpair_layout layout;
    uint64_t hash;
    void *scratch;
    int i, j, with;
    for (i = 0; i < SIDE; i++) {
        for (j = 0; j < SIDE; j++) {
            double correlation = i == j ? 1.5 : 1.0 / (1.0 + (double)abs(i - j));
            matrix[i * SIDE + j] = correlation * (double)((i + 1) * (j + 1));
        }
    }
    MUST(fixpair_covariance_root_scratch(&layout, SIDE));
    scratch = take_scratch(layout.size);
    MUST(fixpair_covariance_root(root, matrix, SIDE, scratch, layout.size));
    check_case("covariance_root", hash_doubles(hash_layout(HASH_START, layout), root, SIDE * SIDE));
    give_back(scratch);
    for (i = 0; i < SAMPLES * CONTROLS; i++) {
        controls[i] = cheap[i / CONTROLS * VALUES + i % CONTROLS];
    }
    for (i = 0; i < CONTROLS; i++) {
        mu[i] = 90.0 + 5.0 * (double)i;
        for (j = 0; j < CONTROLS; j++) {
            of_mu[i * CONTROLS + j] = i == j ? 0.015625 : 0.0;
        }
    }
    MUST(fixpair_carpool_scratch(&layout, VALUES, CONTROLS));
    scratch = take_scratch(layout.size);
    hash = hash_layout(HASH_START, layout);
    for (with = 0; with < 2; with++) {
        MUST(fixpair_carpool(mean, covariance, beta, wanted, controls, SAMPLES, VALUES, mu, with ? of_mu : NULL, CONTROLS,
                             scratch, layout.size));
        hash = hash_doubles(hash_doubles(hash, mean, VALUES), covariance, VALUES * VALUES);
        hash = hash_doubles(hash, beta, VALUES * CONTROLS);
    }
    check_case("carpool", hash);
    give_back(scratch);
}
#endif

static int near(double value, double expected, double tolerance) {
    return value >= expected - tolerance && value <= expected + tolerance;
}

/* What Avila & Adame print, and a universe of their halos without noise, whose parameters come back. */
static void known_answers(const spectra_of_halos *of) {
    fixpair_bias_likelihood likelihood;
    fixpair_bias_fit fit;
    fixpair_bias start;
    fixpair_posterior posterior[2];
    fixpair_layout layout;
    double power[BINS], value, error;
    void *scratch;
    MUST(fixpair_difference_sigma(&value, 12.1, 11.8, 0.76));
    CHECK(near(value, 8.3, 0.05));
    MUST(fixpair_effective_volume(&value, 60.5, 1, 7.3, 1));
    CHECK(near(value, 69.0, 0.5));
    MUST(fixpair_universality(&value, &error, 2.32, 0.0, 109.2, 5.2, 0.0, 100.0));
    CHECK(near(value, 0.8786, 5e-5) && near(error, 1.32 * 0.052, 1e-12));
    MUST(fixpair_halo_power(power, &truth, of->linear, of->alpha, BINS, FIXPAIR_SPECTRUM_HALO_HALO));
    MUST(fixpair_likelihood_init(&likelihood));
    MUST(fixpair_likelihood_add(&likelihood, power, of->sigma[0], of->linear, of->alpha, BINS, FIXPAIR_SPECTRUM_HALO_HALO));
    MUST(fixpair_bias_init(&start));
    MUST(fixpair_bias_posterior_scratch(&layout, 128));
    scratch = take_scratch(layout.size);
    MUST(fixpair_bias_posterior(&fit, posterior, 2, &likelihood, &start, FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL, 128, 0.68,
                                scratch, layout.size));
    CHECK(near(fit.value.b_g, 2.32, 1e-9) && near(fit.value.f_nl, 100.0, 1e-6) && fit.value.p == 1.0);
    CHECK(fit.chi_squared < 1e-12 && fit.degrees == BINS - 2);
    CHECK(near(posterior[1].peak, 100.0, 0.2 * fit.error[2]) && near(posterior[1].deviation, fit.error[2], 0.1 * fit.error[2]));
    /* One deviation on either side of a Gaussian holds 0.68. */
    CHECK(near(posterior[0].half_width, 0.9945 * posterior[0].deviation, 0.02 * posterior[0].deviation));
    give_back(scratch);
}

static void statistics(void) {
    static spectra_of_halos of;
    fixpair_bias_likelihood likelihood;
    double mean[VALUES];
    CHECK(sizeof(fixpair_suppression) == 24 && sizeof(fixpair_suppression_fit) == 136);
    CHECK(sizeof(fixpair_bias) == 32 && sizeof(fixpair_bias_likelihood) == 296 && sizeof(fixpair_bias_fit) == 144);
    CHECK(sizeof(fixpair_posterior) == 64 && sizeof(fixpair_difference) == 72 && sizeof(fixpair_control_variate) == 48);
    make_samples();
    make_spectra(&of);
    ensembles(mean);
    resampling(mean);
    scatters(&of);
    biases(&of, &likelihood);
    posteriors_of(&likelihood);
    matched();
#ifndef FIXPAIR_NO_LINALG
    matrices();
#endif
    known_answers(&of);
}
