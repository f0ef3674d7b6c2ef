/*
 * Particles as structs of the host, and how those that left a slab get to the process whose slab they are in.
 */

#ifndef MIGRATE_H
#define MIGRATE_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"
#include "slabs.h"

struct particle {
    double x[3]; /* Mpc/h, in [0, L) */
    double v[3]; /* peculiar, km/s */
    uint64_t id;
};

struct particles {
    struct particle *at;
    size_t count, capacity;
};

/*
 * Room for so many, of which there are none yet. Returns 0, or 1 after saying what is wrong. particles_close takes a struct of zeros
 * too.
 */
int particles_open(struct particles *particles, size_t capacity);

void particles_close(struct particles *particles);

/* Room for so many, with those that there are. Returns 0, or 1 where there is no memory. */
int particles_make_room(struct particles *particles, size_t count);

/* Their members, as fixpair takes them. */
struct fixpair_components_f64 particles_position(struct particles *particles);
struct fixpair_components_f64 particles_velocity(struct particles *particles);

/* The same to be read. */
struct fixpair_positions_f64 particles_view(const struct fixpair_components_f64 *components);

/*
 * Particles go to the processes whose slabs hold them, however far that is; those who stay keep their order, those who come follow in
 * the order of ranks. All processes call it together. More room is taken where it is needed. Returns 0, or 1 after saying what is wrong.
 *
 * Out: sent  how many left this process; or NULL
 */
int migrate(struct particles *particles, const struct slabs *slabs, double box_size, size_t *sent);

#endif
