#include "scheme.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "fixpair.h"
#include "memory.h"

#define PI 3.14159265358979323846

int scheme_ranlxd1(double *uniforms, size_t len, uint64_t seed) {
    TRY(fixpair_ranlxd1(uniforms, len, seed));
    return 0;
}

/* One seed a column (i, j), from shells of growing i, so that a larger mesh has those of a smaller one. */
static int make_seeds(uint64_t *seeds, const struct scheme *scheme) {
    size_t n = scheme->n, drawn = 0;
    double *uniforms = memory_take_doubles(n * n);
    if (uniforms == NULL || scheme->generator(uniforms, n * n, scheme->seed) != 0) {
        free(uniforms);
        return 1;
    }
    for (size_t i = 0; i < n / 2; i++) {
        for (int pass = 0; pass < 8; pass++) {
            for (size_t j = 0; j < i + (size_t)(pass % 2); j++) {
                size_t row = pass % 2 == 0 ? i : j, column = pass % 2 == 0 ? j : i;
                if (pass / 2 % 2 == 1) row = n - 1 - row;
                if (pass / 4 == 1) column = n - 1 - column;
                seeds[row * n + column] = (uint64_t)(2147483647.0 * uniforms[drawn++]);
            }
        }
    }
    free(uniforms);
    return 0;
}

static long signed_number(size_t index, size_t n) {
    return index < n / 2 ? (long)index : (long)index - (long)n;
}

/* What Nsample leaves out, compared as 2LPTic compares it: on the very edge its rounding decides. */
static int is_left_out(const struct scheme *scheme, const long number[3]) {
    double most = (double)(scheme->sample / 2), box = scheme->box, k[3];
    for (int axis = 0; axis < 3; axis++) k[axis] = (double)(number[axis] * 2) * PI / box;
    if (scheme->sphere) return sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]) * box / (2.0 * PI) > most;
    return fabs(k[0]) * box / (2.0 * PI) > most || fabs(k[1]) * box / (2.0 * PI) > most || k[2] * box / (2.0 * PI) > most;
}

static void store(double *modes, size_t n, size_t i, size_t j, size_t l, double real, double imaginary) {
    double *mode = &modes[2 * ((i * n + j) * (n / 2 + 1) + l)];
    mode[0] = real;
    mode[1] = imaginary;
}

/* All modes of a column, from its own numbers. */
static void fill_column(const struct scheme *scheme, double *modes, const double *uniforms, size_t i, size_t j) {
    size_t n = scheme->n;
    for (size_t l = 0; l < n / 2; l++) {
        double phase = *uniforms++ * 2.0 * PI, draw = *uniforms++;
        while (draw == 0.0) draw = *uniforms++;
        if (i == n / 2 || j == n / 2 || (i == 0 && j == 0 && l == 0)) continue;
        long number[3] = {signed_number(i, n), signed_number(j, n), (long)l};
        if (is_left_out(scheme, number)) continue;
        /* In the plane l = 0 one of two conjugate columns is drawn, and decides about both. */
        if (l == 0 && (i > n / 2 || (i == 0 && j > n / 2))) continue;
        if (scheme->flip) phase += PI;
        double modulus = scheme->amplitude[number[0] * number[0] + number[1] * number[1] + number[2] * number[2]];
        if (!scheme->fixed) modulus *= sqrt(-log(draw));
        store(modes, n, i, j, l, modulus * cos(phase), modulus * sin(phase));
        if (l == 0) store(modes, n, (n - i) % n, (n - j) % n, 0, modulus * cos(phase), -modulus * sin(phase));
    }
}

int scheme_density(const struct scheme *scheme, double *modes) {
    size_t n = scheme->n, draws = n + 16;
    uint64_t *seeds = calloc(n * n, sizeof *seeds);
    double *uniforms = memory_take_doubles(draws);
    int outcome = seeds == NULL || uniforms == NULL || make_seeds(seeds, scheme) != 0;
    memset(modes, 0, n * n * (n + 2) * sizeof *modes);
    for (size_t column = 0; outcome == 0 && column < n * n; column++) {
        outcome = scheme->generator(uniforms, draws, seeds[column]);
        if (outcome == 0) fill_column(scheme, modes, uniforms, column / n, column % n);
    }
    free(seeds);
    free(uniforms);
    return outcome;
}

void scheme_displacement(double psi[3], const double *modes, size_t n, double box, const size_t corner[3]) {
    psi[0] = psi[1] = psi[2] = 0.0;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            for (size_t l = 0; l < n / 2; l++) {
                const double *mode = &modes[2 * ((i * n + j) * (n / 2 + 1) + l)];
                double k[3] = {(double)signed_number(i, n), (double)signed_number(j, n), (double)l};
                double square = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
                /* The angle modulo a turn, in whole parts of it. */
                double angle = 2.0 * PI * (double)((i * corner[0] + j * corner[1] + l * corner[2]) % n) / (double)n;
                /* Re(i delta exp(i angle)), twice where the conjugate is not in the array. */
                double real = -(mode[0] * sin(angle) + mode[1] * cos(angle)) * (l > 0 ? 2.0 : 1.0);
                if (square == 0.0) continue;
                for (int axis = 0; axis < 3; axis++) psi[axis] += box / (2.0 * PI) * k[axis] / square * real;
            }
        }
    }
}
