/*
 * Numbers from a command line. Both return 0 if the text is such a number and nothing else, and it lies within the bounds, else 1.
 */

#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdint.h>

int option_number(double *value, const char *text, double least, double most);

/* Without a fraction; 0 where it is not. */
int option_whole(uint64_t *value, const char *text, double least, double most);

#endif
