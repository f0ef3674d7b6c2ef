/*
 * What fixpair_evolve_f32 does, kernel by kernel: the loop that a host writes who has its own particles, its own order of things, or
 * more than one process. Here it has the bits of fixpair_evolve_f32.
 */

#ifndef BY_HAND_H
#define BY_HAND_H

#include "simulation.h"

/* From the first scale factor to the last, without outputs. Returns 0, or 1 after saying what is wrong. */
int by_hand_evolve(struct simulation *run);

#endif
