/*
 * The part of fuzz.c about statistics. What is OK is finite.
 */

enum { MOST = 8 };

/* Doubles of a struct that ends with a count. */
#define NUMBERS_OF(type) ((sizeof(type) - sizeof(uint64_t)) / sizeof(double))

/* A number of estimates or of simulations. */
static uint64_t amount(void) {
    return word() % 4 ? word() % 50 : word() >> (word() % 64);
}

/* After an answer of OK these are finite. */
static void finite_if(fixpair_status_t status, const double *values, size_t count) {
    size_t i;
    int sound = 1;
    sane(status);
    for (i = 0; i < count && status == FIXPAIR_OK; i++) {
        sound &= isfinite(values[i]) != 0;
    }
    CHECK(sound);
}

/* Numbers of some scale, one in a hundred of them spoiled. */
static void some(double *to, size_t count, double low, double high) {
    size_t i;
    for (i = 0; i < count; i++) {
        to[i] = word() % 100 ? low + (high - low) * (double)(word() >> 11) / 9007199254740992.0 : number();
    }
}

static void ensembles(void) {
    double state[64], other[64], out[2 * MOST * MOST], samples[4 * MOST];
    size_t values = 1 + (size_t)(word() % 5), len, rows = (size_t)word() % (MOST + 1), columns = (size_t)word() % (MOST + 1);
    int32_t of = (int32_t)(word() % 2);
    uint64_t count;
    sane(fixpair_ensemble_length(&len, size(), choice()));
    MUST(fixpair_ensemble_length(&len, values, of));
    sane(fixpair_ensemble_init(state, word() % 8 ? len : few(64) % 64, word() % 8 ? values : size(), word() % 8 ? of : choice()));
    MUST(fixpair_ensemble_init(state, len, values, of));
    MUST(fixpair_ensemble_init(other, len, values, of));
    some(samples, 4 * MOST, -1.0, 1.0);
    sane(fixpair_ensemble_add(state, len, samples, word() % 4 ? values * (size_t)(word() % 5) : few(32) % 32));
    some(samples, 4 * MOST, 1e3, 1e5);
    sane(fixpair_ensemble_add(other, len, samples, values * (size_t)(word() % 5)));
    if (word() % 4 == 0) {
        state[word() % len] = number();
    }
    sane(fixpair_ensemble_merge(state, len, other));
    sane(fixpair_ensemble_merge(other, len, state));
    sane(fixpair_ensemble_count(&count, other, len));
    finite_if(fixpair_ensemble_mean(out, values, other, len), out, values);
    finite_if(fixpair_ensemble_deviation(out, values, other, len), out, values);
    finite_if(fixpair_ensemble_error_of_mean(out, values, other, len), out, values);
    finite_if(fixpair_ensemble_covariance(out, rows, columns, other, len, few(6), few(6)), out, rows * columns);
    finite_if(fixpair_ensemble_correlation(out, rows, columns, other, len, few(6), few(6)), out, rows * columns);
    some(samples, 3 * MOST, 0.0, 1.0);
    finite_if(fixpair_pair_average(out, samples, samples + MOST, MOST), out, MOST);
    finite_if(fixpair_sigma_per_simulation(out, out + MOST, samples, MOST, amount(), amount()), out, 2 * MOST);
}

static void resamplings(void) {
    double samples[4 * MOST], deleted[4 * MOST], out[MOST * MOST];
    uint64_t indices[MOST];
    size_t values = (size_t)word() % 5, rows = (size_t)word() % 5, i;
    some(samples, 4 * MOST, -1.0, 1.0);
    sane(fixpair_bootstrap_indices(indices, MOST, amount(), word(), word()));
    for (i = 0; i < MOST; i++) {
        indices[i] = word() % 16 ? word() % 4 : word();
    }
    finite_if(fixpair_resampled_mean(out, values, samples, rows, indices, (size_t)word() % (MOST + 1)), out, values);
    memcpy(deleted, samples, sizeof deleted);
    finite_if(fixpair_jackknife_means(deleted, samples, rows, values), deleted, rows * values);
    finite_if(fixpair_jackknife(out, out + MOST, samples, values, deleted, rows), out, values);
    finite_if(fixpair_jackknife_covariance(out, deleted, rows, values), out, values * values);
}

static void scatters(void) {
    double k[MOST], power[MOST], modes[MOST], sigma[MOST], error[MOST], rho[MOST], out[2 * MOST], noise_of = maybe(100.0);
    uint64_t edges[4], counts[4];
    fixpair_suppression left;
    fixpair_suppression_fit fit;
    size_t len = (size_t)word() % (MOST + 1), i;
    some(k, MOST, 0.01, 0.4);
    some(power, MOST, 1e3, 1e4);
    some(modes, MOST, 10.0, 1e4);
    some(rho, MOST, -1.0, 1.0);
    left.cosmic_variance = maybe(0.2);
    left.softening = maybe(0.05);
    left.shot_noise = maybe(0.9);
    for (i = 0; i < 4; i++) {
        edges[i] = word() % 64 ? (uint64_t)i * 10 + word() % 12 : word();
    }
    finite_if(fixpair_continuum_modes(out, k, len, maybe(0.01), maybe(1000.0)), out, len);
    sane(fixpair_lattice_modes(counts, edges, (size_t)word() % 5));
    finite_if(fixpair_sigma_gaussian(out, power, modes, len, noise_of), out, len);
    some(sigma, MOST, 10.0, 1000.0);
    finite_if(fixpair_sigma_suppressed(sigma, &left, k, power, modes, len, noise_of), sigma, len);
    some(error, MOST, 1.0, 100.0);
    if (word() % 32 == 0) {
        finite_if(fixpair_fit_suppression(&fit, sigma, word() % 2 ? error : NULL, k, power, modes, len, noise_of, amount()),
                  (const double *)(const void *)&fit, NUMBERS_OF(fixpair_suppression_fit));
    }
    finite_if(fixpair_ratio_of_means(out, out + MOST, power, error, sigma, error, word() % 2 ? rho : NULL, MOST), out, 2 * MOST);
    finite_if(fixpair_difference_of_means(out, out + MOST, power, error, sigma, error, word() % 2 ? rho : NULL, sigma, MOST), out,
              2 * MOST);
}

static void biases_and_posteriors(double *scratch) {
    fixpair_bias bias, start;
    fixpair_bias_likelihood likelihood, other;
    fixpair_bias_fit fit;
    fixpair_posterior posterior[2];
    fixpair_layout layout;
    double power[MOST], sigma[MOST], linear[MOST], alpha[MOST], root[MOST * MOST], out[2 * MOST], grid[64], segments[4 * 64];
    double ranges[4] = {0.0, 1.0, 0.0, 1.0};
    const double *members = (const double *)(const void *)&fit;
    double value;
    fixpair_status_t status;
    uint32_t free_of = word() % 8 ? (uint32_t)(word() % 6) : (uint32_t)word();
    size_t len = (size_t)word() % (MOST + 1), points[2], count, parameters = (size_t)(free_of & 1) + (free_of > 1), i;
    int32_t of = word() % 8 ? (int32_t)(word() % 2) : choice();
    MUST(fixpair_bias_init(&start));
    start.b_g = maybe(2.0);
    start.p = maybe(1.0);
    start.f_nl = maybe(50.0);
    start.delta_c = maybe(1.686);
    bias = start;
    some(linear, MOST, 1e3, 1e4);
    some(alpha, MOST, 100.0, 1e4);
    some(sigma, MOST, 100.0, 1e3);
    some(power, MOST, 1e4, 2e4);
    some(root, MOST * MOST, 0.0, 1e3);
    finite_if(fixpair_bias_of_k(out, &bias, alpha, len), out, len);
    finite_if(fixpair_halo_power(out, &bias, linear, alpha, len, of), out, len);
    finite_if(fixpair_measured_bias(out, out + MOST, power, sigma, linear, MOST, of), out, 2 * MOST);
    MUST(fixpair_likelihood_init(&likelihood));
    MUST(fixpair_likelihood_init(&other));
    sane(fixpair_likelihood_add(&likelihood, power, sigma, linear, alpha, MOST, of));
    sane(fixpair_likelihood_add_correlated_scratch(&layout, size()));
    sane(fixpair_likelihood_add_correlated(&other, power, linear, alpha, root, len, few(MOST), maybe(1.0), scratch, BYTES));
    if (word() % 8 == 0) {
        other.root[word() % 6][word() % 6] = number();
    }
    sane(fixpair_likelihood_merge(&likelihood, &other));
    if (word() % 8 == 0) {
        likelihood.root[word() % 6][word() % 6] = number();
    }
    finite_if(fixpair_likelihood_chi_squared(&value, &likelihood, &bias), &value, 1);
    finite_if(fixpair_fit_bias(&fit, &likelihood, &start, free_of), members, NUMBERS_OF(fixpair_bias_fit));
    sane(fixpair_bias_posterior_scratch(&layout, few(10000)));
    if (word() % 4 == 0) {
        status = fixpair_bias_posterior(&fit, posterior, parameters, &likelihood, &start, free_of, 16 + few(16) % 16, maybe(0.68),
                                        scratch, BYTES);
        finite_if(status, members, NUMBERS_OF(fixpair_bias_fit));
        finite_if(status, (const double *)(const void *)posterior, parameters * sizeof *posterior / sizeof(double));
    }
    if (fixpair_bias_range(ranges, parameters, &likelihood, &start, free_of) != FIXPAIR_OK || word() % 4 == 0) {
        some(ranges, 4, -1.0, 0.0);
        ranges[1] += maybe(1.0);
        ranges[3] += maybe(100.0);
    }
    points[0] = (size_t)word() % 9;
    points[1] = word() % 16 ? (size_t)word() % 9 : size();
    count = parameters == 2 ? points[0] * (points[1] % 9) : points[0];
    finite_if(fixpair_bias_grid(grid, count, &likelihood, &start, free_of, ranges, points, parameters), grid, count);
    some(grid, 64, 0.0, 10.0);
    points[1] %= 9;
    for (i = 0; i < 2; i++) {
        int32_t axis = word() % 8 ? (int32_t)i : choice();
        finite_if(fixpair_marginal(out, grid, points[0], points[1], axis, ranges[2 * i], ranges[2 * i + 1]), out,
                  axis == 0 || axis == 1 ? points[axis] : 0);
        finite_if(fixpair_read_posterior(posterior, grid, points[i], ranges[2 * i], ranges[2 * i + 1], maybe(0.68)),
                  (const double *)(const void *)posterior, 8);
    }
    count = 0;
    sane(fixpair_contours(NULL, 0, &count, grid, points[0], points[1], ranges, maybe(5.0)));
    CHECK(count <= 2 * 64);
    len = 1 + (size_t)word() % 64;
    status = fixpair_contours(segments, len, &count, grid, points[0], points[1], ranges, maybe(5.0));
    CHECK(status != FIXPAIR_OK || count <= len);
    finite_if(status, segments, 4 * count);
}

static void matched_and_matrices(double *scratch) {
    double y[4 * MOST], c[4 * MOST], mu[MOST], error[MOST], matrix[MOST * MOST], out[MOST * MOST], beta[MOST * MOST], value[2];
    fixpair_difference difference;
    fixpair_control_variate controls[4];
    fixpair_layout layout;
    size_t rows = (size_t)word() % (MOST + 1), values = (size_t)word() % 5, width = (size_t)word() % 5, i, j;
    some(y, 4 * MOST, -1.0, 1.0);
    some(c, 4 * MOST, -1.0, 1.0);
    some(mu, MOST, -1.0, 1.0);
    some(error, MOST, 0.0, 1.0);
    some(matrix, MOST * MOST, 0.0, 1.0);
    finite_if(fixpair_delta_chi_squared(value, maybe(0.68), (uint32_t)(word() % 4)), value, 1);
    finite_if(fixpair_hartlap_factor(value, amount(), amount()), value, 1);
    finite_if(fixpair_percival_factor(value, amount(), amount(), amount()), value, 1);
    finite_if(fixpair_matched_difference(&difference, y, c, rows), (const double *)(const void *)&difference, 9);
    finite_if(fixpair_difference_sigma(value, maybe(12.1), maybe(11.8), maybe(0.76)), value, 1);
    finite_if(fixpair_effective_volume(value, maybe(60.5), amount(), maybe(7.3), amount()), value, 1);
    finite_if(fixpair_universality(&value[0], &value[1], maybe(2.32), maybe(0.01), maybe(109.2), maybe(5.2), maybe(0.0),
                                   maybe(100.0)), value, 2);
    finite_if(fixpair_control_variate_gain(value, maybe(12.1), maybe(11.8), maybe(0.76), maybe(1.0)), value, 1);
    finite_if(fixpair_control_variate_loss(value, amount(), amount()), value, 1);
    sane(fixpair_control_variates_scratch(&layout, size()));
    finite_if(fixpair_control_variates(controls, values, y, c, rows, mu, word() % 2 ? error : NULL, (int32_t)(word() % 3),
                                       maybe(1.0), scratch, word() % 8 ? BYTES : size() % BYTES), (const double *)(const void *)controls, 6 * values);
    sane(fixpair_covariance_root_scratch(&layout, size()));
    for (i = 0; i < rows && word() % 8; i++) {
        for (j = 0; j < i; j++) {
            matrix[i * rows + j] = matrix[j * rows + i];
        }
        matrix[i * rows + i] = maybe(2.0);
    }
    finite_if(fixpair_covariance_root(out, matrix, rows, scratch, word() % 8 ? BYTES : size() % BYTES), out, rows * rows);
    sane(fixpair_carpool_scratch(&layout, size(), size()));
    matrix[0] = matrix[width + 1] = maybe(1.0);
    finite_if(fixpair_carpool(mu, out, beta, y, c, rows, values, error, word() % 2 && width < 3 ? matrix : NULL, width, scratch,
                              word() % 8 ? BYTES : size() % BYTES), out, values * values);
}

static void statistics(double *scratch) {
    ensembles();
    resamplings();
    scatters();
    biases_and_posteriors(scratch);
    matched_and_matrices(scratch);
}
