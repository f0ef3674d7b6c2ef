/* The built-in transform of fixpair, with the memory that it lives in. */

#ifndef TRANSFORM_H
#define TRANSFORM_H

#include <stddef.h>

#include "fixpair.h"

struct transform {
    struct fixpair_fft_f64 hook;
    void *tables;
    void *scratch;
};

/*
 * A transform of side n that runs on `exec` (or NULL). Returns 0, or 1 after saying what is wrong; in both cases
 * transform_close gives the memory back, as it does for a struct of zeros.
 */
int transform_open(struct transform *transform, size_t n, const struct fixpair_exec *exec);

void transform_close(struct transform *transform);

/* The same in single precision. */
struct transform_f32 {
    struct fixpair_fft_f32 hook;
    void *tables;
    void *scratch;
};

int transform_open_f32(struct transform_f32 *transform, size_t n, const struct fixpair_exec *exec);

void transform_close_f32(struct transform_f32 *transform);

#endif
