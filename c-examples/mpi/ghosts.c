#include "ghosts.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"
#include "traffic.h"

/* The slab of a process with its ghosts, in rows of n + 2 reals; and how many planes come before the slab. */
static int surround(struct fixpair_brick *region, size_t *before, const struct slabs *slabs, int rank, int32_t window, double shift) {
    struct fixpair_brick slab;
    size_t n = slabs->n;
    TRY(slabs_brick(&slab, slabs, rank));
    TRY(fixpair_brick_with_ghosts(region, &slab, window, shift));
    *before = (slab.start[0] + n - region->start[0]) % n;
    memcpy(region->stride, slab.stride, sizeof slab.stride);
    return 0;
}

/*
 * Messages in which the ghosts of process `rank` are owned by others: all of them, or those of `owner` if that is not -1. Only counts them
 * where `messages` is NULL. Planes that follow one another at one owner go together.
 */
static int list(struct ghost_message *messages, size_t *count, const struct slabs *slabs, int rank, int owner, int32_t window,
                double shift) {
    struct fixpair_brick region;
    size_t before, n = slabs->n, end = SIZE_MAX;
    int last = -1;
    TRY(surround(&region, &before, slabs, rank, window, shift));
    for (size_t a = 0; a < region.count[0]; a++) {
        size_t plane = (region.start[0] + a) % n;
        int whose = slabs_owner(slabs, plane);
        if (whose == rank || (owner != -1 && whose != owner)) continue;
        if (whose == last && plane == end) {
            if (messages != NULL) messages[*count - 1].planes++;
        } else {
            struct ghost_message message = {owner == -1 ? whose : rank, plane, 1, a};
            if (messages != NULL) messages[*count] = message;
            ++*count;
        }
        last = whose;
        end = plane + 1;
    }
    return 0;
}

static int list_all(struct ghosts *ghosts, int32_t window, double shift, int only_count) {
    const struct slabs *slabs = ghosts->slabs;
    ghosts->theirs_len = ghosts->mine_len = 0;
    TRY(list(only_count ? NULL : ghosts->theirs, &ghosts->theirs_len, slabs, slabs->rank, -1, window, shift));
    for (int rank = 0; rank < slabs->ranks; rank++) {
        if (rank == slabs->rank) continue;
        TRY(list(only_count ? NULL : ghosts->mine, &ghosts->mine_len, slabs, rank, slabs->rank, window, shift));
    }
    return 0;
}

int ghosts_open(struct ghosts *ghosts, const struct slabs *slabs, size_t fft_length, int32_t window, double shift) {
    size_t before, planes = 0, largest = 0;
    memset(ghosts, 0, sizeof *ghosts);
    ghosts->slabs = slabs;
    TRY(slabs_brick(&ghosts->slab, slabs, slabs->rank));
    TRY(surround(&ghosts->region, &before, slabs, slabs->rank, window, shift));
    ghosts->plane = ghosts->slab.stride[0];
    ghosts->inside = before * ghosts->plane;
    ghosts->length = ghosts->region.count[0] * ghosts->plane;
    if (ghosts->length < ghosts->inside + fft_length) ghosts->length = ghosts->inside + fft_length;

    TRY(list_all(ghosts, window, shift, 1));
    ghosts->theirs = calloc(ghosts->theirs_len + 1, sizeof *ghosts->theirs);
    ghosts->mine = calloc(ghosts->mine_len + 1, sizeof *ghosts->mine);
    ghosts->requests = calloc(ghosts->theirs_len + ghosts->mine_len + 1, sizeof *ghosts->requests);
    if (ghosts->theirs == NULL || ghosts->mine == NULL || ghosts->requests == NULL) return 1;
    TRY(list_all(ghosts, window, shift, 0));
    for (size_t i = 0; i < ghosts->theirs_len; i++) {
        if (largest < ghosts->theirs[i].planes) largest = ghosts->theirs[i].planes;
    }
    for (size_t i = 0; i < ghosts->mine_len; i++) {
        struct ghost_message *message = &ghosts->mine[i];
        message->place = before + message->start - ghosts->slab.start[0];
        planes += message->planes;
        if (largest < message->planes) largest = message->planes;
    }
    if (largest > INT_MAX / ghosts->plane) {
        fprintf(stderr, "%lu planes are too many for one message\n", (unsigned long)largest);
        return 1;
    }
    ghosts->received = memory_take_doubles(planes * ghosts->plane);
    return ghosts->received == NULL;
}

void ghosts_close(struct ghosts *ghosts) {
    free(ghosts->theirs);
    free(ghosts->mine);
    free(ghosts->received);
    free(ghosts->requests);
    memset(ghosts, 0, sizeof *ghosts);
}

/* Messages between two processes match in the order in which both list them: that of the planes of the one whose ghosts they are. */
static MPI_Request *receive(const struct ghosts *ghosts, MPI_Request *request, double *to, const struct ghost_message *message) {
    MPI_Irecv(to, (int)(message->planes * ghosts->plane), MPI_DOUBLE, message->other, 0, ghosts->slabs->comm, request);
    return request + 1;
}

static MPI_Request *post(const struct ghosts *ghosts, MPI_Request *request, const double *mesh, const struct ghost_message *message) {
    MPI_Isend(mesh + message->place * ghosts->plane, (int)(message->planes * ghosts->plane), MPI_DOUBLE, message->other, 0,
              ghosts->slabs->comm, request);
    return request + 1;
}

int ghosts_fold(struct ghosts *ghosts, double *mesh) {
    enum traffic traffic = traffic_of(TRAFFIC_GHOSTS);
    MPI_Request *request = ghosts->requests;
    double *received = ghosts->received;
    for (size_t i = 0; i < ghosts->mine_len; i++) {
        request = receive(ghosts, request, received, &ghosts->mine[i]);
        received += ghosts->mine[i].planes * ghosts->plane;
    }
    for (size_t i = 0; i < ghosts->theirs_len; i++) request = post(ghosts, request, mesh, &ghosts->theirs[i]);
    MPI_Waitall((int)(request - ghosts->requests), ghosts->requests, MPI_STATUSES_IGNORE);
    traffic_of(traffic);

    received = ghosts->received;
    for (size_t i = 0; i < ghosts->mine_len; i++) {
        struct fixpair_brick planes = ghosts->slab;
        size_t length = ghosts->mine[i].planes * ghosts->plane;
        planes.start[0] = ghosts->mine[i].start;
        planes.count[0] = ghosts->mine[i].planes;
        TRY(fixpair_add_cells_f64(mesh + ghosts->inside, ghosts->slab.count[0] * ghosts->plane, &ghosts->slab, received, length, &planes,
                                  NULL));
        received += length;
    }
    return 0;
}

int ghosts_fill(struct ghosts *ghosts, double *mesh) {
    enum traffic traffic = traffic_of(TRAFFIC_GHOSTS);
    MPI_Request *request = ghosts->requests;
    /* Both ends keep planes alike: they arrive in their place, and fixpair_copy_cells_f64 is for hosts that keep them in other ways. */
    for (size_t i = 0; i < ghosts->theirs_len; i++) {
        request = receive(ghosts, request, mesh + ghosts->theirs[i].place * ghosts->plane, &ghosts->theirs[i]);
    }
    for (size_t i = 0; i < ghosts->mine_len; i++) request = post(ghosts, request, mesh, &ghosts->mine[i]);
    MPI_Waitall((int)(request - ghosts->requests), ghosts->requests, MPI_STATUSES_IGNORE);
    traffic_of(traffic);
    return 0;
}
