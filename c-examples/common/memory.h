/* Memory as fixpair asks for it: so many bytes, aligned so. */

#ifndef MEMORY_H
#define MEMORY_H

#include <stddef.h>

#include "fixpair.h"

/*
 * The bytes that a ..._scratch function asked for; give them back to free(). NULL where there are none left, after saying so. They
 * are zero, which the library does not ask for.
 */
void *memory_take(struct fixpair_layout layout);

/* `count` numbers, aligned to 64 bytes; the same otherwise. */
double *memory_take_doubles(size_t count);
float *memory_take_floats(size_t count);

#endif
