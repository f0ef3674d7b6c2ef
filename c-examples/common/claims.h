/*
 * What matched universes promise of the spectra of their particles: the files of 01_fixed_paired_png, early, where theory is
 * linear.
 *
 * In real space the five files normal_original_fnl0 and fixed_*_fnl0 and fixed_*_fnl100 are compared, in redshift space
 * fixed_*_fnl0. Tolerances are for meshes of twice the particles on a side, interlaced, with PCS. (Particles from a lattice have
 * images in step with the signal. Interlacing removes the odd ones. The even ones cancel to (k H)^4 with windows of even order;
 * with TSC they add 1% to P at k = 0.1 h/Mpc in this box.)
 */

#ifndef CLAIMS_H
#define CLAIMS_H

#include <stddef.h>

#include "spectra.h"

struct claims {
    const struct spectra *spectra;
    const struct spectra_result *results; /* one for each file */
    char **files;                         /* paths; the last part is the name that 01 gives */
    size_t files_len;
    double redshift;
    int redshift_space;
    const char *table; /* linear spectrum that 01 was given */
};

/* Before anything is measured: are the table and the files there? Returns 0, or 1 after saying what is wrong. */
int claims_ready(const struct claims *claims);

/*
 * Prints claims and adds those that fail to *failures. Returns 0, or 1 after saying what is wrong: a file that is not there, for
 * instance.
 */
int claims_check(const struct claims *claims, int *failures);

#endif
