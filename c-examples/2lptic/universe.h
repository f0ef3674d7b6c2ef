/*
 * From a parameter file to particles: what a key of 2LPTic means in the library's terms stands in universe.c.
 */

#ifndef UNIVERSE_H
#define UNIVERSE_H

#include <stddef.h>
#include <stdint.h>

#include "fixpair.h"
#include "glass.h"
#include "parameters.h"
#include "spectrum.h"
#include "transform.h"

/* What 2LPTic and its versions decide when they are compiled. */
struct choices {
    int32_t shape; /* FIXPAIR_SHAPE_...: of Fnl */
    int32_t order; /* FIXPAIR_ORDER_... */
    int dealias;   /* products on a mesh of 3/2 the side, where those codes let them alias */
    size_t threads;
};

struct universe {
    const struct parameters *parameters;
    struct choices choices;
    double growth; /* D of the starting redshift */
    struct spectrum spectrum;
    struct glass glass;
    struct fixpair_conditions conditions;
    fixpair_threads *threads;
    struct fixpair_exec exec;
    struct transform fft, fine;
    double *position, *velocity; /* triples in Mpc/h and km/s, in the order of the glass */
};

/*
 * Reads what the parameters name, and makes ready; no particles yet. The parameters must stay. Returns 0, or 1 after saying what
 * is wrong; in both cases universe_close gives the memory back, as it does for a struct of zeros.
 */
int universe_open(struct universe *universe, const struct parameters *parameters, const struct choices *choices);

/* The particles. */
int universe_make(struct universe *universe);

void universe_close(struct universe *universe);

#endif
