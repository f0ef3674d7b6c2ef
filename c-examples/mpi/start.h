/* Particles at the start: what each process makes of its part of one universe, or one process of the whole. */

#ifndef START_H
#define START_H

#include "fixpair.h"
#include "migrate.h"

/*
 * One call of the library. The particles of the cells of fft->configuration, numbered over the whole box; `particles` is opened here. On
 * several processes all call it together. Returns 0, or 1 after saying what is wrong; particles_close gives the memory back in both cases.
 *
 * Products are taken on the mesh itself, where at second order, and with f_nl or g_nl, they alias: a process's slabs of a finer mesh of
 * FFTW-MPI's do not hold the modes that it has of this one.
 */
int start_particles(struct particles *particles, const struct fixpair_conditions *conditions, const struct fixpair_fft_f64 *fft);

#endif
