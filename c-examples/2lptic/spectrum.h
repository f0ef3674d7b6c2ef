/*
 * The linear spectrum that a parameter file asks for, as the library takes it.
 *
 *   WhichSpectrum   spectrum of z = 0, times k^PrimordialIndex over what is in the table or the fit already
 *   0               k^n T^2. WhichTransfer 1: T of Eisenstein & Hu, 2: a table of k and T, in any unit
 *   1               k^n T^2 with the fit of Eisenstein & Hu (1998) without wiggles, T_cmb = 2.728 K
 *   2               a table of log10 k and log10 Delta^2, Delta^2 = k^3 P/(2 pi^2), times k^(n - 1)
 *   others          k^n T^2 with the fit of Efstathiou, Bond & White (1992), shape parameter Gamma
 *
 * k of tables is in h over InputSpectrum_UnitLength_in_cm. Between rows logarithms are interpolated linearly, and all are
 * normalised to Sigma8, unless ReNormalizeInputSpectrum is 0: then the table is P at the starting redshift.
 *
 * The library interpolates tables by cubics. It is given rows at the very wavenumbers of the mesh, so that each mode has the
 * power that those codes give it; rows between and beyond serve what else needs a spectrum.
 */

#ifndef SPECTRUM_H
#define SPECTRUM_H

#include <stddef.h>

#include "fixpair.h"
#include "parameters.h"

struct spectrum {
    const struct parameters *parameters;
    double *table_k, *table_value; /* log10 k and log10 Delta^2, or log10 k and log10 T; increasing */
    size_t table_rows;
    double factor; /* from the shape to P */
    double *k, *power; /* for the library */
    size_t rows;
};

/*
 * Reads, normalises and samples a spectrum. `growth` is D of the starting redshift. Returns 0, or 1 after saying what is wrong;
 * in both cases spectrum_close gives the memory back, as it does for a struct of zeros.
 */
int spectrum_open(struct spectrum *spectrum, const struct parameters *parameters, double growth);

void spectrum_close(struct spectrum *spectrum);

/* P of z = 0 as those codes interpolate it, k in h/Mpc, P in (Mpc/h)^3; of a table or the fit by Gamma alone. */
double spectrum_power(const struct spectrum *spectrum, double k);

/* As the library takes it, valid until spectrum_close. */
struct fixpair_linear spectrum_linear(const struct spectrum *spectrum);

#endif
