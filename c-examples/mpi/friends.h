/*
 * Friends of friends over the borders of slabs: each process labels its own particles and copies of those of others within a linking
 * length above its slab; labels that a particle has on two processes are one group. No process ever holds more than its part of the
 * particles; sums of the groups meet on rank 0.
 */

#ifndef FRIENDS_H
#define FRIENDS_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"
#include "migrate.h"
#include "slabs.h"

struct friends {
    double box_size;
    double length;        /* that links */
    double particle_mass; /* Msun/h */
    uint64_t least;       /* particles of a halo */
    uint64_t copies;      /* of the last search: particles of others that this process had */
    uint64_t pairs;       /* and pairs of labels that all processes had from all */
};

/* b = 0.2 and halos of 20 particles, of so many in all. */
int friends_init(struct friends *friends, const struct fixpair_cosmology *cosmology, double box_size, uint64_t particles_total);

/*
 * The catalogue, on rank 0, to be freed; elsewhere NULL and none. All processes call it together. Returns 0, or 1 after saying what is
 * wrong.
 */
int friends_find(struct fixpair_halo **halos, size_t *count, struct friends *friends, struct particles *particles,
                 const struct slabs *slabs);

/* The catalogue of one process that holds all particles, by the one-process functions. */
int friends_find_alone(struct fixpair_halo **halos, size_t *count, const struct friends *friends, struct particles *particles);

#endif
