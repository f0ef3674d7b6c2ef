/*
 * A particle-mesh run on several processes: slabs of FFTW-MPI, ghost planes and particles exchanged with MPI, kernels of the library in
 * between; P(k) of each step, and halos over the borders of slabs at the end.
 *
 *     mpiexec -n 4 mpi_pm [options]
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "alone.h"
#include "budget.h"
#include "check.h"
#include "friends.h"
#include "memory.h"
#include "pm.h"
#include "together.h"
#include "traffic.h"

/* Transforms differ by roundings of 1e-16, and so do sums of the same masses in another order. Gravity lets them grow: to 5e-13 of a
   cell in eight steps. In P(k) those of many particles cancel. */
#define APART_BOUND 1e-10
#define POWER_BOUND 1e-12
/* Of linear theory's account of who crosses borders. */
#define MOVED_BOUND 0.2
/* Distances between particles at first, that particles go, before it holds. */
#define FAR 1.7

struct example {
    struct universe_choice choice;
    int transposed, check, report;
    int rank, ranks;
    struct universe universe;
    struct pm pm;
    struct friends friends;
    double mean_displacement; /* <|psi_x|>, over D */
    double *power;            /* a spectrum for each scale factor */
    struct fixpair_halo *halos;
    size_t halos_len;
    struct alone alone;
    int failures;
};

static void usage(FILE *stream) {
    fprintf(stream,
            "usage: mpi_pm [options]\n\n%s"
            "  --transposed      modes in slabs of y, as FFTW-MPI likes it best\n"
            "  --check           compare with the same run on one process, by the built-in transform\n"
            "  --report          memory and bytes sent beside the formulae, and those of 4096^3 particles on 512 processes\n",
            universe_usage);
}

/* Initial velocities are a H f D psi, but for a percent of second order. */
static int measure_displacement(struct example *example) {
    const struct universe *universe = &example->universe;
    struct fixpair_growth growth;
    double a = universe->scale_factors[0], e, sum = 0.0;
    TRY(fixpair_growth_factors(&growth, &a, 1, &universe->gravity.cosmology));
    TRY(fixpair_expansion(&e, &a, 1, &universe->gravity.cosmology));
    for (size_t i = 0; i < example->pm.particles.count; i++) sum += fabs(example->pm.particles.at[i].v[0]);
    example->mean_displacement = together_sum(sum) / (double)universe->particles / (a * universe->gravity.hubble * e * growth.f * growth.d);
    return 0;
}

/* ---- What came of it. */

static void print_power(const struct example *example) {
    size_t shells = example->pm.spectrum.shells, steps = example->choice.steps;
    const double *first = example->power, *last = example->power + steps * shells;
    double fundamental = 2.0 * 3.14159265358979323846 / example->choice.box_size;
    if (example->rank != 0) return;
    printf("\n%10s %14s %14s    %lu halos\n", "k h/Mpc", "P at the start", "P at the end", (unsigned long)example->halos_len);
    for (size_t b = 0; b < shells; b += shells / 6 + 1) {
        printf("%10.4f %14.4f %14.4f\n", fundamental * example->pm.spectrum.bins[b].first, first[b], last[b]);
    }
    printf("\n");
}

/* ---- The same as on one process. */

/* Every particle is somewhere, once. */
static int check_ids(struct example *example) {
    size_t count = example->universe.particles;
    int32_t *times = calloc(count, sizeof *times);
    if (times == NULL) return 1;
    uint64_t outside = 0, wrong = 0;
    for (size_t i = 0; i < example->pm.particles.count; i++) {
        const struct particle *particle = &example->pm.particles.at[i];
        if (particle->id < count) times[particle->id]++;
        outside += slabs_owner_of(&example->pm.fft.slabs, particle->x[0], example->choice.box_size) != example->rank;
    }
    MPI_Allreduce(MPI_IN_PLACE, times, (int)count, MPI_INT32_T, MPI_SUM, MPI_COMM_WORLD);
    for (size_t i = 0; i < count; i++) wrong += times[i] != 1;
    free(times);
    outside = together_count(outside);
    CLAIM(example->failures, wrong == 0 && outside == 0, "each of %lu particles is on one process, whose slab it is in",
          (unsigned long)count);
    return 0;
}

static void check_power(struct example *example) {
    size_t shells = example->pm.spectrum.shells, steps = example->choice.steps;
    double first = 0.0, apart = 0.0;
    for (size_t i = 0; i < (steps + 1) * shells; i++) {
        double difference = fabs(example->power[i] / example->alone.power[i] - 1.0);
        if (i < shells) first = fmax(first, difference);
        apart = fmax(apart, difference);
    }
    CLAIM(example->failures, first < POWER_BOUND, "P(k) of the initial particles is that of one process to %.1e in %lu shells", first,
          (unsigned long)shells);
    CLAIM(example->failures, apart < POWER_BOUND, "and P(k) of all %lu steps to %.1e", (unsigned long)steps, apart);
}

static void check_halos(struct example *example) {
    const struct alone *alone = &example->alone;
    size_t count = example->halos_len, different = count != alone->halos_len;
    double apart = 0.0;
    for (size_t i = 0; count == alone->halos_len && i < count; i++) {
        const struct fixpair_halo *one = &example->halos[i], *other = &alone->halos[i];
        different += one->members != other->members || one->label != other->label;
        for (size_t axis = 0; axis < 3; axis++) {
            double distance = fabs(one->centre[axis] - other->centre[axis]);
            apart = fmax(apart, fmin(distance, example->choice.box_size - distance));
        }
    }
    double cell = example->choice.box_size / (double)example->pm.fft.slabs.n;
    different = (size_t)together_count(different);
    apart = together_largest(apart);
    CLAIM(example->failures, different == 0, "%lu halos with the numbers of particles that one process finds",
          (unsigned long)count);
    CLAIM(example->failures, apart < APART_BOUND * cell, "their centres to %.1e of a cell", apart / cell);
}

static int check(struct example *example) {
    double cell = example->choice.box_size / (double)example->pm.fft.slabs.n, apart, faster, fastest = 0.0;
    if (alone_run(&example->alone, &example->universe, MPI_COMM_WORLD)) return 1;
    if (check_ids(example)) return 1;
    alone_compare(&apart, &faster, &example->alone, &example->pm.particles, example->choice.box_size);
    apart = together_largest(apart);
    faster = together_largest(faster);
    for (size_t i = 0; i < 3 * example->universe.particles; i++) fastest = fmax(fastest, fabs(example->alone.velocity[i]));
    CLAIM(example->failures, apart < APART_BOUND * cell, "after %lu steps positions are those of one process to %.1e of a cell",
          (unsigned long)example->choice.steps, apart / cell);
    CLAIM(example->failures, faster < APART_BOUND * fastest, "velocities to %.1e of the largest", faster / fastest);
    check_power(example);
    check_halos(example);
    return 0;
}

/* ---- What it took. */

static int report(struct example *example, const uint64_t sent[TRAFFIC_KINDS]) {
    const struct universe *universe = &example->universe;
    const struct pm *pm = &example->pm;
    size_t steps = example->choice.steps, forces = steps + 1;
    uint64_t transforms = 4 * forces * budget_transform(&pm->fft), ghosts = forces * budget_ghosts(&pm->ghosts);
    uint64_t wrong = together_count(sent[TRAFFIC_TRANSFORM] != transforms), wrong_ghosts = together_count(sent[TRAFFIC_GHOSTS] != ghosts);
    uint64_t moved = together_count(pm->moved);
    struct fixpair_growth growth[2];
    double ends[2] = {universe->scale_factors[0], universe->scale_factors[steps]};
    TRY(fixpair_growth_factors(growth, ends, 2, &universe->gravity.cosmology));
    double expected = budget_moved(&pm->fft.slabs, example->choice.box_size, example->mean_displacement, growth[1].d - growth[0].d);
    double share = (double)moved / (double)universe->particles;
    double most = together_largest((double)pm->most) * example->ranks / (double)universe->particles;
    uint64_t copies = together_count(example->friends.copies);
    /* The lattice that particles begin on shows in who crosses, until they have gone further than it is wide. */
    int far = expected * example->choice.box_size > FAR * example->ranks * example->choice.box_size / (double)example->choice.n;
    CLAIM(example->failures, wrong == 0, "%lu transforms sent %llu bytes from this process, and from each what the formula says",
          4 * (unsigned long)forces, (unsigned long long)transforms);
    /* What the formula for memory rests on; ghosts that meet round the mesh are no more than its planes. */
    size_t own = slabs_planes(&pm->fft.slabs, pm->fft.slabs.rank), most_planes = own + (size_t)universe->gravity.window - 1;
    int short_of = own > 0 && most_planes < pm->fft.slabs.n && pm->ghosts.region.count[0] != most_planes;
    CLAIM(example->failures, together_count(short_of) == 0, "a slab of %lu planes has the ghosts of its window, %lu planes in all",
          (unsigned long)own, (unsigned long)pm->ghosts.region.count[0]);
    CLAIM(example->failures, wrong_ghosts == 0, "ghosts of %lu forces %llu bytes", (unsigned long)forces, (unsigned long long)ghosts);
    if (far) {
        CLAIM(example->failures, fabs(share - expected) <= MOVED_BOUND * expected,
              "%.4f of the particles crossed a border in all steps, linear theory says %.4f", share, expected);
    }
    if (example->rank == 0) {
        printf("  at most %.2f times the mean number of particles on a process\n", most);
        printf("  sent by rank 0 in all: transforms %llu, ghosts %llu, particles %llu, halos %llu bytes\n",
               (unsigned long long)sent[TRAFFIC_TRANSFORM], (unsigned long long)sent[TRAFFIC_GHOSTS],
               (unsigned long long)sent[TRAFFIC_PARTICLES], (unsigned long long)traffic_bytes(TRAFFIC_HALOS));
        printf("  for halos %llu copies of particles, %llu pairs of labels\n", (unsigned long long)copies,
               (unsigned long long)example->friends.pairs);
        for (size_t mesh_factor = 1; mesh_factor <= 2; mesh_factor++) TRY(budget_print(stdout, 4096, mesh_factor, 512, 2000.0));
    }
    return 0;
}

static int run(struct example *example) {
    uint64_t sent[TRAFFIC_KINDS];
    struct friends *friends = &example->friends;
    struct pm *pm = &example->pm;
    if (universe_open(&example->universe, &example->choice)) return 1;
    if (pm_open(pm, MPI_COMM_WORLD, &example->universe, example->transposed)) return 1;
    example->power = memory_take_doubles((example->choice.steps + 1) * pm->spectrum.shells);
    if (example->power == NULL || pm_begin(pm) || measure_displacement(example)) return 1;
    for (int kind = 0; kind < TRAFFIC_KINDS; kind++) sent[kind] = traffic_bytes((enum traffic)kind);
    if (pm_evolve(pm, example->power)) return 1;
    for (int kind = 0; kind < TRAFFIC_KINDS; kind++) sent[kind] = traffic_bytes((enum traffic)kind) - sent[kind];
    if (friends_init(friends, &example->universe.conditions.cosmology, example->choice.box_size, example->universe.particles)) return 1;
    if (friends_find(&example->halos, &example->halos_len, friends, &pm->particles, &pm->fft.slabs)) return 1;
    print_power(example);
    if (example->check && check(example)) return 1;
    return example->report ? report(example, sent) : 0;
}

static int parse(struct example *example, int argc, char **argv) {
    universe_defaults(&example->choice);
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(name, "--transposed") == 0) {
            example->transposed = 1;
        } else if (strcmp(name, "--check") == 0) {
            example->check = 1;
        } else if (strcmp(name, "--report") == 0) {
            example->report = 1;
        } else if (strncmp(name, "--", 2) == 0 && universe_option(&example->choice, name + 2, value) == 0) {
            i++;
        } else {
            return 1;
        }
    }
    return 0;
}

int main(int argc, char **argv) {
    struct example example;
    memset(&example, 0, sizeof example);
    MPI_Init(&argc, &argv);
    fftw_mpi_init();
    MPI_Comm_rank(MPI_COMM_WORLD, &example.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &example.ranks);
    if (parse(&example, argc, argv)) {
        if (example.rank == 0) usage(stderr);
        MPI_Finalize();
        return EXIT_FAILURE;
    }
    /* The others would wait for one that failed. */
    if (run(&example)) MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
    pm_close(&example.pm);
    alone_close(&example.alone);
    free(example.power);
    free(example.halos);
    universe_close(&example.universe);
    fftw_mpi_cleanup();
    MPI_Finalize();
    return example.failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
