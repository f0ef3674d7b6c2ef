#include "lattice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"

#define TWO_PI 6.283185307179586

/* Displacements, three a particle, and the number of the lattice point that each particle came from. */
struct displaced {
    size_t n, count;
    double cell;
    double *psi;
    size_t *site;
};

/* Where the lattice lies in its cells: the circular mean of x/cell, for displacements have no mean. */
static double offset_of(const double *position, size_t count, double cell) {
    double sine = 0.0, cosine = 0.0;
    for (size_t p = 0; p < count; p++) {
        sine += sin(TWO_PI / cell * position[3 * p]);
        cosine += cos(TWO_PI / cell * position[3 * p]);
    }
    return atan2(sine, cosine) / TWO_PI;
}

static int find_sites(struct displaced *found, const double *position) {
    unsigned char *taken = calloc(found->count, 1);
    size_t twice = 0, n = found->n;
    double offset[3];
    if (taken == NULL) return 1;
    for (size_t axis = 0; axis < 3; axis++) offset[axis] = offset_of(position + axis, found->count, found->cell);
    for (size_t p = 0; p < found->count; p++) {
        size_t site = 0;
        for (size_t axis = 0; axis < 3; axis++) {
            double place = position[3 * p + axis] / found->cell - offset[axis], nearest = floor(place + 0.5);
            found->psi[3 * p + axis] = (place - nearest) * found->cell;
            site = site * n + (size_t)(nearest - floor(nearest / (double)n) * (double)n) % n;
        }
        twice += taken[site]++ != 0;
        found->site[p] = site;
    }
    free(taken);
    if (twice == 0) return 0;
    fprintf(stderr, "%lu particles are nearest to the lattice point of another one: no lattice, or displaced by half a cell and more\n",
            (unsigned long)twice);
    return 1;
}

static double slope_of(const struct displaced *found, const double *velocity) {
    double both = 0.0, square = 0.0;
    for (size_t i = 0; i < 3 * found->count; i++) {
        both += velocity[i] * found->psi[i];
        square += found->psi[i] * found->psi[i];
    }
    return both / square;
}

/* Adds -i k_a psi_a of one axis. */
static void add_divergence(double *modes, const double *psi, const struct fixpair_brick *brick, size_t axis, double factor) {
    size_t n = brick->n, index[3];
    for (index[0] = 0; index[0] < n; index[0]++) {
        for (index[1] = 0; index[1] < n; index[1]++) {
            for (index[2] = 0; index[2] <= n / 2; index[2]++) {
                size_t at = 2 * (index[0] * brick->stride[0] + index[1] * brick->stride[1] + index[2] * brick->stride[2]);
                double number = index[axis] == n / 2 ? 0.0 : (double)index[axis] - (index[axis] > n / 2 ? (double)n : 0.0);
                modes[at] += factor * number * psi[at + 1];
                modes[at + 1] -= factor * number * psi[at];
            }
        }
    }
}

static int sum_axes(double *modes, double *mesh, const struct displaced *found, const struct fixpair_fft_f64 *fft) {
    const struct fixpair_brick *cells = &fft->configuration;
    size_t n = found->n;
    double length = found->cell * (double)n;
    memset(modes, 0, fft->length * sizeof *modes);
    for (size_t axis = 0; axis < 3; axis++) {
        memset(mesh, 0, fft->length * sizeof *mesh);
        for (size_t p = 0; p < found->count; p++) {
            size_t i = found->site[p] / (n * n), j = found->site[p] / n % n, k = found->site[p] % n;
            mesh[i * cells->stride[0] + j * cells->stride[1] + k * cells->stride[2]] = found->psi[3 * p + axis];
        }
        if (fft->forward(fft->context, mesh) != 0) return claim(0, "the transform works");
        add_divergence(modes, mesh, &fft->fourier, axis, TWO_PI / length / (double)found->count);
    }
    return 0;
}

int lattice_density(double *modes, double *slope, const double *position, const double *velocity, double box_size,
                    const struct fixpair_fft_f64 *fft) {
    size_t n = fft->configuration.n;
    struct displaced found = {n, n * n * n, box_size / (double)n, NULL, NULL};
    double *mesh = memory_take_doubles(fft->length);
    found.psi = memory_take_doubles(3 * found.count);
    found.site = malloc(found.count * sizeof *found.site);
    int broken = mesh == NULL || found.psi == NULL || found.site == NULL;
    if (!broken) broken = find_sites(&found, position);
    if (!broken) broken = sum_axes(modes, mesh, &found, fft);
    if (!broken && velocity != NULL) *slope = slope_of(&found, velocity);
    free(mesh);
    free(found.psi);
    free(found.site);
    return broken;
}
