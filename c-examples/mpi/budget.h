/*
 * What a run takes of each process, by formula: memory, and bytes sent in a step. Beside what a run took, and for one that does not fit
 * here.
 *
 * n particles and m = B n cells on a side; R processes, p = m/R planes each, d ghost planes before and after the slab together; w bytes a
 * real, s bytes a particle.
 */

#ifndef BUDGET_H
#define BUDGET_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "fftw_slabs.h"
#include "pm.h"

/* Bytes that this process sends in one transform: w p (m - p) (m + 2) with modes in slabs of y, twice that with modes in slabs of x. */
uint64_t budget_transform(const struct fftw_slabs *fft);

/* Bytes that this process sends to fold its ghosts once and to fill those of others three times: w d m (m + 2) each. */
uint64_t budget_ghosts(const struct ghosts *ghosts);

/*
 * The share of all particles that cross a border while the growth factor goes from D0 to D1, in linear theory: (R/L) <|psi_x|> (D1 - D0),
 * psi the displacement over D; 0 on one process.
 */
double budget_moved(const struct slabs *slabs, double box_size, double mean_displacement, double growth);

/*
 * The table for n particles a side in a box on so many processes, in single and double precision. The
 * cosmology is that of fixpair_conditions_init. Returns 0, or 1 after saying what is wrong.
 */
int budget_print(FILE *stream, size_t n, size_t mesh_factor, size_t ranks, double box_size);

#endif
