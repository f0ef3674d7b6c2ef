/*
 * Bytes that this process sends to others, by what they are for. Counted in MPI itself: the functions of MPI that carry data here and
 * in FFTW-MPI are taken over and passed on (the standard's profiling interface), so that FFTW's own exchanges count too.
 */

#ifndef TRAFFIC_H
#define TRAFFIC_H

#include <stdint.h>

enum traffic { TRAFFIC_OTHER, TRAFFIC_TRANSFORM, TRAFFIC_GHOSTS, TRAFFIC_PARTICLES, TRAFFIC_HALOS, TRAFFIC_KINDS };

/* What is sent from now on is for this. Returns what it was for until now, to be set again. */
enum traffic traffic_of(enum traffic kind);

/* All bytes since the start of the program. */
uint64_t traffic_bytes(enum traffic kind);

#endif
