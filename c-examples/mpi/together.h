/* Numbers of all processes, and claims about them that one process prints. */

#ifndef TOGETHER_H
#define TOGETHER_H

#include <stdint.h>

#include "check.h"

/* All processes of MPI_COMM_WORLD call these together, and all get the result. */
double together_largest(double value);
double together_sum(double value);
uint64_t together_count(uint64_t value);

int together_rank(void);

/* Counts a claim that does not hold in `failures` on every process; rank 0 prints it. All have to agree about whether it holds. */
#define CLAIM(failures, holds, ...)                 \
    do {                                            \
        int holds_ = (holds);                       \
        if (together_rank() == 0) {                 \
            (failures) += claim(holds_, __VA_ARGS__); \
        } else {                                    \
            (failures) += !holds_;                  \
        }                                           \
    } while (0)

#endif
