/*
 * What the parts of bits.c share: the lines that it prints, the values that it keeps for comparison, and the pieces that meshes are cut into.
 */
#ifndef FIXPAIR_BITS_H
#define FIXPAIR_BITS_H

#include <math.h>

#include "../check.h"

/*
 * What a line promises. The same bits on any number of threads always; and on any processor: EXACT in all bits, TRANSFORM to rounding, for
 * a Fourier transform was on the way; ALGEBRA to rounding, for faer was.
 */
enum { EXACT, TRANSFORM, ALGEBRA };
static const char *const promises[] = {"exact", "transform", "algebra"};

/* How meshes are cut. */
enum { WHOLE, SLABS, TRANSPOSED, PENCILS, CUTS };
static const char *const cuts[CUTS] = {"whole", "slabs", "transposed", "pencils"};

static int cut = WHOLE;
static const fixpair_exec *exec = NULL;
static FILE *values = NULL;

enum { MESH = 48, PARTICLES = 100000, EDGES_OF_SHELLS = 7, SHELLS_OF_MODES = EDGES_OF_SHELLS - 1 };

/* A number in [-1, 1), of integer arithmetic alone (the finaliser of MurmurHash3). */
static double random_number(size_t i) {
    uint32_t bits = (uint32_t)i * UINT32_C(2654435761) + 1;
    bits = (bits ^ bits >> 16) * UINT32_C(0x85ebca6b);
    bits = (bits ^ bits >> 13) * UINT32_C(0xc2b2ae35);
    return (double)(bits ^ bits >> 16) / 2147483648.0 - 1.0;
}

static void line(int promise, const char *name, const char *suffix, uint64_t hash) {
    char full[64];
    snprintf(full, sizeof full, "%s%s", name, suffix);
    printf("%-9s %-40s %016llx\n", promises[promise], full, (unsigned long long)hash);
}

static void line_of_bytes(int promise, const char *name, const char *suffix, const void *data, size_t size) {
    line(promise, name, suffix, hash_bytes(HASH_START, data, size));
}

/* Cases of conformance_variance.h become lines. */
static void line_of_case(const char *name, uint64_t hash) {
    int algebra = strcmp(name, "covariance_root") == 0 || strcmp(name, "carpool") == 0;
    line(algebra ? ALGEBRA : EXACT, "statistics.", name, hash);
}

/* The head of the numbers of a line in the file of values. */
typedef struct {
    char name[64];
    /* Numbers that differ by it are equal: the side of a box, or 0. */
    double period;
    uint64_t count;
} head_of_values;

static void keep_head(const char *name, const char *suffix, double period, size_t count) {
    head_of_values head;
    memset(&head, 0, sizeof head);
    snprintf(head.name, sizeof head.name, "%s%s", name, suffix);
    head.period = period;
    head.count = count;
    if (fwrite(&head, sizeof head, 1, values) != 1) {
        printf("cannot write values\n");
        exit(2);
    }
}

static void line_of_doubles(int promise, const char *name, const char *suffix, double period, const double *data, size_t count) {
    line_of_bytes(promise, name, suffix, data, count * sizeof *data);
    if (values != NULL && promise != EXACT) {
        keep_head(name, suffix, period, count);
        fwrite(data, sizeof *data, count, values);
    }
}

static void line_of_floats(int promise, const char *name, const char *suffix, double period, const float *data, size_t count) {
    size_t i;
    line_of_bytes(promise, name, suffix, data, count * sizeof *data);
    if (values != NULL && promise != EXACT) {
        keep_head(name, suffix, period, count);
        for (i = 0; i < count; i++) {
            double value = (double)data[i];
            fwrite(&value, sizeof value, 1, values);
        }
    }
}

enum { MOST_PIECES = 8 };

static void piece(fixpair_brick *brick, size_t n, int32_t space, const size_t *start, const size_t *count, const size_t *stride) {
    brick->n = n;
    brick->space = space;
    memcpy(brick->start, start, sizeof brick->start);
    memcpy(brick->count, count, sizeof brick->count);
    memcpy(brick->stride, stride, sizeof brick->stride);
}

/*
 * The bricks of a mesh. Pencils are cut along x and y and leave axis 2 whole, as those of a configuration space are; `turned`: along y and l,
 * with x innermost, as transforms leave their modes.
 */
static size_t pieces_of(fixpair_brick *bricks, size_t n, int32_t space, int turned) {
    const size_t ends[3] = {0, n / 9, n}, corners[4] = {0, n / 3, n / 3 + 1, n};
    const size_t last = space == FIXPAIR_SPACE_FOURIER ? n / 2 + 1 : n, halves[3] = {0, n / 5, last};
    size_t pieces = 0, a, b;
    if (cut == WHOLE) {
        MUST(fixpair_brick_whole(&bricks[0], n, space, 3));
        return 1;
    }
    for (a = 0; a < (cut == SLABS ? 2 : 3); a++) {
        size_t first = cut == SLABS ? ends[a] : corners[a], planes = (cut == SLABS ? ends[a + 1] : corners[a + 1]) - first;
        if (cut == SLABS || (cut == TRANSPOSED && space == FIXPAIR_SPACE_CONFIGURATION)) {
            MUST(fixpair_brick_slab(&bricks[pieces++], n, space, first, planes));
        } else if (cut == TRANSPOSED) {
            MUST(fixpair_brick_transposed_slab(&bricks[pieces++], n, first, planes));
        }
        for (b = 0; cut == PENCILS && b < 2; b++) {
            size_t start[3] = {first, ends[b], 0}, count[3] = {planes, ends[b + 1] - ends[b], last}, stride[3];
            if (turned) {
                start[0] = 0, start[1] = first, start[2] = halves[b];
                count[0] = n, count[1] = planes, count[2] = halves[b + 1] - halves[b];
                stride[0] = 1, stride[1] = n, stride[2] = n * planes + 5;
            } else {
                stride[0] = count[1] * (last + 1), stride[1] = last + 1, stride[2] = 1;
            }
            piece(&bricks[pieces++], n, space, start, count, stride);
        }
    }
    return pieces;
}

#endif
