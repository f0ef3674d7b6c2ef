/*
 * Every function with every bad input: the exact status, and not one byte touched.
 */
#define _POSIX_C_SOURCE 200112L

#include "refusals.h"

/* Small, with planes that are padded, so that "long enough for the modes" and "as long as the transform" differ. */
enum { SIDE = 6, WORK_SIDE = 10, PAD = 2, SHELLS = 3 };

#define P(k) a->p[k]
#define L(k) a->n[k]

#define CALL(name, arguments_of_it) \
    static fixpair_status_t call_##name(const arguments *a) { return fixpair_##name arguments_of_it; }

CALL(brick_whole, (P(0), L(0), a->i[0], L(1)))
CALL(brick_slab, (P(0), L(0), a->i[0], L(1), L(2)))
CALL(brick_transposed_slab, (P(0), L(0), L(1), L(2)))
CALL(brick_reals, (P(0), P(1)))
CALL(exec_self_test, (P(0)))
CALL(threads_create, (P(0), P(1), L(0)))
CALL(realisation_init, (P(0), a->u))
CALL(conditions_init, (P(0), a->u))
CALL(cosmology_init, (P(0)))
CALL(philox4x32_10, (P(0), P(1), P(2)))
CALL(ranlxd1, (P(0), L(0), a->u))
CALL(ngenic_seeds, (P(0), L(0), P(1), a->u))
CALL(radiation_density, (P(0), a->d[0], a->d[1], a->d[2]))
CALL(expansion, (P(0), P(1), L(0), P(2)))
CALL(growth_factors, (P(0), P(1), L(0), P(2)))
CALL(growth_suppression, (P(0), P(1)))
CALL(linear_power, (P(0), P(1), L(0), P(2), P(3), a->d[0]))
CALL(linear_transfer, (P(0), P(1), L(0), P(2), P(3)))
CALL(linear_sigma, (P(0), a->d[0], P(1), P(2)))
CALL(alpha, (P(0), P(1), L(0), P(2), P(3), a->d[0], a->i[0]))
CALL(mode_table_length, (P(0), L(0)))
CALL(potential_amplitude_table, (P(0), L(0), L(1), a->d[0], P(1), P(2), a->i[0], P(3)))
CALL(alpha_table, (P(0), L(0), L(1), a->d[0], P(1), P(2), a->d[1], a->i[0], P(3)))
CALL(particle_ids, (P(0), L(0), P(1), a->u, P(2)))

static void bricks(void) {
    size_t *reals;
    fixpair_brick *brick;

    begin("brick_whole", call_brick_whole);
    STRUCT(0, OUT, fixpair_brick);
    t.a.n[0] = SIDE;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 11);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX / 16);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);

    begin("brick_slab", call_brick_slab);
    STRUCT(0, OUT, fixpair_brick);
    t.a.n[0] = SIDE;
    t.a.n[1] = t.a.n[2] = 2;
    refuse_pointers_and_lengths();
    ACCEPTED(t.a.n[2] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 7);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.n[1] = SIDE);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.n[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);

    begin("brick_transposed_slab", call_brick_transposed_slab);
    STRUCT(0, OUT, fixpair_brick);
    t.a.n[0] = SIDE;
    t.a.n[1] = t.a.n[2] = 2;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 7);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.n[1] = SIDE);
    REFUSED(FIXPAIR_ERROR_BRICK, t.a.n[2] = SIZE_MAX);

    begin("brick_reals", call_brick_reals);
    reals = ARRAY(0, OUT, size_t, 1);
    brick = STRUCT(1, IN, fixpair_brick);
    MUST(fixpair_brick_whole(brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    refuse_pointers_and_lengths();
    CHECK(*reals == 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, brick->n = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, brick->n = 7);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, brick->n = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_CHOICE, brick->space = 2);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->start[1] = 1);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->count[0] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->stride[1] = 1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, brick->stride[0] = SIZE_MAX / 2);
    /* Cells may run over the edge, modes may not. */
    ACCEPTED((brick->space = FIXPAIR_SPACE_CONFIGURATION, brick->start[1] = SIDE - 1));
    REFUSED(FIXPAIR_ERROR_BRICK, (brick->space = FIXPAIR_SPACE_CONFIGURATION, brick->start[1] = SIDE));
    REFUSED(FIXPAIR_ERROR_BRICK, (brick->space = FIXPAIR_SPACE_CONFIGURATION, brick->count[0] = SIDE + 1));
}

static int32_t twice_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    size_t i;
    (void)context;
    for (i = 0; i < count; i++) {
        body(argument, i);
    }
    if (count > 0) {
        body(argument, 0);
    }
    return 0;
}

/* One index too often and one too seldom. */
static int32_t uneven_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
    size_t i;
    (void)context;
    for (i = 0; i < count; i++) {
        body(argument, i > 0 ? i - 1 : 0);
    }
    return 0;
}

static void threads(void) {
    fixpair_exec *exec;
    begin("exec_self_test", call_exec_self_test);
    exec_at(0);
    exec = (fixpair_exec *)t.a.p[0];
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_HOOK, exec->parallel_for = twice_for);
    REFUSED(FIXPAIR_ERROR_HOOK, exec->parallel_for = uneven_for);

    begin("threads_create", call_threads_create);
    ARRAY(0, OUT, fixpair_threads *, 1);
    STRUCT(1, OUT, fixpair_exec);
    memcpy(t.pristine, t.memory, ARENA);
    t.a.n[0] = 2;
    t.good = t.a;
    pointer_fault(FIXPAIR_ERROR_NULL, 0, NULL, "null");
    pointer_fault(FIXPAIR_ERROR_NULL, 1, NULL, "null");
    pointer_fault(FIXPAIR_ERROR_ALIGNMENT, 0, (char *)t.good.p[0] + 1, "misaligned");
    pointer_fault(FIXPAIR_ERROR_ALIGNMENT, 1, (char *)t.good.p[1] + 1, "misaligned");
    pointer_fault(FIXPAIR_ERROR_OVERLAP, 1, t.good.p[0], "is pointer 0");
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = 4097);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[0] = SIZE_MAX);
}

static void seed_tables(void) {
    fixpair_brick *brick;
    begin("ngenic_seeds", call_ngenic_seeds);
    ARRAY(0, OUT, uint32_t, SIDE * SIDE);
    brick = STRUCT(1, IN, fixpair_brick);
    MUST(fixpair_brick_whole(brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
    length(0, SIDE * SIDE, EXACT);
    refuse_pointers_and_lengths();
    ACCEPTED((brick->count[1] = 0, t.a.p[0] = NULL, t.a.n[0] = 0));
    REFUSED(FIXPAIR_ERROR_LENGTH, brick->count[1] = 1);
    refuse_bricks(brick);
}

static void initialisers(void) {
    begin("realisation_init", call_realisation_init);
    STRUCT(0, OUT, fixpair_realisation);
    refuse_pointers_and_lengths();
    begin("conditions_init", call_conditions_init);
    STRUCT(0, OUT, fixpair_conditions);
    refuse_pointers_and_lengths();
    begin("cosmology_init", call_cosmology_init);
    STRUCT(0, OUT, fixpair_cosmology);
    refuse_pointers_and_lengths();
    begin("philox4x32_10", call_philox4x32_10);
    ARRAY(0, OUT, uint32_t, 4);
    ARRAY(1, IN, uint32_t, 4);
    ARRAY(2, IN, uint32_t, 2);
    refuse_pointers_and_lengths();
    begin("ranlxd1", call_ranlxd1);
    ARRAY(0, OUT, double, 20);
    length(0, 20, FREE);
    refuse_pointers_and_lengths();
    ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL));
    begin("mode_table_length", call_mode_table_length);
    ARRAY(0, OUT, size_t, 1);
    t.a.n[0] = SIDE;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[0] = 7);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[0] = SIZE_MAX - 1);
}

static void backgrounds(void) {
    double *a;
    int i, which;
    begin("radiation_density", call_radiation_density);
    ARRAY(0, OUT, double, 1);
    t.a.d[0] = 2.7255;
    t.a.d[1] = 3.046;
    t.a.d[2] = 0.7;
    refuse_pointers_and_lengths();
    for (i = 0; i < 3; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = -1.0);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[2] = 0.0);
    for (which = 0; which < 2; which++) {
        begin(which ? "growth_factors" : "expansion", which ? call_growth_factors : call_expansion);
        argument(0, OUT, 3 * (which ? sizeof(fixpair_growth) : sizeof(double)), sizeof(double));
        a = ARRAY(1, IN, double, 3);
        a[0] = 1.0;
        a[1] = 0.1;
        a[2] = 0.5;
        MUST(fixpair_cosmology_init(STRUCT(2, IN, fixpair_cosmology)));
        length(0, 3, FREE);
        refuse_pointers_and_lengths();
        ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL, t.a.p[1] = NULL));
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, a[2] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, a[2] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, a[2] = 0.0);
        REFUSED(FIXPAIR_ERROR_RANGE, a[2] = -1.0);
        REFUSED(FIXPAIR_ERROR_RANGE, a[2] = 11.0);
        refuse_cosmologies((fixpair_cosmology *)t.a.p[2]);
    }
    begin("growth_suppression", call_growth_suppression);
    ARRAY(0, OUT, double, 1);
    MUST(fixpair_cosmology_init(STRUCT(1, IN, fixpair_cosmology)));
    refuse_pointers_and_lengths();
    refuse_cosmologies((fixpair_cosmology *)t.a.p[1]);
}

static void refuse_redshifts(int d) {
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[d] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[d] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = -1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = -0.99);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = 1e9);
}

static void refuse_conventions(void) {
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
}

/* linear_power, linear_transfer, alpha: out, k, len, cosmology, linear, ... */
static void spectra(void) {
    static const call_function calls[3] = {call_linear_power, call_linear_transfer, call_alpha};
    static const char *const names[3] = {"linear_power", "linear_transfer", "alpha"};
    int which;
    for (which = 0; which < 3; which++) {
        double *k;
        begin(names[which], calls[which]);
        ARRAY(0, OUT, double, 3);
        k = ARRAY(1, IN, double, 3);
        k[0] = 0.2;
        k[1] = 1e-3;
        k[2] = 0.1;
        spectrum_at(2);
        length(0, 3, FREE);
        refuse_pointers_and_lengths();
        ACCEPTED((t.a.n[0] = 0, t.a.p[0] = NULL, t.a.p[1] = NULL));
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, k[2] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_RANGE, k[2] = 0.0);
        REFUSED(FIXPAIR_ERROR_RANGE, k[2] = -0.1);
        refuse_cosmologies((fixpair_cosmology *)t.a.p[2]);
        refuse_linears((fixpair_linear *)t.a.p[3], t.a.p[0]);
        if (which != 1) {
            refuse_redshifts(0);
        }
        if (which == 2) {
            refuse_conventions();
        }
    }
    begin("linear_sigma", call_linear_sigma);
    ARRAY(0, OUT, double, 1);
    spectrum_at(1);
    t.a.d[0] = 8.0;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -8.0);
    refuse_cosmologies((fixpair_cosmology *)t.a.p[1]);
    refuse_linears((fixpair_linear *)t.a.p[2], t.a.p[0]);
}

static void mode_tables(void) {
    int which;
    size_t entries;
    MUST(fixpair_mode_table_length(&entries, SIDE));
    for (which = 0; which < 2; which++) {
        begin(which ? "alpha_table" : "potential_amplitude_table",
              which ? call_alpha_table : call_potential_amplitude_table);
        ARRAY(0, OUT, double, entries);
        spectrum_at(1);
        exec_at(3);
        length(0, entries, EXACT);
        t.a.n[1] = SIDE;
        t.a.d[0] = BOX;
        refuse_pointers_and_lengths();
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 0);
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 7);
        REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX - 1);
        REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = SIDE + 2);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
        refuse_cosmologies((fixpair_cosmology *)t.a.p[1]);
        refuse_linears((fixpair_linear *)t.a.p[2], t.a.p[0]);
        refuse_conventions();
        if (which) {
            refuse_redshifts(1);
        }
    }
}

static void ids(void) {
    fixpair_brick *brick;
    begin("particle_ids", call_particle_ids);
    ARRAY(0, OUT, uint64_t, SIDE * SIDE * SIDE);
    brick = STRUCT(1, IN, fixpair_brick);
    exec_at(2);
    MUST(fixpair_brick_whole(brick, SIDE, FIXPAIR_SPACE_CONFIGURATION, 0));
    length(0, SIDE * SIDE * SIDE, EXACT);
    refuse_pointers_and_lengths();
    refuse_bricks(brick);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.u = UINT64_MAX);
    ACCEPTED((brick->count[0] = 0, t.a.n[0] = 0, t.a.p[0] = NULL));
}

CALL(shape_rows, (P(0), L(0), P(1), a->i[0]))

static void rows_of_shapes(void) {
    begin("shape_rows", call_shape_rows);
    argument(0, OUT, 8 * sizeof(fixpair_shape_row), sizeof(double));
    STRUCT(1, OUT, size_t);
    length(0, 8, FREE);
    t.a.i[0] = FIXPAIR_SHAPE_ORTHOGONAL_LSS;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = FIXPAIR_SHAPE_ROWS);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
    /* The number of rows is told all the same. */
    SPOILED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 7);
    SPOILED(FIXPAIR_ERROR_LENGTH, (t.a.n[0] = 0, t.a.p[0] = NULL));
}

#include "refusals_bins.h"
#include "refusals_species.h"
#include "refusals_steps.h"
#include "refusals_variance.h"
#include "refusals_scatter.h"
#include "refusals_bias.h"
#include "refusals_posterior.h"
#include "refusals_matched.h"

#define REAL float
#define X(name) name##_f32
#define SUFFIX "_f32"
#include "refusals_real.h"
#include "refusals_stages.h"
#include "refusals_shape.h"
#include "refusals_estimate.h"
#include "refusals_gravity.h"
#include "refusals_run.h"
#include "refusals_halos.h"
#include "refusals_initial.h"
#undef REAL
#undef X
#undef SUFFIX

#define REAL double
#define X(name) name##_f64
#define SUFFIX "_f64"
#include "refusals_real.h"
#include "refusals_stages.h"
#include "refusals_shape.h"
#include "refusals_estimate.h"
#include "refusals_gravity.h"
#include "refusals_run.h"
#include "refusals_halos.h"
#include "refusals_initial.h"

int main(void) {
    t.memory = (unsigned char *)take(ARENA);
    t.pristine = (unsigned char *)take(ARENA);
    t.before = (unsigned char *)take(ARENA);
    bricks();
    threads();
    initialisers();
    seed_tables();
    backgrounds();
    spectra();
    mode_tables();
    ids();
    ghosts_of_bricks();
    edges_of_bins();
    binnings();
    scratch_of_sums();
    lists_of_triangles();
    counts_of_triangles();
    numbers_of_triangles();
    refuse_transforms_f32();
    refuse_transforms_f64();
    refuse_modes_f32();
    refuse_modes_f64();
    refuse_stages_f32();
    refuse_stages_f64();
    rows_of_shapes();
    refuse_shapes_f32();
    refuse_shapes_f64();
    refuse_universes_f32();
    refuse_universes_f64();
    refuse_particles_f32();
    refuse_particles_f64();
    refuse_spectra_f32();
    refuse_spectra_f64();
    refuse_bispectra_f32();
    refuse_bispectra_f64();
    factors_of_steps();
    densities_of_halos();
    groups_of_processes();
    refuse_scatter();
    refuse_bias();
    refuse_matched();
    refuse_forces_f32();
    refuse_forces_f64();
    refuse_kicks_f32();
    refuse_kicks_f64();
    refuse_runs_f32();
    refuse_runs_f64();
    refuse_groups_f32();
    refuse_groups_f64();
    refuse_catalogues_f32();
    refuse_catalogues_f64();
    refuse_spheres_f32();
    refuse_spheres_f64();
    species();
    refuse_beyond_second_order_f32();
    refuse_beyond_second_order_f64();
    give_back(t.memory);
    give_back(t.pristine);
    give_back(t.before);
    return check_report("refusals");
}
