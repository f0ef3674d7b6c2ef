#include "migrate.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "traffic.h"

int particles_open(struct particles *particles, size_t capacity) {
    memset(particles, 0, sizeof *particles);
    particles->capacity = capacity > 0 ? capacity : 1;
    particles->at = malloc(particles->capacity * sizeof *particles->at);
    if (particles->at == NULL) fprintf(stderr, "no memory for %lu particles\n", (unsigned long)capacity);
    return particles->at == NULL;
}

void particles_close(struct particles *particles) {
    free(particles->at);
    memset(particles, 0, sizeof *particles);
}

int particles_make_room(struct particles *particles, size_t count) {
    if (count <= particles->capacity) return 0;
    size_t capacity = count + count / 8;
    struct particle *at = realloc(particles->at, capacity * sizeof *at);
    if (at == NULL) return 1;
    particles->at = at;
    particles->capacity = capacity;
    return 0;
}

enum { STRIDE = sizeof(struct particle) / sizeof(double) };

struct fixpair_components_f64 particles_position(struct particles *particles) {
    double *x = particles->at->x;
    struct fixpair_components_f64 position = {x, x + 1, x + 2, STRIDE, particles->count};
    return position;
}

struct fixpair_components_f64 particles_velocity(struct particles *particles) {
    double *v = particles->at->v;
    struct fixpair_components_f64 velocity = {v, v + 1, v + 2, STRIDE, particles->count};
    return velocity;
}

struct fixpair_positions_f64 particles_view(const struct fixpair_components_f64 *components) {
    struct fixpair_positions_f64 view = {components->x, components->y, components->z, components->stride, components->length};
    return view;
}

/* Numbers of particles to and from each process, and where each one's begin. */
struct plan {
    int *to, *to_place, *from, *from_place;
    struct particle *leaving;
    size_t out, in;
};

static int plan_open(struct plan *plan, const struct particles *particles, const struct slabs *slabs, double box_size) {
    size_t ranks = (size_t)slabs->ranks;
    memset(plan, 0, sizeof *plan);
    if ((plan->to = calloc(4 * ranks, sizeof *plan->to)) == NULL) return 1;
    plan->to_place = plan->to + ranks;
    plan->from = plan->to_place + ranks;
    plan->from_place = plan->from + ranks;
    for (size_t i = 0; i < particles->count; i++) {
        int owner = slabs_owner_of(slabs, particles->at[i].x[0], box_size);
        if (owner != slabs->rank) plan->to[owner]++;
    }
    MPI_Alltoall(plan->to, 1, MPI_INT, plan->from, 1, MPI_INT, slabs->comm);
    for (size_t rank = 0; rank < ranks; rank++) {
        plan->to_place[rank] = (int)plan->out;
        plan->from_place[rank] = (int)plan->in;
        plan->out += (size_t)plan->to[rank];
        plan->in += (size_t)plan->from[rank];
    }
    if (plan->out > INT_MAX || plan->in > INT_MAX) return 1;
    plan->leaving = malloc((plan->out + 1) * sizeof *plan->leaving);
    return plan->leaving == NULL;
}

static void plan_close(struct plan *plan) {
    free(plan->to);
    free(plan->leaving);
}

/* Those who leave into their places, those who stay close up. */
static void part(struct plan *plan, struct particles *particles, const struct slabs *slabs, double box_size) {
    size_t stay = 0;
    for (size_t i = 0; i < particles->count; i++) {
        int owner = slabs_owner_of(slabs, particles->at[i].x[0], box_size);
        if (owner == slabs->rank) {
            particles->at[stay++] = particles->at[i];
        } else {
            plan->leaving[plan->to_place[owner]++] = particles->at[i];
        }
    }
    for (int rank = 0; rank < slabs->ranks; rank++) plan->to_place[rank] -= plan->to[rank];
    particles->count = stay;
}

int migrate(struct particles *particles, const struct slabs *slabs, double box_size, size_t *sent) {
    struct plan plan;
    enum traffic traffic = traffic_of(TRAFFIC_PARTICLES);
    int broken = plan_open(&plan, particles, slabs, box_size);
    if (!broken) {
        part(&plan, particles, slabs, box_size);
        broken = particles_make_room(particles, particles->count + plan.in);
    }
    if (!broken) {
        MPI_Datatype type;
        MPI_Type_contiguous((int)sizeof(struct particle), MPI_BYTE, &type);
        MPI_Type_commit(&type);
        MPI_Alltoallv(plan.leaving, plan.to, plan.to_place, type, particles->at + particles->count, plan.from, plan.from_place, type,
                      slabs->comm);
        MPI_Type_free(&type);
        particles->count += plan.in;
        if (sent != NULL) *sent = plan.out;
    } else {
        fprintf(stderr, "no memory for the particles that move between processes\n");
    }
    plan_close(&plan);
    traffic_of(traffic);
    return broken;
}
