/* The files that the parameter files of this folder name, made from a table of CAMB. */

#ifndef INPUTS_H
#define INPUTS_H

/*
 * Writes into `folder`: input_spectrum.dat (log10 k, log10 Delta^2), input_transfer.dat (k, T), glass1 (one particle at the
 * corner of its tile) and glass8 (eight, off the corners of a lattice). Returns 0, or 1 after saying what is wrong.
 */
int inputs_write(const char *table, const char *folder);

#endif
