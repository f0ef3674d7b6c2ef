/*
 * From particles that start on a lattice back to the modes of their linear density: with Zel'dovich displacements psi = x - q,
 * delta_k = -i k.psi_k is what the code that made them began with, but for its Nyquist modes. Any order of particles, any place of
 * the lattice in its cells.
 */

#ifndef LATTICE_H
#define LATTICE_H

#include <stddef.h>

#include "fixpair.h"

/*
 * Modes of the density on fft->fourier (fft->length reals) of n^3 particles, n the side of the transform; `position` are triples in [0, L].
 * Velocity triples, or NULL, give v.psi/psi.psi, velocity over displacement, in *slope.
 *
 * Particles belong to the nearest point of the lattice, so that displacements have to be below half a cell. Returns 0, or 1 after saying
 * what is wrong.
 */
int lattice_density(double *modes, double *slope, const double *position, const double *velocity, double box_size,
                    const struct fixpair_fft_f64 *fft);

#endif
