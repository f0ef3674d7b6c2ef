/* P(k) of modes that processes share: sums are integers, so that they are the same for any number of processes if the modes are. */

#ifndef SPECTRUM_H
#define SPECTRUM_H

#include <mpi.h>
#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"

struct spectrum {
    MPI_Comm comm;
    struct fixpair_brick modes;
    size_t shells; /* b <= |n| < b + 1, n = k L/(2 pi), for b = 1 .. shells */
    uint64_t *edges;
    struct fixpair_binning binning;
    struct fixpair_bin *bins;
    int64_t *sums;
    size_t words;
    void *scratch;
    size_t scratch_len;
    double *power; /* of what was measured last, in (Mpc/h)^3 */
};

/*
 * For modes on a brick, n/2 - 1 shells. Returns 0, or 1 after saying what is wrong; in both cases spectrum_close gives the memory back, as
 * it does for a struct of zeros.
 */
int spectrum_open(struct spectrum *spectrum, MPI_Comm comm, const struct fixpair_brick *modes);

void spectrum_close(struct spectrum *spectrum);

/*
 * All processes call it together, and all get the whole. `factor`: as for fixpair_binning_normalise; `compensation`:
 * FIXPAIR_COMPENSATION_...
 */
int spectrum_measure(struct spectrum *spectrum, const double *modes, size_t len, int32_t compensation, double factor);

#endif
