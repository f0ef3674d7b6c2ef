/*
 * What stands around each call of the library when allocations are counted: see allocations.c. GNU C, Linux.
 */
#ifndef FIXPAIR_ALLOCATIONS_H
#define FIXPAIR_ALLOCATIONS_H

#include "fixpair.h"

/* From here on all that any thread takes or gives back is laid to this function; returns to whom it was laid before. */
int counted_enter(int function);
void counted_leave(const int *before);

/* The value of the call, whatever its type. */
#define COUNTED(function, call)                                                                              \
    __extension__({                                                                                          \
        int counted_before __attribute__((cleanup(counted_leave), unused)) = counted_enter(function);        \
        call;                                                                                                \
    })

/* Code of the host in a hook, on this thread: what it takes is its own. */
void host_enter(void);
void host_leave(void);
#define HOST_ENTER() host_enter()
#define HOST_LEAVE() host_leave()

#endif
