/*
 * A picture of matter: the density along a line of sight in colours that go with its logarithm, as a PPM file, which most viewers
 * open and `convert` turns into any other format.
 *
 * Particles are few for so many pixels. But they started from a lattice, and what was between them there is between them still: the
 * sheet of dark matter in phase space is continuous (Abel, Hahn & Kaehler 2012, arXiv:1111.3944). So each cube of the lattice is
 * filled with points that move as its corners do, and those are drawn: without grain, and with folds where streams cross.
 */

#ifndef PICTURE_H
#define PICTURE_H

#include <stddef.h>

#include "fixpair.h"

struct picture {
    size_t side;          /* pixels */
    size_t n;             /* particles on a side: position[(x n + y) n + z] of lattice point (x, y, z) */
    double box_size;
    double bottom, depth; /* of the slab that is seen from above: z in [bottom, bottom + depth) */
};

/* Returns 0, or 1 after saying what is wrong. */
int picture_write(const struct picture *picture, const struct fixpair_positions_f32 *position, const char *path);

#endif
