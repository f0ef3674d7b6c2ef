#include "mock_claims.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "matched_report.h"
#include "memory.h"

/* Standard errors that a claim allows. */
#define TOLERANCE 3.0

/* What estimates of f_NL of one type should be: by half, and together. */
struct expectation {
    double f_nl[2], sigma[2], correlation, difference;
};

struct checker {
    const struct constraints *constraints;
    const struct matched *matched;
    const struct mock_truth *truth;
    const struct mock_choice *choice;
    double deviation_error; /* relative, of a standard deviation (Eq. errerr) */
    struct expectation expected[CONSTRAINTS_FITTED];
    int failures;
};

static int amplitude_of(int type) {
    return type == CONSTRAINTS_NORMAL || type == CONSTRAINTS_NORMAL_PAIRED ? MATCHED_NORMAL : MATCHED_FIXED;
}

/* Variances of an estimate, and correlation of both halves, in each bin. */
static void true_scatter(double *sigma[2], double *correlation, const struct checker *checker, int type) {
    int paired = checker->constraints->type[type].simulations == 2;
    for (size_t b = 0; b < checker->matched->bins; b++) {
        double covariance[3];
        mock_covariance(covariance, checker->truth, amplitude_of(type), paired, b);
        sigma[0][b] = sqrt(covariance[0]);
        sigma[1][b] = sqrt(covariance[2]);
        correlation[b] = covariance[1] / (sigma[0][b] * sigma[1][b]);
    }
}

/* ---- What is to be expected. */

/* Half a sigma in one bin after the other: responses of f_NL, in units of a sigma. `power` is a copy to work on. */
static int respond(double *response, double *f_nl, double *power, const struct checker *checker, const double *sigma) {
    const struct constraints *constraints = checker->constraints;
    size_t bins = constraints->bias_bins;
    struct fixpair_posterior posterior;
    double bias, both[2];
    TRY(constraints_fit(f_nl, &bias, &posterior, power, sigma, checker->matched->linear, constraints->alpha, bins));
    for (size_t b = 0; b < bins; b++) {
        double kept = power[b];
        for (int side = 0; side < 2; side++) {
            power[b] = kept + (side == 0 ? 0.5 : -0.5) * sigma[b];
            TRY(constraints_fit(&both[side], &bias, &posterior, power, sigma, checker->matched->linear, constraints->alpha, bins));
        }
        power[b] = kept;
        response[b] = both[0] - both[1];
    }
    return 0;
}

static int expect(struct checker *checker, int type, double *work) {
    struct expectation *expected = &checker->expected[type];
    size_t bins = checker->matched->bins;
    double *sigma[2] = {work, work + bins}, *response[2] = {work + 2 * bins, work + 3 * bins}, *correlation = work + 4 * bins;
    double sums[3] = {0.0, 0.0, 0.0};
    true_scatter(sigma, correlation, checker, type);
    for (int half = 0; half < 2; half++) {
        TRY(respond(response[half], &expected->f_nl[half], checker->truth->power[half], checker, sigma[half]));
    }
    for (size_t b = 0; b < checker->constraints->bias_bins; b++) {
        sums[0] += response[0][b] * response[0][b];
        sums[1] += response[0][b] * response[1][b] * correlation[b];
        sums[2] += response[1][b] * response[1][b];
    }
    expected->sigma[0] = sqrt(sums[0]);
    expected->sigma[1] = sqrt(sums[2]);
    expected->correlation = sums[1] / sqrt(sums[0] * sums[2]);
    TRY(fixpair_difference_sigma(&expected->difference, expected->sigma[1], expected->sigma[0], expected->correlation));
    return 0;
}

/* ---- Claims. */

static void check_mean(struct checker *checker, const char *type, const char *what, double mean, double error, double expected) {
    double off = (mean - expected) / error;
    checker->failures += claim(fabs(off) < TOLERANCE, "%-13s %-22s %8.3f +- %.3f, %8.3f expected: off by %.1f errors", type, what, mean,
                               error, expected, off);
}

/* `error` is relative. */
static void check_size(struct checker *checker, const char *type, const char *what, double size, double error, double expected) {
    double off = log(size / expected) / error;
    checker->failures += claim(fabs(off) < TOLERANCE, "%-13s %-22s %8.3f to %2.0f%%, %9.3f expected: off by %.1f errors", type, what, size,
                               100.0 * error, expected, off);
}

/* The mean of (sigma/true sigma)^2 over all bins, which are independent. */
static void check_scatter(struct checker *checker, int type, double *work) {
    size_t bins = checker->constraints->scatter_bins;
    double *sigma[2] = {work, work + checker->matched->bins};
    true_scatter(sigma, work + 2 * checker->matched->bins, checker, type);
    for (int h = 0; h < 2; h++) {
        double sum = 0.0, estimates = (double)checker->constraints->type[type].simulations;
        for (size_t b = 0; b < bins; b++) {
            double ratio = checker->constraints->type[type].half[h].sigma[b] / sigma[h][b];
            sum += ratio * ratio / estimates;
        }
        check_size(checker, matched_report_types[type], h == 0 ? "sigma of P, f_NL = 0" : "sigma of P, f_NL = 100", sqrt(sum / (double)bins),
                   checker->deviation_error / sqrt((double)bins), 1.0);
    }
}

static void check_fits(struct checker *checker, int type) {
    static const char *const names[2][3] = {{"R_cv, f_NL = 0", "k_soft, f_NL = 0", "f_sn, f_NL = 0"},
                                            {"R_cv, f_NL = 100", "k_soft, f_NL = 100", "f_sn, f_NL = 100"}};
    for (int h = 0; h < 2; h++) {
        const struct fixpair_suppression_fit *fit = &checker->constraints->type[type].half[h].fit;
        const struct fixpair_suppression *known = &mock_suppression[type == CONSTRAINTS_FIXED_PAIRED][h];
        const char *name = matched_report_types[type];
        if (fit->degrees == 0) continue;
        check_mean(checker, name, names[h][0], fit->value.cosmic_variance, fit->error.cosmic_variance, known->cosmic_variance);
        check_mean(checker, name, names[h][1], fit->value.softening, fit->error.softening, known->softening);
        check_mean(checker, name, names[h][2], fit->value.shot_noise, fit->error.shot_noise, known->shot_noise);
    }
}

static int check_constraints(struct checker *checker, int t) {
    const struct constraints_type *type = &checker->constraints->type[t];
    const struct expectation *expected = &checker->expected[t], *normal = &checker->expected[CONSTRAINTS_NORMAL];
    const struct fixpair_difference *d = &type->difference;
    const char *name = matched_report_types[t];
    double seeds = (double)checker->matched->seeds, error = checker->deviation_error, root = sqrt(seeds), volume, gain, loss;
    double beta = expected->correlation * expected->sigma[1] / expected->sigma[0];
    check_mean(checker, name, "<f0>", d->mean_second, d->deviation_second / root, expected->f_nl[0]);
    check_mean(checker, name, "<f1>", d->mean_first, d->deviation_first / root, expected->f_nl[1]);
    check_mean(checker, name, "<f1 - f0>", d->mean, d->error_of_mean, expected->f_nl[1] - expected->f_nl[0]);
    check_size(checker, name, "std of f0", d->deviation_second, error, expected->sigma[0]);
    check_size(checker, name, "std of f1", d->deviation_first, error, expected->sigma[1]);
    check_size(checker, name, "std of f1 - f0", d->deviation, error, expected->difference);
    /* Fisher's z, which is near to Gaussian. */
    check_mean(checker, name, "artanh(rho)", atanh(d->correlation), 1.0 / sqrt(seeds - 3.0), atanh(expected->correlation));

    /* A ratio of two variances. */
    double ratio_error = 2.0 * sqrt(2.0) * error;
    if (t != CONSTRAINTS_NORMAL) {
        TRY(fixpair_effective_volume(&volume, normal->sigma[1], 1, expected->sigma[1], type->simulations));
        check_size(checker, name, "V_eff/V", type->volume, ratio_error, volume);
        /* Of Gaussian numbers; from 41 of them a bootstrap finds its own error to 20%. */
        check_size(checker, name, "its bootstrap error", type->volume_error / type->volume, 0.2 * sqrt(41.0 / seeds), ratio_error);
    }
    TRY(fixpair_effective_volume(&volume, normal->sigma[1], 1, expected->difference, type->simulations));
    check_size(checker, name, "V_eff/V, matched", type->matched_volume, ratio_error, volume);

    /* 1 - rho^2 is known to 2 rho/sqrt(N - 1) of itself. */
    TRY(fixpair_control_variate_gain(&gain, expected->sigma[1], expected->sigma[0], expected->correlation, beta));
    TRY(fixpair_control_variate_loss(&loss, checker->matched->seeds, 1));
    check_size(checker, name, "gain of optimal beta", type->control.gain, 2.0 / sqrt(seeds - 1.0), gain / loss);
    /* Peaks of wide posteriors are not quite at f_NL, as the control supposes of those at f_NL = 0. */
    check_mean(checker, name, "f1 of optimal beta", type->control.mean, type->control.error, expected->f_nl[1] - beta * expected->f_nl[0]);
    check_mean(checker, name, "p from f1 - f0", type->p[1], type->p_deviation[1] / root, checker->choice->bias.p);
    return 0;
}

static int check(struct checker *checker, double *work) {
    for (int t = 0; t < CONSTRAINTS_FITTED; t++) TRY(expect(checker, t, work));
    for (int t = 0; t < CONSTRAINTS_TYPES; t++) check_scatter(checker, t, work);
    check_fits(checker, CONSTRAINTS_FIXED);
    check_fits(checker, CONSTRAINTS_FIXED_PAIRED);
    for (int t = 0; t < CONSTRAINTS_FITTED; t++) TRY(check_constraints(checker, t));
    return 0;
}

int mock_claims_check(const struct constraints *constraints, const struct matched *matched, const struct mock_truth *truth,
                      const struct mock_choice *choice, int *failures) {
    struct checker checker = {constraints, matched, truth, choice, 1.0 / sqrt(2.0 * ((double)matched->seeds - 1.0)), {{{0}, {0}, 0, 0}}, 0};
    double *work = memory_take_doubles(5 * matched->bins);
    if (work == NULL) return 1;
    printf("\nWhat the mocks were drawn from, and what was found\n");
    int broken = check(&checker, work);
    free(work);
    *failures += checker.failures;
    return broken;
}
