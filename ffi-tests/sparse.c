/*
 * Sizes that no machine has memory for, as a C program meets them: particles and modes farther apart than 32 bits count, in sparse memory of
 * which only touched pages exist; parts of meshes of 10^18 cells; scratch of 10^10 particles; lengths that overflow.
 */
#define _DEFAULT_SOURCE

#include <sys/mman.h>

#include "check.h"

/* Reals from one particle to the next: 34 GB of doubles. */
#define APART ((UINT64_C(1) << 32) + 17)

enum { FEW = 6, CELLS = 8 };

/* Address space without memory behind it; NULL where the system has no more to give. */
static void *reserve(size_t bytes) {
    void *start = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return start == MAP_FAILED ? NULL : start;
}

static fixpair_components_f64 components(double *first, size_t step, size_t stride) {
    fixpair_components_f64 of;
    of.x = first;
    of.y = first + step;
    of.z = first + 2 * step;
    of.stride = stride;
    of.length = FEW;
    return of;
}

static fixpair_positions_f64 shown(const fixpair_components_f64 *of) {
    fixpair_positions_f64 view;
    view.x = of->x;
    view.y = of->y;
    view.z = of->z;
    view.stride = of->stride;
    view.length = of->length;
    return view;
}

/* Deposits, kicks, moves and groups particles; hashes everything. */
static uint64_t simulate(const fixpair_components_f64 *position, const fixpair_components_f64 *velocity) {
    fixpair_positions_f64 place = shown(position), speed = shown(velocity);
    fixpair_brick cells;
    fixpair_layout layout;
    uint64_t labels[FEW], hash = HASH_START;
    double *mesh;
    void *scratch;
    size_t length, i;
    MUST(fixpair_brick_whole(&cells, CELLS, FIXPAIR_SPACE_CONFIGURATION, 0));
    MUST(fixpair_brick_reals(&length, &cells));
    mesh = (double *)take(length * sizeof *mesh);
    MUST(fixpair_kick_scratch_f64(&layout, &cells, FEW, FIXPAIR_WINDOW_PCS));
    scratch = take(layout.size);
    MUST(fixpair_deposit_f64(mesh, length, &cells, &place, NULL, 0, BOX, FIXPAIR_WINDOW_PCS, 0.0, scratch, layout.size, NULL));
    hash = hash_bytes(hash, mesh, length * sizeof *mesh);
    MUST(fixpair_kick_f64(velocity, &place, mesh, mesh, mesh, length, &cells, BOX, FIXPAIR_WINDOW_PCS, 0.0, 0.5, 2.0, 0.0, 0.0, NULL, NULL,
                          scratch, layout.size, NULL));
    give_back(scratch);
    MUST(fixpair_drift_f64(position, &speed, BOX, 0.25, 0.0, 0.0, NULL, NULL, NULL));
    MUST(fixpair_fof_labels_scratch_f64(&layout, FEW));
    scratch = take(layout.size);
    MUST(fixpair_fof_labels_f64(labels, FEW, &place, NULL, 0, BOX, 60.0, scratch, layout.size, NULL));
    give_back(scratch);
    give_back(mesh);
    hash = hash_bytes(hash, labels, sizeof labels);
    for (i = 0; i < FEW; i++) {
        hash = hash_bytes(hash, &position->x[i * position->stride], sizeof(double));
        hash = hash_bytes(hash, &position->z[i * position->stride], sizeof(double));
        hash = hash_bytes(hash, &velocity->y[i * velocity->stride], sizeof(double));
    }
    return hash;
}

static void particles_far_apart(void) {
    double dense[6 * FEW];
    const size_t bytes = (APART * (FEW - 1) + 6) * sizeof(double);
    double *sparse = (double *)reserve(bytes);
    fixpair_components_f64 position[2], velocity[2];
    size_t i, axis;
    int side;
    if (sparse == NULL) {
        printf("skipped: the system does not reserve %zu bytes of address space\n", bytes);
        return;
    }
    position[0] = components(dense, 1, 6);
    velocity[0] = components(dense + 3, 1, 6);
    position[1] = components(sparse, 1, APART);
    velocity[1] = components(sparse + 3, 1, APART);
    for (side = 0; side < 2; side++) {
        double *of[3], *speed[3];
        of[0] = position[side].x, of[1] = position[side].y, of[2] = position[side].z;
        speed[0] = velocity[side].x, speed[1] = velocity[side].y, speed[2] = velocity[side].z;
        for (i = 0; i < FEW; i++) {
            for (axis = 0; axis < 3; axis++) {
                of[axis][i * position[side].stride] = BOX * noise(3 * i + axis);
                speed[axis][i * velocity[side].stride] = 30.0 * noise(100 + 3 * i + axis);
            }
        }
    }
    CHECK(simulate(&position[0], &velocity[0]) == simulate(&position[1], &velocity[1]));
    munmap(sparse, bytes);
}

/* Two rows and two planes of modes 2^32 elements and more apart. */
static void modes_far_apart(void) {
    const size_t start[3] = {3, 7, 2}, count[3] = {2, 2, 5}, near[3] = {10, 5, 1}, far[3] = {(size_t)3 << 32, ((size_t)1 << 32) + 3, 1};
    fixpair_brick brick[2];
    fixpair_realisation realisation;
    uint64_t hash[2];
    int side;
    MUST(fixpair_realisation_init(&realisation, SEED));
    for (side = 0; side < 2; side++) {
        size_t length;
        float *modes;
        brick[side].n = 16;
        brick[side].space = FIXPAIR_SPACE_FOURIER;
        memcpy(brick[side].start, start, sizeof start);
        memcpy(brick[side].count, count, sizeof count);
        memcpy(brick[side].stride, side ? far : near, sizeof near);
        MUST(fixpair_brick_reals(&length, &brick[side]));
        CHECK(side == 0 || length > UINT64_C(1) << 34);
        modes = (float *)reserve(length * sizeof *modes);
        if (modes == NULL) {
            printf("skipped: the system does not reserve %zu bytes of address space\n", length * sizeof *modes);
            return;
        }
        MUST(fixpair_white_modes_f32(modes, length, &brick[side], &realisation, NULL, 0, NULL));
        realisation.phase = FIXPAIR_PHASE_INVERTED;
        MUST(fixpair_impose_f32(modes, length, &brick[side], &realisation, NULL));
        realisation.phase = FIXPAIR_PHASE_ORIGINAL;
        hash[side] = hash_brick(HASH_START, modes, &brick[side], sizeof *modes);
        munmap(modes, length * sizeof *modes);
    }
    CHECK(hash[0] == hash[1]);
}

static void meshes_of_10_18_cells(void) {
    static const size_t sides[2] = {1000000, (size_t)1 << 21};
    fixpair_brick brick, ghosted;
    size_t reals, i;
    uint64_t id;
    for (i = 0; i < 2; i++) {
        const size_t n = sides[i];
        CHECK(fixpair_brick_whole(&brick, n, FIXPAIR_SPACE_CONFIGURATION, 0) == FIXPAIR_ERROR_OVERFLOW);
        MUST(fixpair_brick_slab(&brick, n, FIXPAIR_SPACE_FOURIER, n - 1, 1));
        MUST(fixpair_brick_reals(&reals, &brick));
        CHECK(reals == n * (n + 2));
        MUST(fixpair_brick_transposed_slab(&brick, n, n / 2, 1));
        MUST(fixpair_brick_slab(&brick, n, FIXPAIR_SPACE_CONFIGURATION, n - 1, 1));
        brick.start[1] = brick.start[2] = n - 1;
        brick.count[1] = brick.count[2] = 1;
        MUST(fixpair_particle_ids(&id, 1, &brick, 1, NULL));
        CHECK(id == (uint64_t)n * n * n);
        CHECK(fixpair_particle_ids(&id, 1, &brick, UINT64_MAX, NULL) == FIXPAIR_ERROR_OVERFLOW);
        MUST(fixpair_brick_with_ghosts(&ghosted, &brick, FIXPAIR_WINDOW_CIC, 0.0));
        CHECK(ghosted.start[0] == n - 1 && ghosted.count[0] == 2);
    }
    CHECK(fixpair_brick_slab(&brick, ((size_t)1 << 21) + 2, FIXPAIR_SPACE_FOURIER, 0, 1) == FIXPAIR_ERROR_OVERFLOW);
    CHECK(fixpair_fft_next_side((size_t)1 << 21) == 0);
}

static void sizes_of_10_10_particles(void) {
    const size_t many = (size_t)10000000000;
    fixpair_brick cells;
    fixpair_layout layout[2];
    fixpair_positions_f64 nowhere;
    double mesh[CELLS * CELLS * (CELLS + 2)], place[3] = {0, 0, 0};
    uint64_t label = 0;
    MUST(fixpair_brick_whole(&cells, CELLS, FIXPAIR_SPACE_CONFIGURATION, 0));
    MUST(fixpair_deposit_scratch_f32(&layout[0], &cells, many, FIXPAIR_WINDOW_CIC));
    MUST(fixpair_deposit_scratch_f32(&layout[1], &cells, (size_t)1 << 21, FIXPAIR_WINDOW_CIC));
    CHECK(layout[0].size == layout[1].size);
    MUST(fixpair_kick_scratch_f64(&layout[0], &cells, SIZE_MAX, FIXPAIR_WINDOW_PCS));
    /* 32-bit numbers of particles, as many as there are, and no more. */
    MUST(fixpair_fof_labels_scratch_f32(&layout[0], UINT32_MAX));
    CHECK(layout[0].size >= 24 * (size_t)UINT32_MAX && layout[0].size < 24 * (size_t)UINT32_MAX + 5300000);
    CHECK(fixpair_fof_labels_scratch_f64(&layout[0], many) == FIXPAIR_ERROR_OVERFLOW);
    CHECK(fixpair_halos_scratch(&layout[0], many) == FIXPAIR_ERROR_OVERFLOW);
    CHECK(fixpair_spheres_scratch_f64(&layout[0], SIZE_MAX) == FIXPAIR_ERROR_OVERFLOW);
    /* Elements beyond the address space are not gone for. */
    nowhere.x = place;
    nowhere.y = place + 1;
    nowhere.z = place + 2;
    nowhere.stride = 3;
    nowhere.length = SIZE_MAX / 16;
    CHECK(fixpair_deposit_f64(mesh, sizeof mesh / sizeof *mesh, &cells, &nowhere, NULL, 0, BOX, FIXPAIR_WINDOW_CIC, 0.0, NULL, 0, NULL) ==
          FIXPAIR_ERROR_OVERFLOW);
    nowhere.stride = SIZE_MAX / 2;
    nowhere.length = 3;
    CHECK(fixpair_fof_labels_f64(&label, 1, &nowhere, NULL, 0, BOX, 1.0, NULL, 0, NULL) == FIXPAIR_ERROR_OVERFLOW);
}

int main(void) {
    particles_far_apart();
    modes_far_apart();
    meshes_of_10_18_cells();
    sizes_of_10_10_particles();
    return check_report("sparse");
}
