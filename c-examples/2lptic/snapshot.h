/*
 * Gadget files of format 1, named and dealt out as 2LPTic does: FileBase for one file, else FileBase.0, FileBase.1 ..., file i of
 * m holding the particles that stood in the planes i ceil(Nmesh/m) to (i + 1) ceil(Nmesh/m) - 1 of the mesh before they were
 * displaced.
 *
 * Particles are of type 1, velocities the peculiar ones over sqrt(a), all in the units of the parameter file. Masses are Omega of
 * the critical density with the G of 2LPTic and Gadget-2, 6.672e-8 cm^3/g/s^2, with which Gadget-2 checks them.
 */

#ifndef SNAPSHOT_H
#define SNAPSHOT_H

#include <stddef.h>

#include "glass.h"
#include "parameters.h"

/*
 * Writes particles in Mpc/h and km/s, triples in the order of `glass`, to `files` files in OutputDir; those that would be empty
 * are left out. Ids have 4 bytes where they fit a signed number, else 8, or 8 if `long_ids` is not 0. Returns 0, or 1 after
 * saying what is wrong.
 */
int snapshot_write(const struct parameters *parameters, const struct glass *glass, const double *position, const double *velocity,
                   size_t files, int long_ids);

/* Writes inputspec_FileBase.txt: redshift and 1/D in the first line, then k and Delta^2 of z = 0 in the units of the parameter file. */
struct fixpair_conditions;
int snapshot_write_spectrum(const struct parameters *parameters, const struct fixpair_conditions *conditions, double growth);

#endif
