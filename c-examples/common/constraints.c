#include "constraints.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

/* Points of each axis of a posterior, its central region, replicates of the bootstrap and the seed of its draws. */
enum { POINTS = 128, REPLICATES = 1000, BOOTSTRAP_SEED = 1 };
#define PROBABILITY 0.68

/* A state of variances of one value. */
enum { STATE_OF_ONE = 5 };

int constraints_choice_init(struct constraints_choice *choice) {
    memset(choice, 0, sizeof *choice);
    TRY(fixpair_cosmology_init(&choice->cosmology));
    choice->redshift = 1.0;
    choice->convention = FIXPAIR_CONVENTION_CMB;
    choice->highest_scatter = 0.4;
    choice->highest_bias = 0.09;
    return 0;
}

static double *take(struct constraints *constraints, size_t count) {
    double *block = memory_take_doubles(count);
    if (block != NULL) constraints->blocks[constraints->blocks_len++] = block;
    return block;
}

void constraints_close(struct constraints *constraints) {
    for (size_t i = 0; i < constraints->blocks_len; i++) free(constraints->blocks[i]);
    memset(constraints, 0, sizeof *constraints);
}

/* ---- The scatter of spectra. */

static int amplitude_of(int type) {
    return type == CONSTRAINTS_NORMAL || type == CONSTRAINTS_NORMAL_PAIRED ? MATCHED_NORMAL : MATCHED_FIXED;
}

static int is_paired(int type) {
    return type == CONSTRAINTS_FIXED_PAIRED || type == CONSTRAINTS_NORMAL_PAIRED;
}

/* Mean over rows of `first` and of `second`, which may be NULL; and deviation over rows of `first`, unless that is NULL. */
static int moments(double *mean, double *deviation, const double *first, const double *second, size_t rows, size_t bins) {
    size_t length;
    TRY(fixpair_ensemble_length(&length, bins, FIXPAIR_MOMENTS_VARIANCE));
    double *state = memory_take_doubles(length);
    if (state == NULL) return 1;
    int32_t status = fixpair_ensemble_init(state, length, bins, FIXPAIR_MOMENTS_VARIANCE);
    if (status == 0) status = fixpair_ensemble_add(state, length, first, rows * bins);
    if (status == 0 && deviation != NULL) status = fixpair_ensemble_deviation(deviation, bins, state, length);
    if (status == 0 && second != NULL) status = fixpair_ensemble_add(state, length, second, rows * bins);
    if (status == 0) status = fixpair_ensemble_mean(mean, bins, state, length);
    free(state);
    TRY(status);
    return 0;
}

/* Eq. sigma_fix for `type`: fitted, and then in `used` as the scatter of one estimate. */
static int fit_scatter(struct constraints_half *half, const struct constraints_type *type, const struct matched *matched, size_t bins,
                       double noise) {
    int32_t status = fixpair_fit_suppression(&half->fit, half->sigma, NULL, matched->k, half->mean, matched->modes, bins, noise,
                                             matched->seeds);
    if (status == 0) {
        status = fixpair_sigma_suppressed(half->used, &half->fit.value, matched->k, half->mean, matched->modes, matched->bins, noise);
    }
    if (status < 0) {
        report_status(__FILE__, __LINE__, status);
        fprintf(stderr, "the scatter of %s is not that of Eq. sigma_fix; fit f_NL with what was measured: --measured\n",
                type->simulations == 2 ? "pairs of fixed simulations" : "fixed simulations");
        return 1;
    }
    for (size_t b = 0; b < matched->bins; b++) half->used[b] /= sqrt((double)type->simulations);
    return 0;
}

/* All spectra of one type and half. */
static int measure(struct constraints *constraints, int type, int half_number, const struct matched *matched,
                   const struct constraints_choice *choice) {
    struct constraints_half *half = &constraints->type[type].half[half_number];
    size_t bins = matched->bins, seeds = matched->seeds;
    double *const(*power)[2] = matched->power[amplitude_of(type)];
    const double *original = power[MATCHED_ORIGINAL][half_number], *inverted = power[MATCHED_INVERTED][half_number];
    double noise = matched->box_size * matched->box_size * matched->box_size / matched->halos[half_number];
    double **const arrays[] = {&half->mean, &half->theory, &half->sigma, &half->error, &half->used};
    for (int i = 0; i < 5; i++) {
        if ((*arrays[i] = take(constraints, bins)) == NULL) return 1;
    }
    half->samples = original;
    if (is_paired(type)) {
        double *average = take(constraints, seeds * bins);
        if (average == NULL) return 1;
        TRY(fixpair_pair_average(average, original, inverted, seeds * bins));
        half->samples = average;
    }
    TRY(moments(half->mean, half->used, half->samples, NULL, seeds, bins));
    TRY(fixpair_sigma_per_simulation(half->sigma, half->error, half->used, bins, seeds, constraints->type[type].simulations));
    TRY(moments(half->mean, NULL, original, inverted, seeds, bins));
    TRY(fixpair_sigma_gaussian(half->theory, half->mean, matched->modes, bins, noise));

    /* The scatter of one estimate, which `used` holds as measured. */
    if (choice->measured || type == CONSTRAINTS_NORMAL_PAIRED) return 0;
    if (type == CONSTRAINTS_NORMAL) {
        memcpy(half->used, half->theory, bins * sizeof *half->used);
        return 0;
    }
    return fit_scatter(half, &constraints->type[type], matched, constraints->scatter_bins, noise);
}

/* ---- Fits of f_NL. */

int constraints_fit(double *f_nl, double *b_g, struct fixpair_posterior *posterior, const double *power, const double *sigma,
                    const double *linear, const double *alpha, size_t bins) {
    struct fixpair_bias_likelihood likelihood;
    struct fixpair_bias start;
    struct fixpair_bias_fit fit;
    struct fixpair_posterior posteriors[2];
    struct fixpair_layout layout;
    TRY(fixpair_likelihood_init(&likelihood));
    TRY(fixpair_likelihood_add(&likelihood, power, sigma, linear, alpha, bins, FIXPAIR_SPECTRUM_HALO_HALO));
    TRY(fixpair_bias_init(&start));
    TRY(fixpair_bias_posterior_scratch(&layout, POINTS));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;
    int32_t status = fixpair_bias_posterior(&fit, posteriors, 2, &likelihood, &start, FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL, POINTS,
                                            PROBABILITY, scratch, layout.size);
    free(scratch);
    TRY(status);
    *b_g = posteriors[0].peak;
    *f_nl = posteriors[1].peak;
    *posterior = posteriors[1];
    return 0;
}

static int fit_half(struct constraints *constraints, struct constraints_half *half, const struct matched *matched) {
    struct fixpair_posterior posterior;
    double peak, bias;
    size_t bins = constraints->bias_bins;
    if ((half->f_nl = take(constraints, matched->seeds)) == NULL || (half->b_g = take(constraints, matched->seeds)) == NULL) return 1;
    for (size_t s = 0; s < matched->seeds; s++) {
        const double *power = half->samples + s * matched->bins;
        if (constraints_fit(half->f_nl + s, half->b_g + s, &posterior, power, half->used, matched->linear, constraints->alpha, bins) == 0) {
            continue;
        }
        fprintf(stderr, "seed %llu cannot be fitted: take a larger --k-bias, or leave its rows out\n",
                (unsigned long long)matched->seed[s]);
        return 1;
    }
    return constraints_fit(&peak, &bias, &half->on_mean, half->mean, half->used, matched->linear, constraints->alpha, bins);
}

/* ---- What matching is worth. */

/* p of each estimate, as if it had been measured with p = 1: from f100, or from the difference, whose scatter is less. */
static int find_p(struct constraints_type *type, const struct matched *matched, int from_difference) {
    const struct constraints_half *halves = type->half;
    double state[STATE_OF_ONE], p, error;
    TRY(fixpair_ensemble_init(state, STATE_OF_ONE, 1, FIXPAIR_MOMENTS_VARIANCE));
    for (size_t s = 0; s < matched->seeds; s++) {
        double f_nl = from_difference ? halves[1].f_nl[s] - halves[0].f_nl[s] : halves[1].f_nl[s];
        TRY(fixpair_universality(&p, &error, halves[1].b_g[s], 0.0, f_nl, 0.0, 0.0, matched->f_nl[1]));
        TRY(fixpair_ensemble_add(state, STATE_OF_ONE, &p, 1));
    }
    TRY(fixpair_ensemble_mean(&type->p[from_difference], 1, state, STATE_OF_ONE));
    TRY(fixpair_ensemble_deviation(&type->p_deviation[from_difference], 1, state, STATE_OF_ONE));
    return 0;
}

static int match(struct constraints_type *type, const struct matched *matched) {
    const struct constraints_half *none = &type->half[0], *some = &type->half[1];
    struct fixpair_difference *difference = &type->difference;
    struct fixpair_layout layout;
    /* f_NL = 0 is what simulations without it have, whatever p is. */
    const double mu = 0.0;
    TRY(fixpair_matched_difference(difference, some->f_nl, none->f_nl, matched->seeds));
    type->gauss = some->on_mean.peak - none->on_mean.peak;
    TRY(fixpair_difference_sigma(&type->gauss_sigma, some->on_mean.half_width, none->on_mean.half_width, difference->correlation));
    TRY(fixpair_control_variates_scratch(&layout, matched->seeds));
    void *scratch = memory_take(layout);
    if (scratch == NULL) return 1;
    int32_t status = fixpair_control_variates(&type->control, 1, some->f_nl, none->f_nl, matched->seeds, &mu, NULL, FIXPAIR_BETA_OPTIMAL,
                                              0.0, scratch, layout.size);
    free(scratch);
    TRY(status);
    TRY(fixpair_control_variate_gain(&type->difference_gain, difference->deviation_first, difference->deviation_second,
                                     difference->correlation, 1.0));
    TRY(find_p(type, matched, 0));
    return find_p(type, matched, 1);
}

/* Both volumes of a type from the scatters of f100 and of the difference; `reference` that of f100 in Normal simulations. */
static int volumes(double volume[2], double reference, double scatter, double difference, uint64_t simulations) {
    TRY(fixpair_effective_volume(&volume[0], reference, 1, scatter, simulations));
    TRY(fixpair_effective_volume(&volume[1], reference, 1, difference, simulations));
    return 0;
}

/* Standard deviation of the estimates that indices name: f100, or f100 - f0. */
static int resampled_deviation(double *deviation, const struct constraints_type *type, int from_difference, const uint64_t *indices,
                               size_t indices_len) {
    double state[STATE_OF_ONE];
    TRY(fixpair_ensemble_init(state, STATE_OF_ONE, 1, FIXPAIR_MOMENTS_VARIANCE));
    for (size_t i = 0; i < indices_len; i++) {
        double f_nl = type->half[1].f_nl[indices[i]];
        if (from_difference) f_nl -= type->half[0].f_nl[indices[i]];
        TRY(fixpair_ensemble_add(state, STATE_OF_ONE, &f_nl, 1));
    }
    TRY(fixpair_ensemble_deviation(deviation, 1, state, STATE_OF_ONE));
    return 0;
}

/* Errors of the volumes. A replicate draws the same seeds for the type and its reference: what they share, both ratios share. */
static int bootstrap(struct constraints_type *type, const struct constraints_type *normal, uint64_t *indices, size_t seeds) {
    double states[2][STATE_OF_ONE];
    for (int i = 0; i < 2; i++) TRY(fixpair_ensemble_init(states[i], STATE_OF_ONE, 1, FIXPAIR_MOMENTS_VARIANCE));
    for (uint64_t replicate = 0; replicate < REPLICATES; replicate++) {
        double reference, scatter, difference, volume[2];
        TRY(fixpair_bootstrap_indices(indices, seeds, seeds, BOOTSTRAP_SEED, replicate));
        TRY(resampled_deviation(&reference, normal, 0, indices, seeds));
        TRY(resampled_deviation(&scatter, type, 0, indices, seeds));
        TRY(resampled_deviation(&difference, type, 1, indices, seeds));
        TRY(volumes(volume, reference, scatter, difference, type->simulations));
        for (int i = 0; i < 2; i++) TRY(fixpair_ensemble_add(states[i], STATE_OF_ONE, &volume[i], 1));
    }
    TRY(fixpair_ensemble_deviation(&type->volume_error, 1, states[0], STATE_OF_ONE));
    TRY(fixpair_ensemble_deviation(&type->matched_volume_error, 1, states[1], STATE_OF_ONE));
    return 0;
}

static int compare(struct constraints_type *type, const struct constraints_type *normal, size_t seeds) {
    double volume[2] = {NAN, NAN}, on_mean[2] = {NAN, NAN};
    type->volume_error = type->matched_volume_error = NAN;
    if (normal->present) {
        const struct fixpair_difference *difference = &type->difference;
        TRY(volumes(volume, normal->difference.deviation_first, difference->deviation_first, difference->deviation, type->simulations));
        TRY(volumes(on_mean, normal->half[1].on_mean.half_width, type->half[1].on_mean.half_width, type->gauss_sigma, type->simulations));
        uint64_t *indices = malloc(seeds * sizeof *indices);
        int broken = indices == NULL || bootstrap(type, normal, indices, seeds) != 0;
        free(indices);
        if (broken) return 1;
    }
    type->volume = volume[0];
    type->matched_volume = volume[1];
    type->volume_on_mean = on_mean[0];
    type->matched_volume_on_mean = on_mean[1];
    return 0;
}

/* ---- All of it. */

/* The linear P of the spectra has to be that of the table at the redshift, else alpha is wrong and nobody sees it. */
static int check_linear(const struct matched *matched, const struct constraints_choice *choice, size_t b) {
    double power;
    TRY(fixpair_linear_power(&power, &matched->k[b], 1, &choice->cosmology, &choice->linear, choice->redshift));
    if (fabs(matched->linear[b] / power - 1.0) < 0.05) return 0;
    fprintf(stderr, "linear P is %g (Mpc/h)^3 at k = %g h/Mpc, where that of the Boltzmann code's table is %g at z = %g: say --redshift Z, "
            "--linear TABLE, or the table's cosmology, --omega-m O and --n-s N\n",
            matched->linear[b], matched->k[b], power, choice->redshift);
    return 1;
}

int constraints_find(struct constraints *constraints, const struct matched *matched, const struct constraints_choice *choice) {
    memset(constraints, 0, sizeof *constraints);
    size_t *scatter_bins = &constraints->scatter_bins, *bias_bins = &constraints->bias_bins;
    while (*scatter_bins < matched->bins && matched->k[*scatter_bins] < choice->highest_scatter) ++*scatter_bins;
    while (*bias_bins < matched->bins && matched->k[*bias_bins] <= choice->highest_bias) ++*bias_bins;
    if (*scatter_bins < 4 || *bias_bins < 3) {
        fprintf(stderr, "%lu bins below %g h/Mpc and %lu up to %g are too few; 4 for the scatter and 3 for f_NL at least\n",
                (unsigned long)*scatter_bins, choice->highest_scatter, (unsigned long)*bias_bins, choice->highest_bias);
        return 1;
    }
    if (check_linear(matched, choice, *bias_bins - 1) != 0) return 1;
    if ((constraints->alpha = take(constraints, matched->bins)) == NULL) return 1;
    TRY(fixpair_alpha(constraints->alpha, matched->k, matched->bins, &choice->cosmology, &choice->linear, choice->redshift,
                      choice->convention));
    for (int t = 0; t < CONSTRAINTS_TYPES; t++) {
        struct constraints_type *type = &constraints->type[t];
        double *const(*power)[2] = matched->power[amplitude_of(t)];
        type->present = power[MATCHED_ORIGINAL][0] != NULL && (!is_paired(t) || power[MATCHED_INVERTED][0] != NULL);
        type->simulations = is_paired(t) ? 2 : 1;
        for (int half = 0; type->present && half < 2; half++) {
            if (measure(constraints, t, half, matched, choice) != 0) return 1;
            if (t < CONSTRAINTS_FITTED && fit_half(constraints, &type->half[half], matched) != 0) return 1;
        }
        if (!type->present || t >= CONSTRAINTS_FITTED) continue;
        if (match(type, matched) != 0) return 1;
        if (compare(type, &constraints->type[CONSTRAINTS_NORMAL], matched->seeds) != 0) return 1;
    }
    return 0;
}
