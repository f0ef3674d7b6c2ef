/*
 * Reader of tables as CSV: the columns that are asked for, found by their names in the first line, in any order; others are passed over.
 *
 * A name may carry a unit, "k [h/Mpc]". Who asks for "k [h/Mpc]" gets it from "k [h/Mpc]" or "k", and is refused "k [1/Mpc]". There are no
 * quotes: names and values hold no commas. Lines may be blank, and those that begin with # are comments.
 */

#ifndef COLUMNS_H
#define COLUMNS_H

#include <stddef.h>

enum { COLUMNS_MOST = 32 };

struct columns_place {
    const char *path;
    unsigned long line;
};

/* Prints path:line: and what is wrong there. Returns 1. */
int columns_complain(const struct columns_place *place, const char *format, ...);

/* Given the values of one line, in the order asked for. Returns 0 to go on, or 1 after saying what is wrong. */
typedef int columns_row(void *context, const struct columns_place *place, char *const *values);

/* Reads a file. Returns 0, or 1 after saying what is wrong. */
int columns_read(const char *path, const char *const *names, size_t names_len, columns_row *row, void *context);

/* A finite number, and nothing beside it. Returns 0, or 1 after saying that `name` is none. */
int columns_number(double *number, const struct columns_place *place, const char *name, const char *text);

#endif
