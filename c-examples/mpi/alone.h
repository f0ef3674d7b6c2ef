/*
 * The same universe on one process: the built-in transform, the one-call functions of the library, no MPI. What runs on several are
 * compared with. Small universes only: every process gets a copy.
 */

#ifndef ALONE_H
#define ALONE_H

#include <mpi.h>
#include <stddef.h>

#include "fixpair.h"
#include "universe.h"

struct alone {
    size_t particles, shells, scale_factors;
    double *position, *velocity; /* triples, by id */
    double *power;               /* a spectrum for each scale factor */
    struct fixpair_halo *halos;  /* on rank 0 alone */
    size_t halos_len;
};

/* Initial conditions, and P(k) of their linear density. Rank 0 makes them, all get them. alone_close takes a struct of zeros too. */
int alone_begin(struct alone *alone, const struct universe *universe, MPI_Comm comm);

/* The run to its end by fixpair_evolve_f64, with P(k) of the particles at each scale factor, and halos. */
int alone_run(struct alone *alone, const struct universe *universe, MPI_Comm comm);

void alone_close(struct alone *alone);

/* Distances of particles with ids from those of `alone`: the largest on this process of a coordinate and of a velocity. */
struct particles;
void alone_compare(double *apart, double *faster, const struct alone *alone, const struct particles *particles, double box_size);

/* P(k) of the linear density: also for slabs. `power`: n/2 - 1 values. All processes of `comm` call it together. */
int linear_spectrum(double *power, const struct universe *universe, const struct fixpair_fft_f64 *fft, MPI_Comm comm);

#endif
