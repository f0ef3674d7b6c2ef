#include "picture.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"

/* Points in a cube of the lattice. */
enum { FILL = 600, COLOURS = 6 };

/*
 * Point p of a cube lies at the fractions of p times these: as even as can be in space, and from each side, for any number of points.
 * They are the powers of 1/g, g^4 = g + 1 (Roberts 2018, the generalised golden ratio).
 */
static const double stride[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};

/* From voids to halos. */
static const double colours[COLOURS][3] = {{5, 4, 22}, {44, 18, 92}, {130, 37, 118}, {226, 85, 68}, {252, 178, 80}, {255, 252, 225}};

/* Below and above these times the mean, all is of one colour. */
#define LOWEST 0.08
#define HIGHEST 60.0

static double nearest(double difference, double period) {
    return difference - period * floor(difference / period + 0.5);
}

/* Corner (x, y, z) of the lattice, of a cube whose first corner is at `origin`: the image nearest to it. */
static void take_corner(double *corner, const struct picture *picture, const struct fixpair_positions_f32 *position, size_t x, size_t y,
                        size_t z, const double *origin) {
    size_t n = picture->n, i = (x % n * n + y % n) * n + z % n;
    double point[3] = {position->x[i * position->stride], position->y[i * position->stride], position->z[i * position->stride]};
    for (size_t axis = 0; axis < 3; axis++) {
        corner[axis] = origin == NULL ? point[axis] : origin[axis] + nearest(point[axis] - origin[axis], picture->box_size);
    }
}

/* Into [0, L), from less than L outside. */
static double wrap(double x, double period) {
    if (x < 0.0) x += period;
    return x < period ? x : x - period;
}

/* A cloud in four pixels, if it is in the slab. */
static void draw(double *pixels, const struct picture *picture, const double *point) {
    size_t side = picture->side;
    double box = picture->box_size, scale = (double)side / box;
    if (wrap(point[2] - picture->bottom, box) >= picture->depth) return;
    double x = scale * wrap(point[0], box), y = scale * wrap(point[1], box);
    size_t left = (size_t)x, low = (size_t)y;
    double right = x - (double)left, up = y - (double)low;
    left %= side;
    low %= side;
    double *row = pixels + low * side, *next = pixels + (low + 1) % side * side;
    row[left] += (1.0 - up) * (1.0 - right);
    row[(left + 1) % side] += (1.0 - up) * right;
    next[left] += up * (1.0 - right);
    next[(left + 1) % side] += up * right;
}

/* May a point of the cube be in the slab? */
static int is_seen(const struct picture *picture, double corner[8][3]) {
    double half = 0.5 * picture->depth, height = nearest(corner[0][2] - picture->bottom - half, picture->box_size);
    double low = height, high = height;
    for (size_t c = 1; c < 8; c++) {
        low = fmin(low, height + corner[c][2] - corner[0][2]);
        high = fmax(high, height + corner[c][2] - corner[0][2]);
    }
    return low <= half && high >= -half;
}

/* How much of each corner is in each point. */
static void fill_weights(double *weights) {
    for (size_t p = 0; p < FILL; p++) {
        for (size_t c = 0; c < 8; c++) {
            double *weight = weights + 8 * p + c;
            *weight = 1.0;
            for (size_t axis = 0; axis < 3; axis++) {
                double along = fmod((double)p * stride[axis], 1.0);
                *weight *= c >> axis & 1 ? along : 1.0 - along;
            }
        }
    }
}

static void draw_cube(double *pixels, const struct picture *picture, double corner[8][3], const double *weights) {
    for (size_t p = 0; p < FILL; p++) {
        double point[3] = {0.0, 0.0, 0.0};
        for (size_t c = 0; c < 8; c++) {
            for (size_t axis = 0; axis < 3; axis++) point[axis] += weights[8 * p + c] * corner[c][axis];
        }
        draw(pixels, picture, point);
    }
}

static void colour(unsigned char *rgb, double density) {
    double scale = log(fmax(density, LOWEST) / LOWEST) / log(HIGHEST / LOWEST) * (COLOURS - 1);
    size_t below = scale >= COLOURS - 1 ? COLOURS - 2 : (size_t)scale;
    double part = fmin(scale - (double)below, 1.0);
    for (size_t i = 0; i < 3; i++) rgb[i] = (unsigned char)(colours[below][i] + part * (colours[below + 1][i] - colours[below][i]) + 0.5);
}

static int write_pixels(const struct picture *picture, const double *pixels, const char *path) {
    double n = (double)picture->n, side = (double)picture->side;
    double mean = FILL * n * n * n / (side * side) * picture->depth / picture->box_size;
    FILE *stream = fopen(path, "wb");
    int failed = stream == NULL;
    if (!failed) {
        fprintf(stream, "P6\n%lu %lu\n255\n", (unsigned long)picture->side, (unsigned long)picture->side);
        for (size_t row = picture->side; row-- > 0;) {
            for (size_t column = 0; column < picture->side; column++) {
                unsigned char rgb[3];
                colour(rgb, pixels[row * picture->side + column] / mean);
                fwrite(rgb, sizeof rgb, 1, stream);
            }
        }
        failed |= ferror(stream);
        failed |= fclose(stream) != 0;
    }
    if (failed) fprintf(stderr, "%s: %s\n", path, strerror(errno));
    return failed;
}

int picture_write(const struct picture *picture, const struct fixpair_positions_f32 *position, const char *path) {
    size_t n = picture->n;
    double *pixels = memory_take_doubles(picture->side * picture->side), *weights = memory_take_doubles(8 * FILL), corner[8][3];
    int failed = pixels == NULL || weights == NULL;
    if (!failed) {
        fill_weights(weights);
        for (size_t i = 0; i < n * n * n; i++) {
            for (size_t c = 0; c < 8; c++) {
                take_corner(corner[c], picture, position, i / (n * n) + (c & 1), i / n % n + (c >> 1 & 1), i % n + (c >> 2 & 1),
                            c == 0 ? NULL : corner[0]);
            }
            if (is_seen(picture, corner)) draw_cube(pixels, picture, corner, weights);
        }
        failed = write_pixels(picture, pixels, path);
    }
    free(pixels);
    free(weights);
    return failed;
}
