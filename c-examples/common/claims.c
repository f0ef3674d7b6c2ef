#include "claims.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boltzmann.h"
#include "check.h"
#include "linear.h"
#include "memory.h"

/* Used where the table has T(k), which knows no amplitude. */
#define SIGMA8 0.8
/* In h/Mpc. Up to here P of the fixed particles is linear to 0.1%, 7 seeds say: displacements are 0.4 Mpc/h at z = 32. */
#define LINEAR_K 0.1
#define F_NL 100.0
#define TWO_PI 6.283185307179586

/* What linear theory says. Where a table is by |n|^2, n = k L/(2 pi), that is its index. */
struct theory {
    struct boltzmann_table table;
    double growth;        /* f = dlnD/dlna */
    size_t length;        /* of tables by |n|^2 */
    double *alpha;        /* by |n|^2 */
    double *skewed;       /* by |n|^2: alpha P_Phi */
    double *density;      /* by |n|^2: P = alpha^2 P_Phi */
    double *power;        /* P in narrow shells */
    double *wide_power;   /* P in wide shells */
    double *wide_alpha;   /* alpha there */
    double *wide_skewed;  /* alpha P_Phi there */
    double *bispectrum;   /* B of F_NL in squeezed triangles; 0 in the first, whose three sides are one shell */
};

static const struct spectra_result *find(const struct claims *claims, const char *name) {
    for (size_t i = 0; i < claims->files_len; i++) {
        const char *slash = strrchr(claims->files[i], '/');
        if (strcmp(slash == NULL ? claims->files[i] : slash + 1, name) == 0) return &claims->results[i];
    }
    fprintf(stderr, "claims need the file %s of 01_fixed_paired_png too\n", name);
    return NULL;
}

/* Tables by |n|^2 and their averages over the modes of each shell. */
static int fill_tables(struct theory *theory, const struct claims *claims) {
    const struct spectra_choice *choice = &claims->spectra->choice;
    const struct spectra_shells *narrow = &claims->spectra->narrow, *wide = &claims->spectra->wide;
    const struct fixpair_exec *exec = claims->spectra->exec;
    struct fixpair_conditions conditions;
    struct fixpair_growth growth;
    double a = 1.0 / (1.0 + claims->redshift), volume = pow(choice->box_size, 3.0), *amplitude = theory->density;
    /* Those of 01. */
    TRY(fixpair_conditions_init(&conditions, 0));
    conditions.linear = boltzmann_linear(&theory->table, SIGMA8);
    TRY(fixpair_growth_factors(&growth, &a, 1, &conditions.cosmology));
    theory->growth = growth.f;
    TRY(fixpair_alpha_table(theory->alpha, theory->length, choice->n, choice->box_size, &conditions.cosmology, &conditions.linear,
                            claims->redshift, conditions.convention, exec));
    TRY(fixpair_potential_amplitude_table(amplitude, theory->length, choice->n, choice->box_size, &conditions.cosmology,
                                          &conditions.linear, conditions.convention, exec));
    for (size_t i = 0; i < theory->length; i++) {
        theory->skewed[i] = volume * theory->alpha[i] * amplitude[i] * amplitude[i];
        theory->density[i] = theory->alpha[i] * theory->skewed[i];
    }
    TRY(linear_average(theory->power, theory->density, narrow->edges, narrow->count + 1));
    TRY(linear_average(theory->wide_power, theory->density, wide->edges, wide->count + 1));
    TRY(linear_average(theory->wide_alpha, theory->alpha, wide->edges, wide->count + 1));
    return linear_average(theory->wide_skewed, theory->skewed, wide->edges, wide->count + 1);
}

/*
 * B = 2 f_NL alpha_1 alpha_2 alpha_3 (P_1 P_2 + P_2 P_3 + P_3 P_1), P of Phi, averaged over triangles. It is steep in the small
 * wavenumber alone, and the larger that is the fewer triangles it closes with two modes of one shell: so these are counted for
 * each |n|^2 of it apart.
 */
static void fill_template(struct theory *theory, const struct spectra *spectra, const uint64_t *parts, const uint64_t *edges,
                          size_t sides, int *failures) {
    size_t shells = spectra->wide.count, wrong = 0;
    for (size_t s = 1; s < shells; s++) {
        double alpha = 0.0, skewed = 0.0, count = (double)spectra->counts[s];
        uint64_t sum = 0;
        for (size_t i = 0; i < sides; i++) {
            uint64_t part = parts[i * (shells - 1) + s - 1];
            alpha += (double)part / count * theory->alpha[edges[i]];
            skewed += (double)part / count * theory->skewed[edges[i]];
            sum += part;
        }
        wrong += sum != spectra->counts[s];
        theory->bispectrum[s] = 2.0 * F_NL * (2.0 * skewed * theory->wide_skewed[s] * theory->wide_alpha[s] +
                                              alpha * theory->wide_skewed[s] * theory->wide_skewed[s]);
    }
    *failures += claim(wrong == 0, "triangles counted apart for each |n|^2 of their longest wavelength add up to those of the shells");
}

/* Edges: each |n|^2 of the first shell a shell of its own, then the others as they are. */
static int count_parts(struct theory *theory, const struct spectra *spectra, int *failures) {
    const struct spectra_shells *wide = &spectra->wide;
    size_t sides = (size_t)(wide->edges[1] - wide->edges[0]), others = wide->count - 1, len = sides * others;
    struct fixpair_layout layout;
    uint64_t *edges = calloc(sides + others + 1, sizeof *edges), *parts = calloc(len + 1, sizeof *parts);
    uint32_t *triangles = calloc(3 * len + 1, sizeof *triangles);
    void *scratch = NULL;
    int32_t outcome = edges == NULL || parts == NULL || triangles == NULL;
    for (size_t i = 0; outcome == 0 && i < sides; i++) {
        for (size_t s = 0; s < others; s++) {
            uint32_t *triangle = triangles + 3 * (i * others + s);
            triangle[0] = (uint32_t)i;
            triangle[1] = triangle[2] = (uint32_t)(sides + s);
        }
    }
    if (outcome == 0) outcome = fixpair_edges_exact(edges, sides + 1, wide->edges[0]);
    if (outcome == 0) {
        memcpy(edges + sides, wide->edges + 1, (others + 1) * sizeof *edges);
        outcome = fixpair_triangle_counts_scratch(&layout, triangles, len, edges, sides + others + 1, spectra->choice.n);
    }
    if (outcome == 0) outcome = (scratch = memory_take(layout)) == NULL;
    if (outcome == 0) {
        outcome = fixpair_triangle_counts(parts, triangles, len, edges, sides + others + 1, spectra->choice.n, scratch, layout.size,
                                          spectra->exec);
    }
    if (outcome == 0) fill_template(theory, spectra, parts, edges, sides, failures);
    free(edges);
    free(parts);
    free(triangles);
    free(scratch);
    TRY(outcome);
    return 0;
}

static int theory_open(struct theory *theory, const struct claims *claims) {
    size_t narrow = claims->spectra->narrow.count, wide = claims->spectra->wide.count;
    TRY(boltzmann_read(&theory->table, claims->table));
    TRY(fixpair_mode_table_length(&theory->length, claims->spectra->choice.n));
    theory->alpha = memory_take_doubles(3 * theory->length + narrow + 4 * wide);
    if (theory->alpha == NULL) return 1;
    theory->skewed = theory->alpha + theory->length;
    theory->density = theory->skewed + theory->length;
    theory->power = theory->density + theory->length;
    theory->wide_power = theory->power + narrow;
    theory->wide_alpha = theory->wide_power + wide;
    theory->wide_skewed = theory->wide_alpha + wide;
    theory->bispectrum = theory->wide_skewed + wide;
    return fill_tables(theory, claims);
}

static void theory_close(struct theory *theory) {
    boltzmann_close(&theory->table);
    free(theory->alpha);
}

/* Where theory is linear and the mesh fine enough to show it: below 2 pi/(8 H) images add less than 0.1%. */
static double linear_k(const struct spectra *spectra) {
    return fmin(LINEAR_K, TWO_PI / spectra->choice.box_size * (double)spectra->choice.n / 8.0);
}

/* How many narrow shells lie there. */
static size_t linear_shells(const struct spectra *spectra) {
    size_t count = 0;
    double k_f = TWO_PI / spectra->choice.box_size;
    while (count < spectra->narrow.count && spectra->narrow.bins[count].first * k_f < linear_k(spectra)) count++;
    return count;
}

static int check_power(const struct claims *claims, const struct theory *theory, int *failures) {
    const struct spectra_result *normal = find(claims, "normal_original_fnl0"), *original = find(claims, "fixed_original_fnl0"),
                                *inverted = find(claims, "fixed_inverted_fnl0");
    const struct spectra_shells *narrow = &claims->spectra->narrow;
    size_t shells = linear_shells(claims->spectra);
    double highest = linear_k(claims->spectra), chi_square = 0.0, worst = 0.0, single = 0.0, pair = 0.0;
    if (normal == NULL || original == NULL || inverted == NULL) return 1;
    for (size_t s = 0; s < shells; s++) {
        double first = original->power[3 * s] / theory->power[s] - 1.0, second = inverted->power[3 * s] / theory->power[s] - 1.0;
        double scatter = normal->power[3 * s] / theory->power[s] - 1.0, modes = (double)narrow->bins[s].count;
        worst = fmax(worst, fmax(fabs(first), fabs(second)));
        single += modes * 0.5 * (first * first + second * second);
        pair += modes * 0.25 * (first + second) * (first + second);
        chi_square += scatter * scatter * modes / 2.0;
    }
    /* The variance of P is 2 P^2/modes; that of chi^2 is twice the shells. */
    double sigmas = (chi_square - (double)shells) / sqrt(2.0 * (double)shells);
    *failures += claim(fabs(sigmas) < 4.0, "k < %.3f: P_0 of the normal particles scatters as 2 P^2/modes says: chi^2 = %.1f of %lu", highest,
                       chi_square, (unsigned long)shells);
    *failures += claim(worst < 0.005, "k < %.3f: P_0 of the fixed particles is that of linear theory, to %.2f%% in each shell", highest,
                       100.0 * worst);
    /* What is left of the mean is even: the square of second order. Of 7 seeds: 5 to 10 times. */
    *failures += claim(9.0 * pair < single,
                       "the pair's mean is nearer to it than its members, in the r.m.s. %.1f times: what is odd cancels", sqrt(single / pair));
    return 0;
}

/*
 * (2l + 1) <(1 + f mu^2)^2 L_l(mu)>, l = 0, 2, 4, of Kaiser (1987), P over the mean of its shell being a mode's weight. A sum over the very
 * modes of the first shells: too few to fill a sphere evenly.
 */
static void kaiser_multipoles(double *multipoles, const struct theory *theory, long shells) {
    double modes = 0.0, sums[3] = {0.0, 0.0, 0.0};
    for (long i = -shells; i <= shells; i++) {
        for (long j = -shells; j <= shells; j++) {
            for (long l = -shells; l <= shells; l++) {
                long square = i * i + j * j + l * l;
                if (square == 0 || square >= (shells + 1) * (shells + 1)) continue;
                double mu2 = (double)(l * l) / (double)square;
                double weight = theory->density[square] / theory->power[(size_t)sqrt((double)square) - 1];
                double power = weight * pow(1.0 + theory->growth * mu2, 2.0);
                modes += 1.0;
                sums[0] += power;
                sums[1] += 5.0 * power * (3.0 * mu2 - 1.0) / 2.0;
                sums[2] += 9.0 * power * ((35.0 * mu2 - 30.0) * mu2 + 3.0) / 8.0;
            }
        }
    }
    for (size_t l = 0; l < 3; l++) multipoles[l] = sums[l] / modes;
}

/* Fixed moduli: P of linear theory in each mode, times (1 + f mu^2)^2. */
static int check_redshift_space(const struct claims *claims, const struct theory *theory, int *failures) {
    const struct spectra_result *original = find(claims, "fixed_original_fnl0"), *inverted = find(claims, "fixed_inverted_fnl0");
    size_t shells = linear_shells(claims->spectra);
    double kaiser[3], sums[3] = {0.0, 0.0, 0.0}, modes = 0.0;
    if (original == NULL || inverted == NULL) return 1;
    kaiser_multipoles(kaiser, theory, (long)shells);
    for (size_t s = 0; s < shells; s++) {
        double count = (double)claims->spectra->narrow.bins[s].count;
        modes += count;
        for (size_t l = 0; l < 3; l++) {
            sums[l] += 0.5 * count * (original->power[3 * s + l] + inverted->power[3 * s + l]) / theory->power[s];
        }
    }
    for (size_t l = 0; l < 3; l++) {
        double ratio = sums[l] / modes;
        /* As in real space. */
        *failures += claim(fabs(ratio - kaiser[l]) < 0.005, "k < %.3f, redshift space: P_%lu/P = %.4f, Kaiser's %.4f with f = %.4f",
                           linear_k(claims->spectra), (unsigned long)(2 * l), ratio, kaiser[l], theory->growth);
    }
    return 0;
}

/* f_NL by least squares from B, which for Gaussian fields has the variance 2 L^3 P P P/triangles where two sides share a shell. */
static double fit(const struct spectra *spectra, const struct theory *theory, const double *bispectrum, double *sigma) {
    double top = 0.0, bottom = 0.0;
    for (size_t s = 1; s < spectra->wide.count; s++) {
        double power = theory->wide_power[0] * theory->wide_power[s] * theory->wide_power[s];
        double variance = 2.0 * pow(spectra->choice.box_size, 3.0) * power / (double)spectra->counts[s];
        top += bispectrum[s] * theory->bispectrum[s] / variance;
        bottom += theory->bispectrum[s] * theory->bispectrum[s] / variance;
    }
    *sigma = F_NL / sqrt(bottom);
    return F_NL * top / bottom;
}

static int check_bispectrum(const struct claims *claims, const struct theory *theory, int *failures) {
    const struct spectra_result *skewed[2] = {find(claims, "fixed_original_fnl100"), find(claims, "fixed_inverted_fnl100")};
    const struct spectra_result *plain[2] = {find(claims, "fixed_original_fnl0"), find(claims, "fixed_inverted_fnl0")};
    size_t shells = claims->spectra->wide.count, negative = 0;
    double sigma, *difference = memory_take_doubles(shells), k_f = TWO_PI / claims->spectra->choice.box_size;
    if (difference == NULL || skewed[0] == NULL || skewed[1] == NULL || plain[0] == NULL || plain[1] == NULL) {
        free(difference);
        return 1;
    }
    printf("\n%10s %14s %14s %14s\n", "k h/Mpc", "B, f_NL = 100", "less f_NL = 0", "template");
    for (size_t s = 1; s < shells; s++) {
        for (int i = 0; i < 2; i++) difference[s] += 0.5 * (skewed[i]->bispectrum[s] - plain[i]->bispectrum[s]);
        negative += !(difference[s] > 0.0);
        printf("%10.4f %14.1f %14.1f %14.1f\n", k_f * claims->spectra->wide.bins[s].first, skewed[0]->bispectrum[s], difference[s],
               theory->bispectrum[s]);
    }
    printf("\n");
    double matched = fit(claims->spectra, theory, difference, &sigma);
    double alone = fit(claims->spectra, theory, skewed[0]->bispectrum, &sigma);
    free(difference);
    *failures += claim(negative == 0, "f_NL = 100 less f_NL = 0, mean of the pair: the squeezed B is positive in all triangles");
    /* From seed to seed 2% of f_NL: noise of the modes of Phi other than the long wavelength's. */
    *failures += claim(fabs(matched / F_NL - 1.0) < 0.1,
                       "it fits the template with f_NL = %.1f, to 10%%; B of one universe alone says %.0f +- %.0f",
                       matched, alone, sigma);
    return 0;
}

int claims_ready(const struct claims *claims) {
    static const char *const names[] = {"fixed_original_fnl0", "fixed_inverted_fnl0", "normal_original_fnl0", "fixed_original_fnl100",
                                        "fixed_inverted_fnl100"};
    struct boltzmann_table table;
    int missing = boltzmann_read(&table, claims->table);
    boltzmann_close(&table);
    for (size_t i = 0; i < (claims->redshift_space ? 2 : 5); i++) missing += find(claims, names[i]) == NULL;
    return missing != 0;
}

int claims_check(const struct claims *claims, int *failures) {
    struct theory theory;
    memset(&theory, 0, sizeof theory);
    int outcome = theory_open(&theory, claims);
    if (outcome == 0 && claims->redshift_space) {
        outcome = check_redshift_space(claims, &theory, failures);
    } else if (outcome == 0) {
        outcome = check_power(claims, &theory, failures) != 0 || count_parts(&theory, claims->spectra, failures) != 0 ||
                  check_bispectrum(claims, &theory, failures) != 0;
    }
    theory_close(&theory);
    return outcome;
}
