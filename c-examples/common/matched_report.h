/*
 * What constraints_find found, for people, and as CSV for programs. CSV: type, f_NL ("0", "100", or "100-0" for the matched difference), k
 * (empty where there is none), quantity, value, error (empty where there is none); numbers with all their digits.
 */

#ifndef MATCHED_REPORT_H
#define MATCHED_REPORT_H

#include "constraints.h"
#include "matched.h"

extern const char *const matched_report_types[CONSTRAINTS_TYPES];

void matched_report_print(const struct constraints *constraints, const struct matched *matched);

/* Returns 0, or 1 after saying what is wrong. */
int matched_report_write(const struct constraints *constraints, const struct matched *matched, const char *path);

#endif
