/*
 * The modes of 2LPTic, N-GenIC and their kin, drawn mode by mode as those codes do it, with nothing of the library but, if asked
 * for, its ranlxd1. Slow, and there to be compared with.
 */

#ifndef SCHEME_H
#define SCHEME_H

#include <stddef.h>
#include <stdint.h>

/* The first `len` numbers of ranlxd1 of a seed. Returns 0, or 1 after saying what is wrong. */
typedef int scheme_generator(double *uniforms, size_t len, uint64_t seed);

struct scheme {
    size_t n;
    size_t sample; /* Nsample */
    double box;    /* in the unit of the parameter file: it decides how wavenumbers are rounded */
    int sphere, fixed, flip;
    uint64_t seed;
    scheme_generator *generator;
    const double *amplitude; /* sqrt(P/V) by |n|^2, up to 3 (n/2)^2 */
};

/*
 * Modes of the linear density, as (re, im) at 2 ((i n + j)(n/2 + 1) + l): n^2 (n + 2) numbers. Those that the codes leave out are
 * 0. Returns 0, or 1 after saying what is wrong.
 */
int scheme_density(const struct scheme *scheme, double *modes);

/*
 * Zel'dovich displacement at a corner of the mesh, cell by cell: sum over both members of each pair of i k/k^2 delta_k exp(i
 * k.q), by adding them all up.
 */
void scheme_displacement(double psi[3], const double *modes, size_t n, double box, const size_t corner[3]);

/* ranlxd1 of the library. */
scheme_generator scheme_ranlxd1;

#endif
