#include "slabs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int slabs_open(struct slabs *slabs, MPI_Comm comm, size_t n, size_t planes) {
    memset(slabs, 0, sizeof *slabs);
    slabs->comm = comm;
    slabs->n = n;
    MPI_Comm_rank(comm, &slabs->rank);
    MPI_Comm_size(comm, &slabs->ranks);
    unsigned long long mine = planes, *all = calloc((size_t)slabs->ranks, sizeof *all);
    slabs->first = calloc((size_t)slabs->ranks + 1, sizeof *slabs->first);
    if (all == NULL || slabs->first == NULL) {
        fprintf(stderr, "no memory left\n");
        free(all);
        return 1;
    }
    MPI_Allgather(&mine, 1, MPI_UNSIGNED_LONG_LONG, all, 1, MPI_UNSIGNED_LONG_LONG, comm);
    for (int rank = 0; rank < slabs->ranks; rank++) slabs->first[rank + 1] = slabs->first[rank] + (size_t)all[rank];
    free(all);
    if (slabs->first[slabs->ranks] == n) return 0;
    fprintf(stderr, "slabs hold %lu planes of %lu\n", (unsigned long)slabs->first[slabs->ranks], (unsigned long)n);
    return 1;
}

void slabs_close(struct slabs *slabs) {
    free(slabs->first);
    memset(slabs, 0, sizeof *slabs);
}

size_t slabs_planes(const struct slabs *slabs, int rank) {
    return slabs->first[rank + 1] - slabs->first[rank];
}

int slabs_owner(const struct slabs *slabs, size_t plane) {
    /* first[low] <= plane < first[high]: the last such rank is not empty. */
    int low = 0, high = slabs->ranks;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (slabs->first[middle] <= plane) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

int slabs_owner_of(const struct slabs *slabs, double x, double box_size) {
    /* Just below the edge of the box the quotient may round up to n. */
    size_t plane = (size_t)(x / box_size * (double)slabs->n);
    return slabs_owner(slabs, plane < slabs->n ? plane : slabs->n - 1);
}

int32_t slabs_brick(struct fixpair_brick *brick, const struct slabs *slabs, int rank) {
    return fixpair_brick_slab(brick, slabs->n, FIXPAIR_SPACE_CONFIGURATION, slabs->first[rank], slabs_planes(slabs, rank));
}
