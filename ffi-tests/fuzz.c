/*
 * Some thousand sets of parameters that nobody would choose: sizes, enumerations and numbers, never pointers. Every function that takes
 * such answers with one of its statuses, and no answer is a crash. The sequence is always the same.
 *
 * fuzz [ROUNDS]
 */
#define _POSIX_C_SOURCE 200112L

#include <float.h>
#include <math.h>

#include "check.h"

enum { ROUNDS = 4000, LENGTH = 4096, VALUES = 8 };

static uint64_t state = 1;

/* splitmix64. */
static uint64_t word(void) {
    uint64_t z = (state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static size_t size(void) {
    static const size_t special[] = {0, 1, 2, 3, 4, 6, 8, 10, 11, 12, 14, 22, 64, 4096, SIZE_MAX, SIZE_MAX - 1,
                                     SIZE_MAX / 2, SIZE_MAX / 2 + 1, SIZE_MAX / 16, (size_t)1 << 20, (size_t)1 << 21};
    size_t value = (size_t)word();
    switch (word() % 4) {
    case 0:
        return value >> (word() % (sizeof(size_t) * 8));
    case 1:
        return value % 16;
    default:
        return special[value % (sizeof special / sizeof *special)];
    }
}

static int32_t choice(void) {
    return word() % 4 == 0 ? (int32_t)(uint32_t)(word() >> 33) - 1 : (int32_t)(word() % 5);
}

static double number(void) {
    static const double special[] = {0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, DBL_MIN, DBL_MAX, -DBL_MAX, DBL_EPSILON,
                                     0.3, 0.7, 8.0, 50.0, 5e-324};
    double value;
    uint64_t bits = word();
    switch (word() % 6) {
    case 0:
        /* Any double at all. */
        memcpy(&value, &bits, sizeof value);
        return value;
    case 1:
        return (double)NAN;
    case 2:
        return word() % 2 ? (double)INFINITY : -(double)INFINITY;
    case 3:
        return (double)(bits >> 11) / 9007199254740992.0;
    default:
        return special[bits % (sizeof special / sizeof *special)];
    }
}

/* One in three numbers is spoiled, so that some sets get far. */
static double maybe(double good) {
    return word() % 3 ? good : number();
}

static fixpair_brick brick(void) {
    fixpair_brick result;
    size_t n = word() % 2 ? 2 * (word() % 8) : size();
    int axis;
    if (word() % 2 && fixpair_brick_slab(&result, n, choice(), size(), size()) == FIXPAIR_OK) {
        return result;
    }
    result.n = n;
    result.space = choice();
    for (axis = 0; axis < 3; axis++) {
        result.start[axis] = word() % 2 ? 0 : size();
        result.count[axis] = size();
        result.stride[axis] = size();
    }
    return result;
}

static void sane(fixpair_status_t status) {
    CHECK(status <= 0 && status >= FIXPAIR_ERROR_SINGULAR);
}

static void meshes(double *data, float *single) {
    fixpair_brick b = brick(), c = brick();
    fixpair_realisation realisation;
    fixpair_components_f64 particles[2];
    uint64_t *ids = (uint64_t *)data;
    size_t reals;
    MUST(fixpair_realisation_init(&realisation, word()));
    if (word() % 3 == 0) {
        realisation.amplitude = choice();
        realisation.phase = choice();
        realisation.nyquist = choice();
        realisation.selection = choice();
        realisation.sample = (uint32_t)size();
    }
    /* Of any brick of a large mesh, these draw the whole table of seeds. */
    if (b.n <= 64) {
        realisation.scheme = choice();
        reals = word() % 4 == 0 ? size() : b.count[0] * b.count[1];
        sane(fixpair_ngenic_seeds((uint32_t *)data, reals % LENGTH, &b, word()));
    }
    sane(fixpair_ranlxd1(data, size() % LENGTH, word()));
    sane(fixpair_brick_whole(&c, size(), choice(), size()));
    sane(fixpair_brick_slab(&c, size(), choice(), size(), size()));
    sane(fixpair_brick_transposed_slab(&c, size(), size(), size()));
    sane(fixpair_brick_reals(&reals, &b));
    sane(fixpair_white_modes_f64(data, LENGTH, &b, &realisation, NULL, 0, NULL));
    sane(fixpair_white_modes_f32(single, LENGTH, &b, &realisation, NULL, 0, NULL));
    sane(fixpair_impose_f64(data, LENGTH, &b, &realisation, NULL));
    sane(fixpair_scale_modes_f64(data, LENGTH, &b, data + LENGTH, LENGTH, NULL));
    c = brick();
    sane(fixpair_copy_modes_f64(data, LENGTH, &b, data + LENGTH, LENGTH, &c, NULL));
    sane(fixpair_particle_ids(ids, b.count[0] % 9 * (b.count[1] % 9) * (b.count[2] % 9), &b, word(), NULL));
    for (reals = 0; reals < 2; reals++) {
        particles[reals].x = data + reals * 1536;
        particles[reals].y = particles[reals].x + 1;
        particles[reals].z = particles[reals].x + 2;
        particles[reals].stride = 3;
        particles[reals].length = b.count[0] % 9 * (b.count[1] % 9) * (b.count[2] % 9) % 513;
    }
    sane(fixpair_displace_f64(&particles[0], &particles[1], data + LENGTH, NULL, LENGTH, &b, size(), maybe(100.0),
                              maybe(1.0), maybe(1.0), NULL));
}

static void sizes(void) {
    fixpair_layout layout;
    size_t length, side = fixpair_fft_next_side(size());
    CHECK(side % 2 == 0);
    (void)fixpair_fft_padding_f32(size());
    (void)fixpair_fft_padding_f64(size());
    CHECK(fixpair_status_message((fixpair_status_t)(word() >> 33)) != NULL);
    sane(fixpair_fft_tables_scratch_f32(&layout, size()));
    sane(fixpair_fft_tables_scratch_f64(&layout, size()));
    sane(fixpair_fft_scratch_f32(&layout, size()));
    sane(fixpair_fft_scratch_f64(&layout, size()));
    sane(fixpair_mode_table_length(&length, size()));
}

/* Rows that nobody would choose: exponents that sum to 0 now and then. */
static void shapes(double *data, void *scratch, size_t scratch_len, const fixpair_fft_f64 *fft) {
    fixpair_brick b = brick();
    fixpair_shape_row rows[8];
    fixpair_layout layout;
    size_t count, i;
    sane(fixpair_shape_rows(rows, 8, &count, choice()));
    MUST(fixpair_shape_rows(rows, 8, &count, FIXPAIR_SHAPE_ORTHOGONAL_LSS));
    for (i = 0; i < 8; i++) {
        if (word() % 4 == 0) {
            rows[i].coefficient = number();
            rows[i].s_a = maybe(8.0 * (double)(word() % 3) - 8.0);
            rows[i].s_b = maybe(0.5);
            rows[i].s_out = -(rows[i].s_a + rows[i].s_b);
        }
    }
    if (word() % 2) {
        MUST(fixpair_brick_whole(&b, 8, FIXPAIR_SPACE_FOURIER, 0));
    }
    sane(fixpair_add_shape_scratch_f64(&layout, &b, fft));
    sane(fixpair_add_shape_f64(data, LENGTH, &b, maybe(100.0), maybe(0.96), rows, word() % 9, fft, scratch, scratch_len,
                               NULL));
}

static void universes(double *data, void *scratch, size_t scratch_len, const fixpair_fft_f64 *fft) {
    fixpair_conditions conditions;
    fixpair_components_f64 position, velocity;
    fixpair_growth growth[VALUES];
    double *members, *out = data + 2 * LENGTH, *in = out + VALUES, value;
    size_t i, table;
    MUST(fixpair_conditions_init(&conditions, word()));
    members = &conditions.cosmology.omega_m;
    if (word() % 2) {
        members[word() % 9] = number();
    }
    if (word() % 8 == 0) {
        for (i = 0; i < 9; i++) {
            members[i] = number();
        }
    }
    if (word() % 4 == 0) {
        conditions.linear.source = choice();
        conditions.linear.normalisation = choice();
    }
    conditions.linear.amount = maybe(0.8);
    conditions.redshift = maybe(32.0);
    conditions.box_size = maybe(100.0);
    conditions.f_nl = maybe(100.0);
    conditions.g_nl = maybe(0.0);
    if (word() % 4 == 0) {
        conditions.convention = choice();
        conditions.order = choice();
    }
    for (i = 0; i < VALUES; i++) {
        in[i] = word() % 8 ? (double)(i + 1) / 8.0 : number();
    }
    sane(fixpair_radiation_density(&value, maybe(2.7), maybe(3.0), maybe(0.7)));
    sane(fixpair_expansion(out, in, VALUES, &conditions.cosmology));
    sane(fixpair_growth_factors(growth, in, VALUES, &conditions.cosmology));
    sane(fixpair_growth_suppression(&value, &conditions.cosmology));
    sane(fixpair_linear_power(out, in, VALUES, &conditions.cosmology, &conditions.linear, maybe(1.0)));
    sane(fixpair_linear_transfer(out, in, VALUES, &conditions.cosmology, &conditions.linear));
    sane(fixpair_linear_sigma(&value, maybe(8.0), &conditions.cosmology, &conditions.linear));
    sane(fixpair_alpha(out, in, VALUES, &conditions.cosmology, &conditions.linear, maybe(1.0), choice()));
    shapes(data, scratch, scratch_len, fft);
    MUST(fixpair_mode_table_length(&table, 8));
    sane(fixpair_potential_amplitude_table(data, table, 8, maybe(100.0), &conditions.cosmology, &conditions.linear,
                                           choice(), NULL));
    sane(fixpair_alpha_table(data, table, 8, maybe(100.0), &conditions.cosmology, &conditions.linear, maybe(1.0),
                             choice(), NULL));
    position.x = data;
    position.y = data + 1;
    position.z = data + 2;
    position.stride = 3;
    position.length = 512;
    velocity = position;
    velocity.x = data + LENGTH;
    velocity.y = velocity.x + 1;
    velocity.z = velocity.x + 2;
    {
        fixpair_status_t status =
            fixpair_initial_conditions_f64(&position, &velocity, &conditions, fft, NULL, scratch, scratch_len, NULL);
        sane(status);
        if (status == FIXPAIR_OK) {
            int sound = 1;
            for (i = 0; i < 3 * 512; i++) {
                sound &= position.x[i] >= 0 && position.x[i] < conditions.box_size && isfinite(velocity.x[i]);
            }
            CHECK(sound);
        }
    }
}

#include "fuzz_estimate.h"
#include "fuzz_gravity.h"
#include "fuzz_initial.h"
#include "fuzz_variance.h"

int main(int count, char **arguments) {
    double *data = (double *)take((2 * LENGTH + 2 * VALUES) * sizeof *data);
    float *single = (float *)take(LENGTH * sizeof *single);
    double *memory = (double *)take(BYTES);
    int64_t *sums = (int64_t *)take(WORDS * sizeof *sums);
    fixpair_conditions conditions;
    fixpair_fft_f64 fft;
    fixpair_layout layout, work;
    void *tables, *workspace, *scratch;
    const long rounds = count > 1 ? strtol(arguments[1], NULL, 10) : ROUNDS;
    long round;
    MUST(fixpair_fft_tables_scratch_f64(&layout, 8));
    MUST(fixpair_fft_scratch_f64(&work, 8));
    tables = take(layout.size);
    workspace = take(work.size);
    MUST(fixpair_fft_tables_init_f64(tables, layout.size, 8));
    MUST(fixpair_fft_init_f64(&fft, tables, layout.size, 0, workspace, work.size, NULL));
    MUST(fixpair_conditions_init(&conditions, 1));
    MUST(fixpair_initial_conditions_scratch_f64(&layout, &conditions, &fft, NULL));
    scratch = take(layout.size);
    for (round = 0; round < rounds; round++) {
        sizes();
        meshes(data, single);
        clouds(data, single, memory);
        estimates(data, single, memory, sums);
        forces(data, single, memory);
        groups(data, memory);
        statistics(memory);
        if (round % 8 == 0) {
            universes(data, scratch, layout.size, &fft);
            beginnings(data, memory, &fft);
            bispectra(data, memory, sums, &fft);
            runs(data, memory, &fft);
        }
        memset(data, 0, (2 * LENGTH + 2 * VALUES) * sizeof *data);
        CHECK_CANARIES(data);
        CHECK_CANARIES(single);
        CHECK_CANARIES(memory);
        CHECK_CANARIES(sums);
    }
    give_back(data);
    give_back(single);
    give_back(memory);
    give_back(sums);
    give_back(tables);
    give_back(workspace);
    give_back(scratch);
    return check_report("fuzz");
}
