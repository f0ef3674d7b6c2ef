/*
 * Who holds which planes: a mesh of n planes along x dealt out to the processes of a communicator in the order of their ranks, as FFTW-MPI
 * does. A process may have none.
 */

#ifndef SLABS_H
#define SLABS_H

#include <mpi.h>
#include <stddef.h>

#include "fixpair.h"

struct slabs {
    MPI_Comm comm;
    int rank, ranks;
    size_t n;
    size_t *first; /* ranks + 1: rank r holds planes first[r] .. first[r + 1] - 1 */
};

/*
 * `planes`: how many this process holds. All call it together. Returns 0, or 1 after saying what is wrong; in both cases slabs_close
 * gives the memory back, as it does for a struct of zeros.
 */
int slabs_open(struct slabs *slabs, MPI_Comm comm, size_t n, size_t planes);

void slabs_close(struct slabs *slabs);

size_t slabs_planes(const struct slabs *slabs, int rank);

/* Whose plane it is, by bisection. */
int slabs_owner(const struct slabs *slabs, size_t plane);

/* Whose slab holds x, in [0, box_size). */
int slabs_owner_of(const struct slabs *slabs, double x, double box_size);

/* The cells of a process, rows of n + 2 reals; returns what fixpair_brick_slab does. */
int32_t slabs_brick(struct fixpair_brick *brick, const struct slabs *slabs, int rank);

#endif
