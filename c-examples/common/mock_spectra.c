#include "mock_spectra.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "linear.h"
#include "memory.h"

#define TWO_PI 6.28318530717958647692

/* The last word of Philox's counters, "mock": draws that no universe of the library shares. */
#define STREAM 0x6d6f636bu

const struct fixpair_suppression mock_suppression[2][2] = {
    {{0.141, 0.114, 1.174}, {0.110, 0.110, 1.081}},
    {{0.177, 0.224, 1.224}, {0.120, 0.156, 1.056}},
};

/*
 * How both halves of tab:rho correlate. Normal: 0.97. Fixed: 0.85 for averages of pairs, and 0.67 for differences, which makes 0.76 for one
 * simulation, the mean of both.
 */
static const double matching[2][2] = {{0.97, 0.97}, {0.85, 0.67}};

int mock_choice_init(struct mock_choice *choice) {
    memset(choice, 0, sizeof *choice);
    TRY(fixpair_bias_init(&choice->bias));
    choice->bias.b_g = 2.32;
    choice->bias.p = 0.9;
    choice->box_size = 1000.0;
    choice->density = 2.5e-4;
    choice->highest = 0.4;
    choice->f_nl[1] = 100.0;
    choice->seeds = 41;
    choice->random = 1;
    return 0;
}

/* Bins b <= |n| < b + 1, n = k L/(2 pi): mean k, modes, linear theory averaged over them. */
static int make_bins(struct matched *matched, const struct fixpair_conditions *conditions) {
    size_t bins = matched->bins, squares = (bins + 1) * (bins + 1);
    uint64_t *edges = malloc((bins + 1) * sizeof *edges), *counts = malloc(bins * sizeof *counts);
    double *length = memory_take_doubles(squares);
    int broken = edges == NULL || counts == NULL || length == NULL;
    if (!broken) {
        for (size_t b = 0; b <= bins; b++) edges[b] = (b + 1) * (b + 1);
        for (size_t square = 0; square < squares; square++) length[square] = TWO_PI / matched->box_size * sqrt((double)square);
        int32_t status = fixpair_lattice_modes(counts, edges, bins + 1);
        if (status < 0) report_status(__FILE__, __LINE__, status);
        broken = status < 0 || linear_average(matched->k, length, edges, bins + 1) != 0;
        broken = broken || linear_theory(matched->linear, edges, bins + 1, conditions) != 0;
        for (size_t b = 0; b < bins; b++) matched->modes[b] = (double)counts[b];
    }
    free(edges);
    free(counts);
    free(length);
    return broken;
}

/* Scatter of all types, and what Original and Inverted share. */
static int make_truth(struct mock_truth *truth, const struct matched *matched, const struct mock_choice *choice,
                      const struct fixpair_conditions *conditions) {
    size_t bins = matched->bins;
    memcpy(truth->matching, matching, sizeof matching);
    if ((truth->alpha = memory_take_doubles(bins)) == NULL) return 1;
    TRY(fixpair_alpha(truth->alpha, matched->k, bins, &conditions->cosmology, &conditions->linear, conditions->redshift,
                      conditions->convention));
    for (int half = 0; half < 2; half++) {
        struct fixpair_bias bias = choice->bias;
        double noise = pow(choice->box_size, 3.0) / matched->halos[half];
        double *power = truth->power[half] = memory_take_doubles(bins);
        double *normal = truth->sigma[MATCHED_NORMAL][half] = memory_take_doubles(bins);
        double *fixed = truth->sigma[MATCHED_FIXED][half] = memory_take_doubles(bins);
        double *normal_sharing = truth->sharing[MATCHED_NORMAL][half] = memory_take_doubles(bins);
        double *fixed_sharing = truth->sharing[MATCHED_FIXED][half] = memory_take_doubles(bins);
        if (power == NULL || normal == NULL || fixed == NULL || normal_sharing == NULL || fixed_sharing == NULL) return 1;
        bias.f_nl = choice->f_nl[half];
        TRY(fixpair_halo_power(power, &bias, matched->linear, truth->alpha, bins, FIXPAIR_SPECTRUM_HALO_HALO));
        TRY(fixpair_sigma_gaussian(normal, power, matched->modes, bins, noise));
        TRY(fixpair_sigma_suppressed(fixed, &mock_suppression[0][half], matched->k, power, matched->modes, bins, noise));
        TRY(fixpair_sigma_suppressed(fixed_sharing, &mock_suppression[1][half], matched->k, power, matched->modes, bins, noise));
        for (size_t b = 0; b < bins; b++) {
            /* Per simulation a pair scatters by sigma sqrt(1 + c). */
            fixed_sharing[b] = pow(fixed_sharing[b] / fixed[b], 2.0) - 1.0;
            /* Both have the |delta| of the same linear field, so that pairing does not help; shot noise is each one's own. */
            normal_sharing[b] = pow(power[b] / (power[b] + noise), 2.0);
        }
    }
    return 0;
}

/* Four numbers of a unit Gaussian (Box & Muller 1958), the same for the same place. */
static int draw(double normal[4], const struct mock_choice *choice, uint64_t seed, int amplitude, size_t b) {
    const uint32_t counter[4] = {(uint32_t)b, (uint32_t)seed, (uint32_t)amplitude, STREAM};
    const uint32_t key[2] = {(uint32_t)choice->random, (uint32_t)(choice->random >> 32)};
    uint32_t words[4];
    TRY(fixpair_philox4x32_10(words, counter, key));
    for (int i = 0; i < 4; i += 2) {
        double radius = sqrt(-2.0 * log(((double)words[i] + 0.5) / 4294967296.0));
        double angle = TWO_PI * ((double)words[i + 1] + 0.5) / 4294967296.0;
        normal[i] = radius * cos(angle);
        normal[i + 1] = radius * sin(angle);
    }
    return 0;
}

/* One bin of the four simulations of one seed and amplitude. */
static int draw_bin(struct matched *matched, const struct mock_truth *truth, const struct mock_choice *choice, size_t s, int amplitude,
                    size_t b) {
    double normal[4], average, difference;
    TRY(draw(normal, choice, matched->seed[s], amplitude, b));
    for (int half = 0; half < 2; half++) {
        average = normal[0];
        difference = normal[2];
        if (half == 1) {
            const double *rho = truth->matching[amplitude];
            average = rho[0] * normal[0] + sqrt(1.0 - rho[0] * rho[0]) * normal[1];
            difference = rho[1] * normal[2] + sqrt(1.0 - rho[1] * rho[1]) * normal[3];
        }
        double share = truth->sharing[amplitude][half][b];
        average *= sqrt(0.5 * (1.0 + share));
        difference *= sqrt(0.5 * (1.0 - share));
        double noise = pow(matched->box_size, 3.0) / matched->halos[half], whole = truth->power[half][b] + noise;
        double relative = truth->sigma[amplitude][half][b] / whole;
        for (int phase = 0; phase < 2; phase++) {
            /* A chi^2 number over its degrees of freedom, 2/relative^2 of them (Wilson & Hilferty 1931). */
            double gauss = phase == MATCHED_ORIGINAL ? average + difference : average - difference;
            double root = 1.0 - relative * relative / 9.0 + relative * gauss / 3.0;
            matched->power[amplitude][phase][half][s * matched->bins + b] = whole * root * root * root - noise;
        }
    }
    return 0;
}

int mock_draw(struct matched *matched, struct mock_truth *truth, const struct mock_choice *choice,
              const struct fixpair_conditions *conditions) {
    static int all[2][2] = {{1, 1}, {1, 1}};
    memset(truth, 0, sizeof *truth);
    memset(matched, 0, sizeof *matched);
    /* The outer edge of the last bin, (bins + 1) 2 pi/L, is `highest` or less. */
    double edges = floor(choice->highest * choice->box_size / TWO_PI);
    if (!(edges >= 5.0 && edges <= 512.0)) {
        fprintf(stderr, "%g bins of 2 pi/L below k = %g h/Mpc; between 4 and 511 can be drawn\n", edges - 1.0, choice->highest);
        return 1;
    }
    if (matched_open(matched, choice->seeds, (size_t)edges - 1, all) != 0) return 1;
    matched->box_size = choice->box_size;
    for (size_t s = 0; s < choice->seeds; s++) matched->seed[s] = s + 1;
    for (int half = 0; half < 2; half++) {
        matched->f_nl[half] = choice->f_nl[half];
        matched->halos[half] = floor(choice->density * pow(choice->box_size, 3.0) + 0.5);
    }
    if (make_bins(matched, conditions) != 0 || make_truth(truth, matched, choice, conditions) != 0) return 1;
    for (size_t s = 0; s < choice->seeds; s++) {
        for (size_t b = 0; b < matched->bins; b++) {
            if (draw_bin(matched, truth, choice, s, MATCHED_NORMAL, b) != 0) return 1;
            if (draw_bin(matched, truth, choice, s, MATCHED_FIXED, b) != 0) return 1;
        }
    }
    return 0;
}

void mock_covariance(double covariance[3], const struct mock_truth *truth, int amplitude, int paired, size_t b) {
    for (int i = 0; i < 3; i++) {
        int first = i == 2, second = i > 0;
        double sigma = truth->sigma[amplitude][first][b] * truth->sigma[amplitude][second][b];
        const double *rho = truth->matching[amplitude];
        double c = truth->sharing[amplitude][first][b], d = truth->sharing[amplitude][second][b];
        double averages = 0.5 * sqrt((1.0 + c) * (1.0 + d)) * (i == 1 ? rho[0] : 1.0);
        double differences = 0.5 * sqrt((1.0 - c) * (1.0 - d)) * (i == 1 ? rho[1] : 1.0);
        covariance[i] = sigma * (paired ? averages : averages + differences);
    }
}

void mock_truth_close(struct mock_truth *truth) {
    free(truth->alpha);
    for (int half = 0; half < 2; half++) {
        free(truth->power[half]);
        for (int amplitude = 0; amplitude < 2; amplitude++) {
            free(truth->sigma[amplitude][half]);
            free(truth->sharing[amplitude][half]);
        }
    }
    memset(truth, 0, sizeof *truth);
}
