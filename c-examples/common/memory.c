/* posix_memalign is not in C99; in C11 there is aligned_alloc(layout.align, layout.size). */
#define _POSIX_C_SOURCE 200112L

#include "memory.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *memory_take(struct fixpair_layout layout) {
    void *memory = NULL;
    /* For no bytes posix_memalign may give NULL, which has to keep meaning that there is no memory. */
    size_t size = layout.size > 0 ? layout.size : 1;
    if (posix_memalign(&memory, layout.align, size) != 0) {
        fprintf(stderr, "no %lu bytes of memory left\n", (unsigned long)size);
        return NULL;
    }
    return memset(memory, 0, size);
}

static void *take_numbers(size_t count, size_t bytes) {
    struct fixpair_layout layout;
    layout.size = count > SIZE_MAX / bytes ? SIZE_MAX : count * bytes;
    layout.align = 64;
    return memory_take(layout);
}

double *memory_take_doubles(size_t count) {
    return take_numbers(count, sizeof(double));
}

float *memory_take_floats(size_t count) {
    return take_numbers(count, sizeof(float));
}
