#include "budget.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"

#define PI 3.14159265358979323846

/* Pairs of labels over copies of particles at z = 0, as mpi_pm --report finds them; and bytes of one, with its place in the map. */
#define PAIRS 0.06
#define PAIR 48.0

/* The share of `whole` that FFTW-MPI gives a process. */
static uint64_t block(uint64_t whole, const struct slabs *slabs) {
    uint64_t ranks = (uint64_t)slabs->ranks, size = (whole + ranks - 1) / ranks, first = size * (uint64_t)slabs->rank;
    return first >= whole ? 0 : first + size > whole ? whole - first : size;
}

/* FFTW-MPI turns a matrix of m planes and some columns over: of rows of modes to leave it transposed, of single modes to turn it back. */
uint64_t budget_transform(const struct fftw_slabs *fft) {
    uint64_t m = fft->slabs.n, modes = m / 2 + 1, planes = slabs_planes(&fft->slabs, fft->slabs.rank);
    uint64_t columns = block(m * modes, &fft->slabs);
    if (fft->transposed) return 2 * sizeof(double) * planes * (m - fft->rows) * modes;
    return 2 * sizeof(double) * (planes * (m * modes - columns) + columns * (m - planes));
}

static uint64_t planes_of(const struct ghost_message *messages, size_t count) {
    uint64_t planes = 0;
    for (size_t i = 0; i < count; i++) planes += messages[i].planes;
    return planes;
}

uint64_t budget_ghosts(const struct ghosts *ghosts) {
    uint64_t fold = planes_of(ghosts->theirs, ghosts->theirs_len), fill = planes_of(ghosts->mine, ghosts->mine_len);
    return (fold + 3 * fill) * ghosts->plane * sizeof(double);
}

double budget_moved(const struct slabs *slabs, double box_size, double mean_displacement, double growth) {
    int borders = 0;
    for (int rank = 0; rank < slabs->ranks; rank++) borders += slabs_planes(slabs, rank) > 0;
    return borders < 2 ? 0.0 : borders * mean_displacement * growth / box_size;
}

/* ---- A run that does not fit here. */

/* A hook that is only asked for its bricks. */
static int32_t no_transform(void *context, double *data) {
    (void)context;
    (void)data;
    return 1;
}

static int32_t no_transform_f32(void *context, float *data) {
    (void)context;
    (void)data;
    return 1;
}

/* What the library asks for, on the first slab. */
struct asked {
    struct fixpair_layout start, deposit, power, labels, halos;
    size_t words;
};

static int ask_start(struct asked *asked, size_t n, size_t planes, int single) {
    struct fixpair_conditions conditions;
    struct fixpair_brick cells, modes;
    TRY(fixpair_conditions_init(&conditions, 1));
    TRY(fixpair_brick_slab(&cells, n, FIXPAIR_SPACE_CONFIGURATION, 0, planes));
    TRY(fixpair_brick_transposed_slab(&modes, n, 0, planes));
    struct fixpair_fft_f64 wide = {sizeof wide, NULL, no_transform, no_transform, NULL, cells, modes, planes * n * (n + 2)};
    struct fixpair_fft_f32 narrow = {sizeof narrow, NULL, no_transform_f32, no_transform_f32, NULL, cells, modes, wide.length};
    if (single) {
        TRY(fixpair_initial_conditions_scratch_f32(&asked->start, &conditions, &narrow, NULL));
    } else {
        TRY(fixpair_initial_conditions_scratch_f64(&asked->start, &conditions, &wide, NULL));
    }
    return 0;
}

static int ask_power(struct asked *asked, size_t m, size_t planes) {
    struct fixpair_brick modes;
    struct fixpair_binning binning;
    size_t bins, values, shells = m / 2 - 1;
    uint64_t *edges = malloc((shells + 1) * sizeof *edges);
    int32_t outcome = edges == NULL;
    if (outcome == 0) outcome = fixpair_brick_transposed_slab(&modes, m, 0, planes);
    if (outcome == 0) outcome = fixpair_edges_uniform(edges, shells + 1, 1.0, 1.0);
    if (outcome == 0) outcome = fixpair_binning_init(&binning, edges, shells + 1);
    if (outcome == 0) outcome = fixpair_binning_lengths(&bins, &values, &asked->words, &binning, 1);
    if (outcome == 0) outcome = fixpair_power_sums_scratch(&asked->power, &modes, &binning, 1);
    free(edges);
    TRY(outcome);
    return 0;
}

static int ask(struct asked *asked, size_t n, size_t mesh_factor, size_t ranks, size_t particles, int32_t window, int single) {
    struct fixpair_brick cells, region;
    size_t m = mesh_factor * n, planes = (m + ranks - 1) / ranks;
    TRY(ask_start(asked, n, (n + ranks - 1) / ranks, single));
    TRY(ask_power(asked, m, planes));
    TRY(fixpair_brick_slab(&cells, m, FIXPAIR_SPACE_CONFIGURATION, 0, planes));
    TRY(fixpair_brick_with_ghosts(&region, &cells, window, 0.0));
    TRY(fixpair_halos_scratch(&asked->halos, particles));
    if (single) {
        TRY(fixpair_kick_scratch_f32(&asked->deposit, &region, particles, window));
        TRY(fixpair_fof_labels_scratch_f32(&asked->labels, particles));
    } else {
        TRY(fixpair_kick_scratch_f64(&asked->deposit, &region, particles, window));
        TRY(fixpair_fof_labels_scratch_f64(&asked->labels, particles));
    }
    return 0;
}

/* In linear theory at z = 0: <|psi_x|>, and the r.m.s. contrast of the mean density of a slab. */
struct theory {
    double displacement, slab;
};

/* <psi_x^2> = int P dk/(6 pi^2); a slab's mean has the modes along x alone, times sinc(k D/2), D its depth. */
static int predict(struct theory *theory, double box_size, double depth) {
    enum { POINTS = 2000 };
    struct fixpair_conditions conditions;
    double k[POINTS], power[POINTS], least = 1e-5, ratio = pow(1e7, 1.0 / (POINTS - 1)), square = 0.0, variance = 0.0;
    TRY(fixpair_conditions_init(&conditions, 1));
    for (size_t i = 0; i < POINTS; i++) k[i] = least * pow(ratio, (double)i);
    TRY(fixpair_linear_power(power, k, POINTS, &conditions.cosmology, &conditions.linear, 0.0));
    for (size_t i = 0; i < POINTS; i++) square += power[i] * k[i] * log(ratio) / (6.0 * PI * PI);
    for (size_t i = 0; i < POINTS; i++) k[i] = 2.0 * PI / box_size * (double)(i + 1);
    TRY(fixpair_linear_power(power, k, POINTS, &conditions.cosmology, &conditions.linear, 0.0));
    for (size_t i = 0; i < POINTS; i++) {
        double half = 0.5 * k[i] * depth;
        variance += 2.0 * power[i] / pow(box_size, 3.0) * pow(sin(half) / half, 2.0);
    }
    theory->displacement = sqrt(2.0 / PI * square);
    theory->slab = sqrt(variance);
    return 0;
}

static void line(FILE *stream, const char *what, const double bytes[2]) {
    fprintf(stream, "    %-52s %9.3f %9.3f\n", what, bytes[0] * 1e-9, bytes[1] * 1e-9);
}

int budget_print(FILE *stream, size_t n, size_t mesh_factor, size_t ranks, double box_size) {
    enum { STEPS = 20 };
    int32_t window = mesh_factor == 1 ? FIXPAIR_WINDOW_PCS : FIXPAIR_WINDOW_CIC;
    double m = (double)(mesh_factor * n), planes = ceil(m / (double)ranks), ghosts = mesh_factor == 1 ? 3.0 : 1.0;
    double count = pow((double)n, 3.0) / (double)ranks, spacing = box_size / (double)n, depth = box_size / (double)ranks;
    double lines[11][2], scale_factors[STEPS + 1], growth = 0.0;
    struct fixpair_growth at[STEPS + 1];
    struct fixpair_conditions conditions;
    struct theory theory;
    TRY(predict(&theory, box_size, depth));
    TRY(fixpair_conditions_init(&conditions, 1));
    TRY(fixpair_linear_steps(scale_factors, STEPS + 1, 1.0 / 33.0, 1.0));
    TRY(fixpair_growth_factors(at, scale_factors, STEPS + 1, &conditions.cosmology));
    for (size_t i = 0; i < STEPS; i++) growth = fmax(growth, at[i + 1].d - at[i].d);
    double moved = fmin(1.0, theory.displacement * growth / depth), copies = 0.2 * spacing / depth;
    for (int column = 0; column < 2; column++) {
        struct asked asked;
        double w = column == 0 ? sizeof(float) : sizeof(double), s = 6.0 * w + sizeof(uint64_t), plane = w * m * (m + 2.0);
        TRY(ask(&asked, n, mesh_factor, ranks, (size_t)(count * (1.0 + copies)), window, column == 0));
        lines[0][column] = s * count;
        lines[1][column] = (3.0 * (planes + ghosts) + ghosts) * plane;
        lines[2][column] = (double)asked.deposit.size;
        lines[3][column] = (double)asked.power.size;
        lines[4][column] = (double)asked.start.size;
        lines[5][column] = 16.0 * count * (1.0 + copies) + s * count * copies + fmax((double)asked.labels.size, (double)asked.halos.size);
        lines[6][column] = PAIR * PAIRS * 0.2 * (double)n * (double)n * (double)ranks;
        lines[7][column] = 4.0 * planes * (1.0 - planes / m) * plane;
        lines[8][column] = 4.0 * ghosts * plane;
        lines[9][column] = moved * s * count;
        lines[10][column] = 8.0 * (double)asked.words;
    }
    fprintf(stream, "\n%lu^3 particles, %.0f^3 cells, %lu processes, %.0f planes each, box of %.0f Mpc/h; GB (1e9 bytes) a process\n",
            (unsigned long)n, m, (unsigned long)ranks, planes, box_size);
    fprintf(stream, "    %-52s %9s %9s\n", "", "single", "double");
    line(stream, "particles, s n^3/R", lines[0]);
    line(stream, "three meshes and ghosts, w (3 (p + d) + d) m (m + 2)", lines[1]);
    line(stream, "scratch of deposit and kick", lines[2]);
    line(stream, "scratch of P(k)", lines[3]);
    line(stream, "scratch of the initial conditions, before the meshes", lines[4]);
    line(stream, "halos, in place of the meshes: labels and scratch", lines[5]);
    line(stream, "halos: pairs of labels of all processes", lines[6]);
    line(stream, "sent a step: transforms, 4 w p (m - p) (m + 2)", lines[7]);
    line(stream, "sent a step: ghosts, 4 w d m (m + 2)", lines[8]);
    line(stream, "sent a step: particles, s n^3/R (R/L) <|psi_x|> dD", lines[9]);
    line(stream, "sent a step: P(k)", lines[10]);
    fprintf(stream, "    <|psi_x|> is %.2f Mpc/h at z = 0, the largest of %d steps moves %.1f%% of the particles;\n", theory.displacement,
            (int)STEPS, 100.0 * moved);
    fprintf(stream, "    slabs of %.2f Mpc/h hold particles in number within %.1f%% (r.m.s.) of the mean at z = 0\n", depth,
            100.0 * theory.slab);
    return 0;
}
