/*
 * What matched spectra of halos say of f_NL, and what fixing, pairing and matching are worth: Avila & Adame 2022 (arXiv:2204.11103), from
 * the scatter of spectra (tab:fits) to the table of f_NL (tab:rho).
 *
 * An estimate is what is independent of the others: a simulation, or the average of a pair, which costs two.
 */

#ifndef CONSTRAINTS_H
#define CONSTRAINTS_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"
#include "matched.h"

/* Types: those that f_NL is fitted to, and one that has no advantage, as its scatter shows. */
enum { CONSTRAINTS_NORMAL, CONSTRAINTS_FIXED, CONSTRAINTS_FIXED_PAIRED, CONSTRAINTS_NORMAL_PAIRED, CONSTRAINTS_TYPES };
enum { CONSTRAINTS_FITTED = CONSTRAINTS_NORMAL_PAIRED }; /* how many of them */
enum { CONSTRAINTS_BLOCKS = 1 + 16 * CONSTRAINTS_TYPES }; /* of memory, at most */

struct constraints_choice {
    struct fixpair_cosmology cosmology;
    struct fixpair_linear linear;
    double redshift;        /* of the halos */
    int32_t convention;     /* of f_NL: FIXPAIR_CONVENTION_... */
    double highest_scatter; /* k in h/Mpc below which sigma_r is fitted to the scatter */
    double highest_bias;    /* k in h/Mpc up to which f_NL is fitted */
    int measured;           /* fit f_NL with the measured scatter, not with sigma_th and the fits of sigma_r */
};

/* k < 0.4 h/Mpc, k <= 0.09 h/Mpc, z = 1, CMB convention, GOLIAT cosmology. `linear` is left to fill in. */
int constraints_choice_init(struct constraints_choice *choice);

/* Of one type and half; a value a bin or an estimate. */
struct constraints_half {
    const double *samples;  /* P: a row an estimate */
    double *mean;           /* P over all simulations, original and inverted */
    double *theory;         /* sigma_th for that P */
    double *sigma, *error;  /* scatter per simulation */
    struct fixpair_suppression_fit fit; /* of fixed types, unless `measured` */
    double *used;           /* sigma of one estimate that f_NL is fitted with */
    double *f_nl, *b_g;     /* peaks of the posteriors of each estimate: case (iii), p = 1 */
    struct fixpair_posterior on_mean; /* of f_NL, for the mean P with the sigma of one estimate */
};

struct constraints_type {
    int present;
    uint64_t simulations;   /* that one estimate costs */
    struct constraints_half half[2];
    struct fixpair_difference difference; /* f100 - f0 */
    double gauss, gauss_sigma;            /* the difference of both on_mean, and its scatter by Eq. correlation */
    /* V_eff/V over a Normal simulation that is not matched, by the scatter of f_NL, with its error, and by on_mean; NAN without Normal. */
    double volume, volume_error, volume_on_mean;                         /* f100 */
    double matched_volume, matched_volume_error, matched_volume_on_mean; /* the difference */
    struct fixpair_control_variate control; /* f100 less the optimal beta times f0 */
    double difference_gain;                 /* beta = 1 */
    double p[2], p_deviation[2];            /* of estimates of Eq. p: from f100, [0], and from the difference, [1] */
};

struct constraints {
    struct constraints_type type[CONSTRAINTS_TYPES];
    double *alpha;
    size_t scatter_bins, bias_bins; /* how many of the bins, from the first on, each fit takes */
    void *blocks[CONSTRAINTS_BLOCKS]; /* of memory */
    size_t blocks_len;
};

/*
 * The whole chain. `matched` must outlive the result. Returns 0, or 1 after saying what is wrong; constraints_close gives the memory back
 * in both cases.
 */
int constraints_find(struct constraints *constraints, const struct matched *matched, const struct constraints_choice *choice);

/* Posterior peaks of f_NL and b_g, and the posterior of f_NL, for one spectrum with its sigma. */
int constraints_fit(double *f_nl, double *b_g, struct fixpair_posterior *posterior, const double *power, const double *sigma,
                    const double *linear, const double *alpha, size_t bins);

void constraints_close(struct constraints *constraints);

#endif
