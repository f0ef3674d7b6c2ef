/*
 * Halos: friends of friends with b = 0.2, and the masses of spheres about their densest places.
 */

#ifndef GROUPS_H
#define GROUPS_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"

enum { GROUPS_LEAST = 20, GROUPS_SPHERES = 3 };

/* What `spheres` holds, for each halo in this order. */
enum { GROUPS_200B, GROUPS_200C, GROUPS_VIRIAL };

struct groups {
    const struct fixpair_exec *exec;
    size_t particles;
    double box_size;
    double particle_mass; /* Msun/h */
    double length;        /* that links */
    uint64_t *labels;     /* of each particle */
    struct fixpair_halo *halos;
    size_t halos_len, count;
    double *centres, *radii;                   /* three numbers and one a halo */
    double overdensities[GROUPS_SPHERES];      /* over the mean density */
    struct fixpair_sphere *spheres;            /* GROUPS_SPHERES a halo */
    void *scratch;
    size_t scratch_len;
};

/*
 * Memory for any number of catalogues of so many particles of all matter. Returns 0, or 1 after saying what is wrong; in both cases
 * groups_close gives the memory back, as it does for a struct of zeros.
 */
int groups_open(struct groups *groups, size_t particles, double box_size, const struct fixpair_cosmology *cosmology,
                const struct fixpair_exec *exec);

void groups_close(struct groups *groups);

/* Finds those of GROUPS_LEAST particles and more, the largest first. */
int groups_find(struct groups *groups, const struct fixpair_positions_f32 *position, const struct fixpair_positions_f32 *velocity,
                const struct fixpair_cosmology *cosmology, double scale_factor);

/* A catalogue with a line of names above. */
int groups_write(const struct groups *groups, const char *path);

#endif
