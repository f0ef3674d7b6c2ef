/*
 * Ghost planes: the planes of other processes that a window of this process's particles touches.
 *
 * A mesh with ghosts is one array: planes before the slab, the slab, planes after it, in rows of n + 2 reals throughout. The slab inside it
 * is what the transform takes, in place, so that there is neither a second mesh nor a copy of the own planes:
 *
 *     memory_take_doubles(ghosts.length)
 *     fixpair_deposit_f64(mesh, ghosts.length, &ghosts.region, ...);     particles of the slab, into all planes
 *     ghosts_fold(&ghosts, mesh);                                       planes of others go to them and are added there
 *     fft.forward(fft.context, mesh + ghosts.inside);                   overwrites the planes after the slab
 *     ...
 *     fft.inverse(fft.context, mesh + ghosts.inside);
 *     ghosts_fill(&ghosts, mesh);                                       planes of others come from them
 *     fixpair_kick_f64(..., mesh, ..., ghosts.length, &ghosts.region, ...);
 *
 * n (n + 2) reals are a multiple of 64 bytes, so the slab is aligned as the array is.
 */

#ifndef GHOSTS_H
#define GHOSTS_H

#include <mpi.h>
#include <stddef.h>

#include "fixpair.h"
#include "slabs.h"

/* Neighbouring planes that go from one process to another in one message. */
struct ghost_message {
    int other;     /* the process at the other end */
    size_t start;  /* the first plane, by its number in the mesh */
    size_t planes;
    size_t place;  /* where they lie: ghosts in the array with ghosts, own planes from its beginning too, in planes */
};

struct ghosts {
    const struct slabs *slabs;
    struct fixpair_brick slab, region;
    size_t plane;  /* reals of a plane */
    size_t inside; /* reals before the slab */
    size_t length; /* reals of an array with ghosts, in which the transform has the room that it wants */
    struct ghost_message *theirs; /* my ghosts, planes of others */
    struct ghost_message *mine;   /* my planes, ghosts of others */
    size_t theirs_len, mine_len;
    double *received; /* planes that others add to mine */
    MPI_Request *requests;
};

/*
 * `slabs` stays where it is. `fft_length`: reals that the transform of the slab wants. `window` and `shift` as the deposit has them. All
 * processes call it together. Returns 0, or 1 after saying what is wrong; in both cases ghosts_close gives the memory back, as it does for
 * a struct of zeros.
 */
int ghosts_open(struct ghosts *ghosts, const struct slabs *slabs, size_t fft_length, int32_t window, double shift);

void ghosts_close(struct ghosts *ghosts);

/* Ghosts are added to the planes they are copies of, in the order of ranks: the bits do not depend on which message comes first. */
int ghosts_fold(struct ghosts *ghosts, double *mesh);

/* Ghosts become copies of the planes of their owners. */
int ghosts_fill(struct ghosts *ghosts, double *mesh);

#endif
