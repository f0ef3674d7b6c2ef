/* What every example does with a status and with a claim. */

#ifndef CHECK_H
#define CHECK_H

#include <stdint.h>

/*
 * Leaves the calling function, with a non-zero number, where `call` fails. Functions of these examples return 0, or 1 after
 * they have said what is wrong; those of the library return a negative status and say nothing, so that it is said here.
 */
#define TRY(call)                                                        \
    do {                                                                 \
        int32_t outcome_ = (call);                                       \
        if (outcome_ < 0) report_status(__FILE__, __LINE__, outcome_);   \
        if (outcome_ != 0) return 1;                                     \
    } while (0)

/* Prints where, which status, and the library's sentence about it. */
void report_status(const char *file, int line, int32_t status);

/* Prints a claim and whether it holds. Returns 0 if it does, else 1: add the results up. */
int claim(int holds, const char *format, ...);

#endif
