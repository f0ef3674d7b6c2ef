/*
 * Tables of Boltzmann codes, made ready for fixpair_linear. The number of columns tells which:
 *
 *   columns  file                                                  read
 *   2        CAMB ..._matterpower.dat, CLASS ..._pk.dat: k, P       P
 *   5        examples/data/camb_goliat_linear.txt: k, T, P(z = 0)...  P(z = 0)
 *   7, 13    CAMB ..._transfer_out.dat, older and newer             T of all matter, column 7
 *
 * k in h/Mpc, P in (Mpc/h)^3, T in any unit. Spectra must be those of z = 0: CLASS writes the redshift in its header, and
 * another is refused; CAMB does not. Lines may be blank, and everything after # is a comment.
 */

#ifndef BOLTZMANN_H
#define BOLTZMANN_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"

struct boltzmann_table {
    double *k;
    double *value;
    size_t rows;
    int32_t source; /* FIXPAIR_LINEAR_POWER or FIXPAIR_LINEAR_TRANSFER */
};

/*
 * Reads a file. Returns 0, or 1 after printing path:line: and what is wrong there; in both cases boltzmann_close gives the
 * memory back, as it does for a struct of zeros.
 */
int boltzmann_read(struct boltzmann_table *table, const char *path);

void boltzmann_close(struct boltzmann_table *table);

/* The spectrum as the library takes it, valid until boltzmann_close. P is taken as it is; T is normalised to sigma8. */
struct fixpair_linear boltzmann_linear(const struct boltzmann_table *table, double sigma8);

#endif
