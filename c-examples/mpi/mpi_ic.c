/*
 * Initial conditions on several processes, on the slabs of FFTW-MPI. Each makes the particles of its planes by the call that makes a whole
 * box on one: only the transform is another.
 *
 *     mpiexec -n 4 mpi_ic [options]
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "alone.h"
#include "budget.h"
#include "check.h"
#include "fftw_slabs.h"
#include "memory.h"
#include "start.h"
#include "together.h"
#include "traffic.h"
#include "universe.h"

struct example {
    struct universe_choice choice;
    int transposed, check;
    const char *output;
    int rank, ranks;
    struct universe universe;
    struct fftw_slabs fft;
    struct particles particles;
    struct alone alone;
    int failures;
};

static void usage(FILE *stream) {
    fprintf(stream,
            "usage: mpi_ic [options]\n\n%s"
            "  --transposed      modes in slabs of y, as FFTW-MPI likes it best\n"
            "  --check           compare with the same universe on one process, by the built-in transform\n"
            "  --output FILE     positions as doubles, in order of their id, whoever made them\n",
            universe_usage);
}

/* The hook keeps its contract: all processes try it together. */
static int check_hook(struct example *example) {
    const struct fixpair_fft_f64 *fft = &example->fft.hook;
    double *data = memory_take_doubles(fft->length);
    if (data == NULL) return 1;
    fixpair_status_t status = fixpair_fft_self_test_f64(fft, data, fft->length);
    free(data);
    if (status != FIXPAIR_OK) report_status(__FILE__, __LINE__, status);
    CLAIM(example->failures, together_count(status != FIXPAIR_OK) == 0,
          "FFTW-MPI keeps the contract of the transform on %d processes, modes %s", example->ranks,
          example->transposed ? "transposed" : "in order");
    return 0;
}

/* The random modes of this process beside those of a whole mesh, which needs no transform and no other process. */
static int check_noise(struct example *example) {
    const struct fixpair_brick *brick = &example->fft.hook.fourier;
    const struct fixpair_realisation *realisation = &example->universe.conditions.realisation;
    struct fixpair_brick whole;
    size_t n = brick->n, reals, other = 0;
    TRY(fixpair_brick_whole(&whole, n, FIXPAIR_SPACE_FOURIER, 0));
    TRY(fixpair_brick_reals(&reals, &whole));
    double *all = memory_take_doubles(reals), *part = memory_take_doubles(example->fft.hook.length);
    int32_t outcome = all == NULL || part == NULL;
    if (outcome == 0) outcome = fixpair_white_modes_f64(all, reals, &whole, realisation, NULL, 0, NULL);
    if (outcome == 0) outcome = fixpair_white_modes_f64(part, example->fft.hook.length, brick, realisation, NULL, 0, NULL);
    size_t modes = outcome == 0 ? brick->count[0] * brick->count[1] * brick->count[2] : 0;
    for (size_t i = 0; i < modes; i++) {
        size_t at[3] = {i / (brick->count[1] * brick->count[2]), i / brick->count[2] % brick->count[1], i % brick->count[2]};
        size_t here = 0, there = 0;
        for (size_t axis = 0; axis < 3; axis++) {
            here += at[axis] * brick->stride[axis];
            there += (brick->start[axis] + at[axis]) * whole.stride[axis];
        }
        other += memcmp(part + 2 * here, all + 2 * there, 2 * sizeof *part) != 0;
    }
    free(all);
    free(part);
    TRY(outcome);
    uint64_t different = together_count(other), checked = together_count(modes);
    CLAIM(example->failures, different == 0 && checked == n * n * (n / 2 + 1),
          "each of %lu random modes has the bits that it has on one process", (unsigned long)checked);
    return 0;
}

/* Sums are integers: equal modes give equal bits. Only products in f_NL went through a transform. */
static int check_power(struct example *example) {
    const struct universe_choice *choice = &example->choice;
    size_t shells = example->alone.shells, different = 0;
    double *power = memory_take_doubles(shells), apart = 0.0;
    if (power == NULL) return 1;
    if (linear_spectrum(power, &example->universe, &example->fft.hook, MPI_COMM_WORLD)) return 1;
    for (size_t b = 0; b < shells; b++) {
        different += memcmp(power + b, example->alone.power + b, sizeof *power) != 0;
        apart = fmax(apart, fabs(power[b] / example->alone.power[b] - 1.0));
    }
    free(power);
    /* Transforms err by a few 1e-16 of the r.m.s.; the smallest modes of Phi^2 are some 1e-3 of it. */
    CLAIM(example->failures, apart < 1e-12, "P(k) of the linear density is that of one process to %.1e in %lu shells", apart,
          (unsigned long)shells);
    if (choice->f_nl == 0.0 && choice->g_nl == 0.0) {
        CLAIM(example->failures, different == 0, "and, as the field is Gaussian, to the last bit");
    }
    return 0;
}

static void check_particles(struct example *example) {
    double box_size = example->choice.box_size, cell = box_size / (double)example->choice.n, apart, faster, fastest = 0.0;
    size_t count = example->universe.particles;
    alone_compare(&apart, &faster, &example->alone, &example->particles, box_size);
    apart = together_largest(apart);
    faster = together_largest(faster);
    for (size_t i = 0; i < 3 * count; i++) fastest = fmax(fastest, fabs(example->alone.velocity[i]));
    uint64_t made = together_count(example->particles.count);
    CLAIM(example->failures, made == count, "there are %lu particles, %lu of them on this process", (unsigned long)made,
          (unsigned long)example->particles.count);
    /* Displacements are of the order of a cell, transforms err by a few 1e-16 of their r.m.s., positions below L are rounded to 1e-16 L = n
       1e-16 cells: below 1e-12 for any n up to 1000. */
    CLAIM(example->failures, apart < 1e-12 * cell, "positions are those of one process to %.1e of a cell", apart / cell);
    CLAIM(example->failures, faster < 1e-12 * fastest, "velocities to %.1e of the largest", faster / fastest);
}

/* As many transforms as the header says, of the size that the formula says. */
static void check_traffic(struct example *example, uint64_t sent) {
    const struct universe_choice *choice = &example->choice;
    uint64_t transforms = choice->order == FIXPAIR_ORDER_FIRST ? 3 : choice->order == FIXPAIR_ORDER_SECOND ? 13 : 198;
    if (choice->f_nl != 0.0 || choice->g_nl != 0.0) transforms += 2;
    uint64_t each = budget_transform(&example->fft), wrong = together_count(sent != transforms * each);
    CLAIM(example->failures, wrong == 0, "%llu transforms sent %llu bytes each from this process, and from each what the formula says",
          (unsigned long long)transforms, (unsigned long long)each);
}

/* One file of all positions in the order of ids, which is that of ranks: each process writes its part. */
static int write_positions(const struct example *example) {
    MPI_File file;
    MPI_Datatype three, particle;
    MPI_Offset first = (MPI_Offset)example->fft.slabs.first[example->rank] * (MPI_Offset)(example->choice.n * example->choice.n);
    MPI_Type_contiguous(3, MPI_DOUBLE, &three);
    MPI_Type_create_resized(three, 0, (MPI_Aint)sizeof(struct particle), &particle);
    MPI_Type_commit(&particle);
    int outcome = MPI_File_open(MPI_COMM_WORLD, example->output, MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL, &file);
    if (outcome == MPI_SUCCESS) {
        outcome = MPI_File_set_size(file, (MPI_Offset)(24 * example->universe.particles));
        if (outcome == MPI_SUCCESS) {
            outcome = MPI_File_write_at_all(file, 24 * first, example->particles.at->x, (int)example->particles.count, particle,
                                            MPI_STATUS_IGNORE);
        }
        if (MPI_File_close(&file) != MPI_SUCCESS) outcome = MPI_ERR_FILE;
    }
    MPI_Type_free(&particle);
    MPI_Type_free(&three);
    if (outcome != MPI_SUCCESS) fprintf(stderr, "%s is not written\n", example->output);
    return outcome != MPI_SUCCESS;
}

static int run(struct example *example) {
    if (universe_open(&example->universe, &example->choice)) return 1;
    if (fftw_slabs_open(&example->fft, MPI_COMM_WORLD, example->choice.n, example->transposed)) return 1;
    if (example->check && check_hook(example)) return 1;
    uint64_t before = traffic_bytes(TRAFFIC_TRANSFORM);
    if (start_particles(&example->particles, &example->universe.conditions, &example->fft.hook)) return 1;
    uint64_t sent = traffic_bytes(TRAFFIC_TRANSFORM) - before;
    if (example->output != NULL && write_positions(example)) return 1;
    if (!example->check) return 0;

    if (check_noise(example)) return 1;
    if (alone_begin(&example->alone, &example->universe, MPI_COMM_WORLD)) return 1;
    if (check_power(example)) return 1;
    check_particles(example);
    check_traffic(example, sent);
    return 0;
}

static int parse(struct example *example, int argc, char **argv) {
    universe_defaults(&example->choice);
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(name, "--transposed") == 0) {
            example->transposed = 1;
        } else if (strcmp(name, "--check") == 0) {
            example->check = 1;
        } else if (strcmp(name, "--output") == 0 && *value != '\0') {
            example->output = value;
            i++;
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
    particles_close(&example.particles);
    alone_close(&example.alone);
    fftw_slabs_close(&example.fft);
    universe_close(&example.universe);
    fftw_mpi_cleanup();
    MPI_Finalize();
    return example.failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
