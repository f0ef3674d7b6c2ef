/*
 * The linear density of a universe, made stage by stage, and its power spectrum beside theory.
 *
 * These are the first stages of fixpair_initial_conditions_f64: white modes -> potential -> f_NL -> alpha. Shell b holds the modes
 * with b <= |n| < b + 1, n = k L/(2 pi), for b = 1 .. n/2 - 1.
 */

#ifndef LINEAR_H
#define LINEAR_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"

struct linear {
    const struct fixpair_fft_f64 *fft;
    const struct fixpair_fft_f64 *fine;
    const struct fixpair_exec *exec;
    size_t n;
    size_t shells;
    uint64_t *edges;  /* shells + 1 values of |n|^2 */
    struct fixpair_binning binning;
    struct fixpair_bin *bins;
    int64_t *sums;
    size_t words;     /* of `sums` */
    size_t length;    /* of the tables by |n|^2 */
    double *factor;   /* a table by |n|^2 */
    double *work;     /* a mesh of `fine` */
    void *scratch;    /* for whichever stage runs: they leave nothing in it */
    size_t scratch_len;
};

/*
 * Memory for all that follows. `fft` is the transform of the universe, `fine` that of products. Returns 0, or 1 after saying what
 * is wrong; in both cases linear_close gives the memory back, as it does for a struct of zeros.
 */
int linear_open(struct linear *linear, const struct fixpair_fft_f64 *fft, const struct fixpair_fft_f64 *fine,
                const struct fixpair_exec *exec);

void linear_close(struct linear *linear);

/* Modes of the linear density at conditions->redshift: fft->length reals. */
int linear_density(struct linear *linear, const struct fixpair_conditions *conditions, double *modes);

/* Mean k and P of `modes` in each shell. */
int linear_measure(struct linear *linear, double box_size, const double *modes, double *k, double *power);

/*
 * The mean of a function of |n|^2 over the modes of each shell edges[s] <= |n|^2 < edges[s + 1], which are counted here without
 * the library. values[square] for all squares below the last edge; edges_len - 1 averages.
 */
int linear_average(double *average, const double *values, const uint64_t *edges, size_t edges_len);

/* P of linear theory at conditions->redshift averaged so: edges_len - 1 values, of shells that begin above 0. */
int linear_theory(double *power, const uint64_t *edges, size_t edges_len, const struct fixpair_conditions *conditions);

#endif
