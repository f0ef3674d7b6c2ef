/*
 * The power spectrum of particles in single precision, beside linear theory: two interlaced deposits, shells b <= |n| < b + 1,
 * n = k L/(2 pi), for b = 1 .. n/4 of a mesh of n cells a side, where what aliasing is left is far below the signal. Shot noise is not
 * subtracted: particles that start from a lattice have none at first.
 */

#ifndef MATTER_H
#define MATTER_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"

struct matter {
    const struct fixpair_fft_f32 *fft;
    const struct fixpair_exec *exec;
    size_t shells;
    uint64_t *edges; /* shells + 1 values of |n|^2 */
    struct fixpair_binning binning;
    struct fixpair_bin *bins;
    int64_t *sums;
    size_t words;
    float *mesh, *shifted;
    void *scratch;
    size_t scratch_len;
    double *k, *power, *theory; /* a value a shell, of what was measured last */
};

/*
 * Memory for any number of catalogues. `fft` may be one that something else uses too, but not at the same time. Returns 0, or 1 after
 * saying what is wrong; in both cases matter_close gives the memory back, as it does for a struct of zeros.
 */
int matter_open(struct matter *matter, const struct fixpair_fft_f32 *fft, size_t particles, const struct fixpair_exec *exec);

void matter_close(struct matter *matter);

/* Particles of the universe of `conditions` at conditions->redshift. */
int matter_measure(struct matter *matter, const struct fixpair_positions_f32 *position, const struct fixpair_conditions *conditions);

/* A table with commented columns. */
int matter_write(const struct matter *matter, const char *path);

#endif
