/*
 * Spectra of halos of matched simulations: Normal and Fixed, Original and Inverted, of the same seeds at two values of f_NL; and the text
 * table that holds them, one row a simulation and bin:
 *
 *     seed,amplitude,phase,f_NL,k [h/Mpc],modes,linear P [(Mpc/h)^3],P of halos less shot noise [(Mpc/h)^3],halos
 *     7,fixed,original,100,0.0089,26,24012.5,139870.2,250134
 *
 *     amplitude   normal or fixed
 *     phase       original or inverted
 *     modes       in the bin, counting k and -k
 *     linear P    of matter at the redshift of the halos, averaged over the modes
 *     halos       in the box
 *
 * Columns and rows may be in any order, and there may be more columns (see columns.h): power_z1.csv of the example goliat is such a table.
 * A table may come in several files, each with its first line.
 */

#ifndef MATCHED_H
#define MATCHED_H

#include <stddef.h>
#include <stdint.h>

enum { MATCHED_NORMAL, MATCHED_FIXED };
enum { MATCHED_ORIGINAL, MATCHED_INVERTED };

extern const char *const matched_amplitudes[2], *const matched_phases[2];

struct matched {
    double box_size;    /* Mpc/h */
    size_t seeds, bins; /* how many */
    uint64_t *seed;     /* increasing */
    double f_nl[2];     /* of the halves that are matched: 0, and the other */
    double *k;          /* h/Mpc, mean of the modes of each bin, increasing */
    double *modes;
    double *linear;     /* (Mpc/h)^3 */
    double halos[2];    /* in the box, the mean over each half's simulations */
    /* By amplitude, phase and half: a row a seed, a column a bin; NULL where there are none. Both halves are there, or neither. */
    double *power[2][2][2];
};

/* Memory for everything, with power where `present` says so. Returns 0, or 1 after saying that there is none left. */
int matched_open(struct matched *matched, size_t seeds, size_t bins, int present[2][2]);

/* Gives the memory back, as of a struct of zeros. */
void matched_close(struct matched *matched);

/*
 * Reads a table. Every type that is there must have every seed at both f_NL: one that is missing would break pairs or matches. Returns 0,
 * or 1 after saying what is wrong; matched_close in both cases.
 */
int matched_read(struct matched *matched, char *const *paths, size_t paths_len, double box_size);

/* Writes one, with digits enough to read the same numbers back. Returns 0, or 1 after saying what is wrong. */
int matched_write(const struct matched *matched, const char *path);

#endif
