/*
 * What every ..._scratch function of a mesh or of particles asks for, on n^3 cells and n^3 particles, in bytes a cell or a particle:
 * the tables of docs/speed-and-memory.md. Nothing is allocated; a hook that transforms nothing stands for the transform.
 *
 *     cc -std=c99 -I../include print_memory.c ../target/release/libfixpair.a -lpthread -ldl -lm && ./a.out
 */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixpair.h"

enum { SIDES = 5 };

static const size_t sides[SIDES] = {64, 128, 256, 512, 1024};

static int32_t nothing_f32(void *context, float *data) {
    (void)context;
    (void)data;
    return 0;
}

static int32_t nothing_f64(void *context, double *data) {
    (void)context;
    (void)data;
    return 0;
}

static void need(int32_t status) {
    if (status == FIXPAIR_OK) return;
    fprintf(stderr, "%s\n", fixpair_status_message(status));
    exit(EXIT_FAILURE);
}

static struct fixpair_fft_f32 hook_f32(size_t n) {
    struct fixpair_fft_f32 fft;
    memset(&fft, 0, sizeof fft);
    fft.struct_size = sizeof fft;
    fft.forward = fft.inverse = nothing_f32;
    need(fixpair_brick_whole(&fft.configuration, n, FIXPAIR_SPACE_CONFIGURATION, 0));
    need(fixpair_brick_whole(&fft.fourier, n, FIXPAIR_SPACE_FOURIER, 0));
    need(fixpair_brick_reals(&fft.length, &fft.fourier));
    return fft;
}

static struct fixpair_fft_f64 hook_f64(size_t n) {
    struct fixpair_fft_f64 fft;
    memset(&fft, 0, sizeof fft);
    fft.struct_size = sizeof fft;
    fft.forward = fft.inverse = nothing_f64;
    need(fixpair_brick_whole(&fft.configuration, n, FIXPAIR_SPACE_CONFIGURATION, 0));
    need(fixpair_brick_whole(&fft.fourier, n, FIXPAIR_SPACE_FOURIER, 0));
    need(fixpair_brick_reals(&fft.length, &fft.fourier));
    return fft;
}

/* A query of one size, in both precisions; those that know none fill both alike. */
typedef void query(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n);

static void conditions(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n, int32_t order, int dealiased, int32_t shape) {
    struct fixpair_conditions c;
    size_t larger = fixpair_fft_next_side(3 * n / 2);
    struct fixpair_fft_f32 fft32 = hook_f32(n), fine32 = hook_f32(larger);
    struct fixpair_fft_f64 fft64 = hook_f64(n), fine64 = hook_f64(larger);
    need(fixpair_conditions_init(&c, 1));
    c.order = order;
    c.f_nl = 100.0;
    c.shape = shape;
    need(fixpair_initial_conditions_scratch_f32(f32, &c, &fft32, dealiased ? &fine32 : NULL));
    need(fixpair_initial_conditions_scratch_f64(f64, &c, &fft64, dealiased ? &fine64 : NULL));
}

static void first_order(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    conditions(f32, f64, n, FIXPAIR_ORDER_FIRST, 0, FIXPAIR_SHAPE_LOCAL);
}

static void second_order(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    conditions(f32, f64, n, FIXPAIR_ORDER_SECOND, 0, FIXPAIR_SHAPE_LOCAL);
}

static void second_order_dealiased(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    conditions(f32, f64, n, FIXPAIR_ORDER_SECOND, 1, FIXPAIR_SHAPE_LOCAL);
}

static void third_order(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    conditions(f32, f64, n, FIXPAIR_ORDER_THIRD, 0, FIXPAIR_SHAPE_LOCAL);
}

static void equilateral(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    conditions(f32, f64, n, FIXPAIR_ORDER_SECOND, 1, FIXPAIR_SHAPE_EQUILATERAL);
}

static void transform(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    struct fixpair_layout tables;
    need(fixpair_fft_tables_scratch_f32(&tables, n));
    need(fixpair_fft_scratch_f32(f32, n));
    f32->size += tables.size;
    need(fixpair_fft_tables_scratch_f64(&tables, n));
    need(fixpair_fft_scratch_f64(f64, n));
    f64->size += tables.size;
}

static void force(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    need(fixpair_force_scratch(f32, n));
    *f64 = *f32;
}

static void power(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    struct fixpair_fft_f64 fft = hook_f64(n);
    struct fixpair_binning binning;
    static uint64_t edges[512];
    need(fixpair_edges_uniform(edges, n / 2, 1.0, 1.0));
    need(fixpair_binning_init(&binning, edges, n / 2));
    binning.orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2 | FIXPAIR_MULTIPOLE_4;
    need(fixpair_power_sums_scratch(f32, &fft.fourier, &binning, 1));
    *f64 = *f32;
}

static void bispectrum(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    struct fixpair_fft_f32 fft32 = hook_f32(n);
    struct fixpair_fft_f64 fft64 = hook_f64(n);
    need(fixpair_bispectrum_scratch_f32(f32, &fft32, 40, 6350));
    need(fixpair_bispectrum_scratch_f64(f64, &fft64, 40, 6350));
}

static void deposit(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    struct fixpair_fft_f64 fft = hook_f64(n);
    need(fixpair_deposit_scratch_f32(f32, &fft.configuration, n * n * n, FIXPAIR_WINDOW_CIC));
    need(fixpair_deposit_scratch_f64(f64, &fft.configuration, n * n * n, FIXPAIR_WINDOW_CIC));
}

static void read_out(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    struct fixpair_fft_f64 fft = hook_f64(n);
    need(fixpair_read_out_scratch_f32(f32, &fft.configuration, n * n * n, FIXPAIR_WINDOW_CIC));
    need(fixpair_read_out_scratch_f64(f64, &fft.configuration, n * n * n, FIXPAIR_WINDOW_CIC));
}

static void evolve(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    struct fixpair_fft_f32 fft32 = hook_f32(n);
    struct fixpair_fft_f64 fft64 = hook_f64(n);
    need(fixpair_evolve_scratch_f32(f32, &fft32, n * n * n, FIXPAIR_WINDOW_CIC));
    need(fixpair_evolve_scratch_f64(f64, &fft64, n * n * n, FIXPAIR_WINDOW_CIC));
}

static void friends(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    need(fixpair_fof_labels_scratch_f32(f32, n * n * n));
    need(fixpair_fof_labels_scratch_f64(f64, n * n * n));
}

static void catalogue(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    need(fixpair_halos_scratch(f32, n * n * n));
    *f64 = *f32;
}

static void spheres(struct fixpair_layout *f32, struct fixpair_layout *f64, size_t n) {
    need(fixpair_spheres_scratch_f32(f32, n * n * n));
    need(fixpair_spheres_scratch_f64(f64, n * n * n));
}

static const struct {
    const char *name;
    query *ask;
} queries[] = {
    {"initial conditions, first order", first_order},
    {"second order", second_order},
    {"second order, dealiased", second_order_dealiased},
    {"second order, dealiased, equilateral", equilateral},
    {"third order", third_order},
    {"built-in transform, tables and work", transform},
    {"forces", force},
    {"P_0, P_2, P_4, n/2 - 1 shells", power},
    {"bispectrum, 40 shells, 6350 triangles, beside its meshes", bispectrum},
    {"deposit, CIC", deposit},
    {"read-out, CIC", read_out},
    {"run of a particle mesh, beside its three meshes", evolve},
    {"friends of friends, beside 8 of labels", friends},
    {"catalogue of halos", catalogue},
    {"spheres", spheres},
};

/* Three digits; what is below a hundredth is nothing. */
static void print(double f32, double f64) {
    if (f64 < 0.01) printf(" < 0.01 |");
    else if (f32 == f64) printf(" %.3g |", f32);
    else printf(" %.3g, %.3g |", f32, f64);
}

int main(void) {
    printf("| scratch of | n = 64 | 128 | 256 | 512 | 1024 | GB at 1024 |\n|---|---|---|---|---|---|---|\n");
    for (size_t q = 0; q < sizeof queries / sizeof *queries; q++) {
        struct fixpair_layout f32, f64;
        printf("| %s |", queries[q].name);
        for (size_t s = 0; s < SIDES; s++) {
            double cells = (double)sides[s] * (double)sides[s] * (double)sides[s];
            queries[q].ask(&f32, &f64, sides[s]);
            print((double)f32.size / cells, (double)f64.size / cells);
        }
        print(1e-9 * (double)f32.size, 1e-9 * (double)f64.size);
        printf("\n");
    }
    return 0;
}
