/* One universe, and how it is run: the same on every process. */

#ifndef UNIVERSE_H
#define UNIVERSE_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"

/* What a command line chooses. */
struct universe_choice {
    size_t n;           /* particles on a side */
    size_t mesh_factor; /* cells over particles, on a side */
    size_t steps;       /* equal in the scale factor */
    uint64_t seed;
    int32_t scheme, amplitude, phase, order;
    double f_nl, g_nl;
    double box_size;    /* Mpc/h */
    double start, end;  /* redshifts */
};

struct universe {
    struct universe_choice choice;
    struct fixpair_conditions conditions;
    struct fixpair_gravity gravity;
    double *scale_factors; /* steps + 1 */
    size_t particles;      /* of all processes */
};

/* A small universe that holds every kind of term. */
void universe_defaults(struct universe_choice *choice);

/* Returns 0, or 1 after saying what is wrong; in both cases universe_close gives the memory back, as it does for a struct of zeros. */
int universe_open(struct universe *universe, const struct universe_choice *choice);

void universe_close(struct universe *universe);

/*
 * Sets a member by the name of its option, without dashes. Returns 0, 1 where the text is no such number, -1 where there is no such
 * option.
 */
int universe_option(struct universe_choice *choice, const char *name, const char *text);

/* What these options are, for a usage message. */
extern const char *const universe_usage;

#endif
