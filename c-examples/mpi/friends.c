#include "friends.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"
#include "traffic.h"

#define LINKING 0.2
enum { LEAST = 20, STRIDE = sizeof(struct particle) / sizeof(double) };

int friends_init(struct friends *friends, const struct fixpair_cosmology *cosmology, double box_size, uint64_t particles_total) {
    friends->box_size = box_size;
    friends->least = LEAST;
    friends->copies = friends->pairs = 0;
    TRY(fixpair_linking_length(&friends->length, LINKING, box_size, particles_total));
    TRY(fixpair_particle_mass(&friends->particle_mass, cosmology->omega_m, box_size, particles_total));
    return 0;
}

/* What is in memory while groups are found on several processes. */
struct search {
    const struct friends *friends;
    const struct slabs *slabs;
    struct particles *particles; /* own ones, and behind them copies of others' */
    size_t own, copies;
    uint64_t *ids, *labels;  /* of both */
    size_t *lent;            /* which own particles are copied, process by process */
    int *to, *to_place, *from, *from_place; /* copies to and from each process */
    uint64_t *pairs, *map;
    size_t pairs_len, entries;
    struct fixpair_halo_sums *sums;
    size_t sums_len;
    void *scratch;
    size_t scratch_len;
};

static void search_close(struct search *search) {
    free(search->ids);
    free(search->labels);
    free(search->lent);
    free(search->to);
    free(search->pairs);
    free(search->map);
    free(search->sums);
    free(search->scratch);
}

static int search_open(struct search *search, const struct friends *friends, const struct slabs *slabs, struct particles *particles) {
    size_t ranks = (size_t)slabs->ranks;
    memset(search, 0, sizeof *search);
    search->friends = friends;
    search->slabs = slabs;
    search->particles = particles;
    search->own = particles->count;
    if ((search->to = calloc(4 * ranks, sizeof *search->to)) == NULL) return 1;
    search->to_place = search->to + ranks;
    search->from = search->to_place + ranks;
    search->from_place = search->from + ranks;
    return 0;
}

/*
 * Calls that lend a particle at x: to the slabs whose upper edge is at most a linking length below it, the nearest first. Ghosts from
 * above alone are enough, for the lower of two friends then sees both. Writes `number` where there is a list, else counts.
 */
static void lend(struct search *search, double x, size_t number) {
    const struct slabs *slabs = search->slabs;
    double box_size = search->friends->box_size, cell = box_size / (double)slabs->n;
    /* A little more does no harm, and covers the rounding of positions and edges. */
    double deep = search->friends->length + 1e-9 * box_size;
    for (int step = 1; step < slabs->ranks; step++) {
        int rank = (slabs->rank + slabs->ranks - step) % slabs->ranks;
        if (slabs_planes(slabs, rank) == 0) continue;
        double above = x - (double)slabs->first[rank + 1] * cell;
        if (above < -1e-9 * box_size) above += box_size;
        if (above > deep) return;
        if (search->lent == NULL) {
            search->to[rank]++;
        } else {
            search->lent[search->to_place[rank]++] = number;
        }
    }
}

static int lend_all(struct search *search) {
    const struct particle *at = search->particles->at;
    int ranks = search->slabs->ranks;
    size_t lent = 0, copies = 0;
    for (size_t i = 0; i < search->own; i++) lend(search, at[i].x[0], i);
    MPI_Alltoall(search->to, 1, MPI_INT, search->from, 1, MPI_INT, search->slabs->comm);
    for (int rank = 0; rank < ranks; rank++) {
        search->to_place[rank] = (int)lent;
        search->from_place[rank] = (int)copies;
        lent += (size_t)search->to[rank];
        copies += (size_t)search->from[rank];
    }
    if (lent > INT_MAX || copies > INT_MAX) return 1;
    search->copies = copies;
    if ((search->lent = calloc(lent + 1, sizeof *search->lent)) == NULL) return 1;
    for (size_t i = 0; i < search->own; i++) lend(search, at[i].x[0], i);
    for (int rank = 0; rank < ranks; rank++) search->to_place[rank] -= search->to[rank];
    return 0;
}

/* Copies of others' particles behind the own ones. */
static int gather_copies(struct search *search) {
    int last = search->slabs->ranks - 1;
    size_t lent = (size_t)(search->to_place[last] + search->to[last]), all = search->own + search->copies;
    struct particle *leaving = malloc((lent + 1) * sizeof *leaving);
    search->ids = malloc((all + 1) * sizeof *search->ids);
    search->labels = malloc((all + 1) * sizeof *search->labels);
    int broken = leaving == NULL || search->ids == NULL || search->labels == NULL || particles_make_room(search->particles, all);
    if (!broken) {
        struct particle *at = search->particles->at;
        for (size_t i = 0; i < lent; i++) leaving[i] = at[search->lent[i]];
        MPI_Datatype type;
        MPI_Type_contiguous((int)sizeof(struct particle), MPI_BYTE, &type);
        MPI_Type_commit(&type);
        MPI_Alltoallv(leaving, search->to, search->to_place, type, at + search->own, search->from, search->from_place, type,
                      search->slabs->comm);
        MPI_Type_free(&type);
        for (size_t i = 0; i < all; i++) search->ids[i] = at[i].id;
    }
    free(leaving);
    return broken;
}

static struct fixpair_positions_f64 view(const double *first, size_t count) {
    struct fixpair_positions_f64 view = {first, first + 1, first + 2, STRIDE, count};
    return view;
}

static int label(struct search *search) {
    struct fixpair_layout labels, sums;
    size_t all = search->own + search->copies;
    struct fixpair_positions_f64 position = view(search->particles->at->x, all);
    TRY(fixpair_fof_labels_scratch_f64(&labels, all));
    TRY(fixpair_halos_scratch(&sums, search->own));
    if (labels.size < sums.size) labels = sums;
    search->scratch_len = labels.size;
    if ((search->scratch = memory_take(labels)) == NULL) return 1;
    TRY(fixpair_fof_labels_f64(search->labels, all, &position, search->ids, all, search->friends->box_size, search->friends->length,
                               search->scratch, search->scratch_len, NULL));
    return 0;
}

static int compare_pairs(const void *one, const void *other) {
    const uint64_t *a = one, *b = other;
    if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
    return (a[1] > b[1]) - (a[1] < b[1]);
}

/* The first of `count` pairs, ordered, that begins with a label; `count` if there is none. */
static size_t find_pair(const uint64_t *pairs, size_t count, uint64_t label) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (pairs[2 * middle] < label) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < count && pairs[2 * low] == label ? low : count;
}

/*
 * Keeps each pair once, and those alone whose group has particles of this process: friends that are copies both know of each other from the
 * lower one's owner. Without this all processes would hold a pair for every copy of a lone particle. Returns how many are left; `own` is
 * room for as many marks.
 */
static size_t thin_out(uint64_t *pairs, size_t count, const uint64_t *labels, size_t labels_len, char *own) {
    size_t kept = 0, first = 0;
    uint64_t label = 0, owners = 0;
    qsort(pairs, count, 2 * sizeof *pairs, compare_pairs);
    memset(own, 0, count);
    for (size_t i = 0; i < labels_len; i++) {
        size_t at = find_pair(pairs, count, labels[i]);
        if (at < count) own[at] = 1;
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t here = pairs[2 * i], there = pairs[2 * i + 1];
        if (i == 0 || here != label) first = i;
        int again = i > first && there == owners;
        label = here;
        owners = there;
        if (!own[first] || again) continue;
        pairs[2 * kept] = here;
        pairs[2 * kept + 1] = there;
        kept++;
    }
    return kept;
}

/* Pairs of the labels that a particle has here and at its owner. */
static int pair_here(struct search *search, uint64_t **pairs, size_t *count) {
    int last = search->slabs->ranks - 1;
    size_t lent = (size_t)(search->to_place[last] + search->to[last]), copies = search->copies;
    uint64_t *of_lent = malloc((lent + 1) * sizeof *of_lent), *of_owner = malloc((copies + 1) * sizeof *of_owner);
    char *marks = malloc(copies + 1);
    *pairs = malloc((2 * copies + 1) * sizeof **pairs);
    int broken = of_lent == NULL || of_owner == NULL || marks == NULL || *pairs == NULL;
    if (!broken) {
        for (size_t i = 0; i < lent; i++) of_lent[i] = search->labels[search->lent[i]];
        MPI_Alltoallv(of_lent, search->to, search->to_place, MPI_UINT64_T, of_owner, search->from, search->from_place, MPI_UINT64_T,
                      search->slabs->comm);
        for (size_t i = 0; i < copies; i++) {
            (*pairs)[2 * i] = search->labels[search->own + i];
            (*pairs)[2 * i + 1] = of_owner[i];
        }
        *count = thin_out(*pairs, copies, search->labels, search->own, marks);
    }
    free(of_lent);
    free(of_owner);
    free(marks);
    return broken;
}

/* Numbers of elements on all processes, and where each one's begin; to be freed. */
static int *gather_counts(size_t mine, const struct slabs *slabs, int **places, size_t *total) {
    int count = (int)mine, *counts = calloc(2 * (size_t)slabs->ranks, sizeof *counts);
    if (counts == NULL) return NULL;
    *places = counts + slabs->ranks;
    *total = 0;
    MPI_Allgather(&count, 1, MPI_INT, counts, 1, MPI_INT, slabs->comm);
    for (int rank = 0; rank < slabs->ranks; rank++) {
        (*places)[rank] = (int)*total;
        *total += (size_t)counts[rank];
    }
    return counts;
}

/* The pairs of all processes, on all. */
static int pair(struct search *search) {
    uint64_t *here;
    int *places;
    size_t count = 0, total = 0;
    if (pair_here(search, &here, &count)) return 1;
    int *counts = gather_counts(2 * count, search->slabs, &places, &total);
    search->pairs_len = total / 2;
    search->pairs = malloc((total + 1) * sizeof *search->pairs);
    search->map = malloc((2 * total + 1) * sizeof *search->map);
    int broken = counts == NULL || total > INT_MAX || search->pairs == NULL || search->map == NULL;
    if (!broken) {
        MPI_Allgatherv(here, (int)(2 * count), MPI_UINT64_T, search->pairs, counts, places, MPI_UINT64_T, search->slabs->comm);
    }
    free(here);
    free(counts);
    return broken;
}

/* Sums of this process's part of each group; on rank 0 then those of all processes. */
static int add_up(struct search *search) {
    struct fixpair_positions_f64 position = view(search->particles->at->x, search->own);
    struct fixpair_positions_f64 velocity = view(search->particles->at->v, search->own);
    TRY(fixpair_fof_merge(search->map, 2 * search->pairs_len, &search->entries, search->pairs, search->pairs_len));
    size_t room = search->own / search->friends->least + search->entries;
    if ((search->sums = calloc(room + 1, sizeof *search->sums)) == NULL) return 1;
    TRY(fixpair_halo_sums_f64(search->sums, room, &search->sums_len, search->labels, search->own, &position, &velocity,
                              search->friends->box_size, search->friends->least, search->map, search->entries, search->scratch,
                              search->scratch_len, NULL));

    int *places;
    size_t total;
    int *counts = gather_counts(search->sums_len, search->slabs, &places, &total);
    struct fixpair_halo_sums *all = malloc((total + 1) * sizeof *all);
    int broken = counts == NULL || all == NULL || total > INT_MAX;
    if (!broken) {
        MPI_Datatype type;
        MPI_Type_contiguous((int)sizeof *all, MPI_BYTE, &type);
        MPI_Type_commit(&type);
        MPI_Gatherv(search->sums, (int)search->sums_len, type, all, counts, places, type, 0, search->slabs->comm);
        MPI_Type_free(&type);
        free(search->sums);
        search->sums = all;
        search->sums_len = total;
    } else {
        free(all);
    }
    free(counts);
    return broken;
}

int friends_find(struct fixpair_halo **halos, size_t *count, struct friends *friends, struct particles *particles,
                 const struct slabs *slabs) {
    struct search search;
    enum traffic traffic = traffic_of(TRAFFIC_HALOS);
    int broken = search_open(&search, friends, slabs, particles) || lend_all(&search) || gather_copies(&search) || label(&search) ||
                 pair(&search) || add_up(&search);
    int32_t outcome = 0;
    *halos = NULL;
    *count = 0;
    if (!broken && slabs->rank == 0) {
        size_t groups = 0;
        outcome = fixpair_halo_sums_merge(search.sums, search.sums_len, &groups, friends->box_size);
        *halos = malloc((groups + 1) * sizeof **halos);
        if (outcome == 0 && *halos != NULL) {
            outcome = fixpair_halos_finish(*halos, groups, count, search.sums, groups, friends->box_size, friends->least,
                                           friends->particle_mass);
        }
        broken = *halos == NULL;
    }
    friends->copies = search.copies;
    friends->pairs = search.pairs_len;
    search_close(&search);
    traffic_of(traffic);
    if (broken) fprintf(stderr, "halos are not found\n");
    TRY(outcome);
    return broken;
}

int friends_find_alone(struct fixpair_halo **halos, size_t *count, const struct friends *friends, struct particles *particles) {
    struct fixpair_positions_f64 position = view(particles->at->x, particles->count), velocity = view(particles->at->v, particles->count);
    struct fixpair_layout labels_layout, layout;
    size_t all = particles->count, room = all / friends->least;
    TRY(fixpair_fof_labels_scratch_f64(&labels_layout, all));
    TRY(fixpair_halos_scratch(&layout, all));
    if (layout.size < labels_layout.size) layout = labels_layout;
    uint64_t *labels = malloc((all + 1) * sizeof *labels), *ids = malloc((all + 1) * sizeof *ids);
    void *scratch = memory_take(layout);
    *halos = malloc((room + 1) * sizeof **halos);
    int32_t outcome = labels == NULL || ids == NULL || scratch == NULL || *halos == NULL;
    for (size_t i = 0; outcome == 0 && i < all; i++) ids[i] = particles->at[i].id;
    if (outcome == 0) {
        outcome = fixpair_fof_labels_f64(labels, all, &position, ids, all, friends->box_size, friends->length, scratch, layout.size, NULL);
    }
    if (outcome == 0) {
        outcome = fixpair_halos_f64(*halos, room, count, labels, all, &position, &velocity, friends->box_size, friends->least,
                                    friends->particle_mass, scratch, layout.size, NULL);
    }
    free(labels);
    free(ids);
    free(scratch);
    TRY(outcome);
    return 0;
}
