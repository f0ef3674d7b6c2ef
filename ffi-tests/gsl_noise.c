/*
 * The schemes of N-GenIC and FastPM against GSL's ranlxd1: uniforms, seeds and phases bit for bit, modes to a few units in the last
 * place. The loops here are those of 2LPTic and FastPM, written from their descriptions, one mode after the other.
 */
#include <gsl/gsl_rng.h>
#include <math.h>

#include "check.h"

#define PI 3.14159265358979323846

enum { LARGEST = 128 };

static gsl_rng *own, *other;
static unsigned int table[LARGEST * LARGEST];
static size_t n, half;

/* Where (i, j, k) lies among the reals of the whole mesh. */
static size_t at(size_t i, size_t j, size_t k) {
    return 2 * ((i * n + j) * (half + 1) + k);
}

static size_t negative(size_t m) {
    return m == 0 ? 0 : n - m;
}

static int is_bits(const void *a, const void *b, size_t size) {
    return memcmp(a, b, size) == 0;
}

static void uniforms_are_those_of_gsl(void) {
    static const uint64_t seeds[] = {0, 1, 2, 57, 1000003, 2147483646, 2147483647, 2147483648u, 2147483649u, 3000000000u,
                                     4294967295u, UINT64_C(4294967296), UINT64_C(4294967297), UINT64_C(1) << 40, UINT64_MAX};
    double ours[1000], theirs[1000];
    size_t s, k;
    for (s = 0; s < sizeof seeds / sizeof *seeds; s++) {
        if (sizeof(unsigned long) < sizeof *seeds && seeds[s] >> 31 > 1) {
            continue;
        }
        gsl_rng_set(own, (unsigned long)seeds[s]);
        for (k = 0; k < 1000; k++) {
            theirs[k] = gsl_rng_uniform(own);
        }
        MUST(fixpair_ranlxd1(ours, 1000, seeds[s]));
        CHECK(is_bits(ours, theirs, sizeof ours));
    }
}

static void enter(size_t i, size_t j) {
    table[i * n + j] = (unsigned int)(2147483647 * gsl_rng_uniform(own));
}

static void seeds_are_those_of_gsl(void) {
    static uint32_t seeds[LARGEST * LARGEST];
    fixpair_brick brick;
    size_t i, j, last = n - 1;
    gsl_rng_set(own, (unsigned long)SEED);
    for (i = 0; i < half; i++) {
        for (j = 0; j < i; j++) enter(i, j);
        for (j = 0; j <= i; j++) enter(j, i);
        for (j = 0; j < i; j++) enter(last - i, j);
        for (j = 0; j <= i; j++) enter(last - j, i);
        for (j = 0; j < i; j++) enter(i, last - j);
        for (j = 0; j <= i; j++) enter(j, last - i);
        for (j = 0; j < i; j++) enter(last - i, last - j);
        for (j = 0; j <= i; j++) enter(last - j, last - i);
    }
    MUST(fixpair_brick_whole(&brick, n, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_ngenic_seeds(seeds, n * n, &brick, SEED));
    for (i = 0; i < n * n; i++) {
        CHECK(seeds[i] == table[i]);
    }
}

/* With the seed of its column, fixpair_ranlxd1 gives every phase of GSL in every bit. */
static void phases_are_those_of_gsl(void) {
    double uniforms[LARGEST + 2];
    size_t column, k;
    for (column = 0; column < n * n; column++) {
        int same = 1;
        gsl_rng_set(own, table[column]);
        MUST(fixpair_ranlxd1(uniforms, n + 2, table[column]));
        for (k = 0; k <= half; k++) {
            double phase = gsl_rng_uniform(own) * 2 * PI, ours = uniforms[2 * k] * 2 * PI, u2 = gsl_rng_uniform(own);
            same = same && is_bits(&phase, &ours, sizeof phase) && is_bits(&u2, &uniforms[2 * k + 1], sizeof u2);
        }
        CHECK(same);
    }
}

typedef struct {
    double modulus, phase;
} polar;

static polar draw(gsl_rng *stream) {
    polar result;
    double u;
    result.phase = gsl_rng_uniform(stream) * 2 * PI;
    do {
        u = gsl_rng_uniform(stream);
    } while (u <= 0.0);
    result.modulus = sqrt(-log(u));
    return result;
}

/* The selection, in integers; 2LPTic's comparison of wavenumbers may fall otherwise on the boundary only. */
static int cut(size_t i, size_t j, size_t k, int sphere, size_t sample) {
    double kx, ky, kz, reach = (double)(sample / 2), unit = 2 * PI / BOX;
    size_t a = i < half ? i : n - i, b = j < half ? j : n - j, square = a * a + b * b + k * k, largest = a > b ? a : b;
    int boundary, outside, floating;
    largest = largest > k ? largest : k;
    kx = (double)a * unit;
    ky = (double)b * unit;
    kz = (double)k * unit;
    if (sphere) {
        outside = square > (sample / 2) * (sample / 2);
        boundary = square == (sample / 2) * (sample / 2);
        floating = sqrt(kx * kx + ky * ky + kz * kz) * BOX / (2 * PI) > reach;
    } else {
        outside = largest > sample / 2;
        boundary = largest == sample / 2;
        floating = kx * BOX / (2 * PI) > reach || ky * BOX / (2 * PI) > reach || kz * BOX / (2 * PI) > reach;
    }
    CHECK(outside == floating || boundary);
    return outside;
}

static void put(polar *modes, size_t i, size_t j, size_t k, polar mode, double conjugate) {
    polar *to = &modes[at(i, j, k) / 2];
    to->modulus = mode.modulus;
    to->phase = conjugate * mode.phase;
}

/* Every process of 2LPTic runs this loop over the half space without Nyquist planes; on kz = 0 a mode brings its image along. */
static void ngenic(polar *modes, int sphere, size_t sample) {
    size_t i, j, k;
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            gsl_rng_set(own, table[i * n + j]);
            for (k = 0; k < half; k++) {
                polar mode = draw(own);
                if (i == half || j == half || (i == 0 && j == 0 && k == 0) || cut(i, j, k, sphere, sample)) {
                    continue;
                }
                if (k > 0) {
                    put(modes, i, j, k, mode, 1.0);
                } else if (i == 0 ? j < half : i < half) {
                    put(modes, i, j, 0, mode, 1.0);
                    put(modes, negative(i), negative(j), 0, mode, -1.0);
                }
            }
        }
    }
}

/* FastPM draws kz = N/2, too; on both planes the mirrored columns read the stream of their images. */
static void fastpm(polar *modes, int sphere, size_t sample) {
    size_t i, j, k;
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            size_t ci = negative(i), cj = negative(j);
            int mirrored = ci < i || (ci == i && cj < j);
            gsl_rng_set(own, table[i * n + j]);
            gsl_rng_set(other, table[ci * n + cj]);
            for (k = 0; k <= half; k++) {
                polar mine = draw(own), theirs = draw(other);
                int plane = k == 0 || k == half;
                if ((i == 0 && j == 0 && k == 0) || cut(i, j, k, sphere, sample)) {
                    continue;
                }
                if (plane && mirrored) {
                    put(modes, i, j, k, theirs, -1.0);
                } else if (plane && ci == i && cj == j) {
                    mine.modulus *= cos(mine.phase);
                    mine.phase = 0.0;
                    put(modes, i, j, k, mine, 1.0);
                } else {
                    put(modes, i, j, k, mine, 1.0);
                }
            }
        }
    }
}

/*
 * -log u2 carries an ulp here and there and its root half of that; the phase (u1 * 2) * pi has the rounding of pi and of the product,
 * 2 pi 2^-53 and as much again; sine and cosine an ulp: 1.5e-15 of the modulus. Self-conjugate modes have that error of a modulus that
 * is at most 5.8, as u2 is at least 2^-48.
 */
static int near(double x, double expected, double modulus) {
    return fabs(x - expected) <= 1.5e-15 * modulus;
}

static void modes_are_those_of_gsl(int32_t scheme, int32_t selection, size_t sample) {
    fixpair_brick brick;
    fixpair_realisation normal, fixed;
    size_t length, i, zeros = 0;
    double *modes, *unit;
    float *single;
    polar *expected;
    int all_near = 1, all_unit = 1, all_rounded = 1, same_zeros = 1;
    MUST(fixpair_brick_whole(&brick, n, FIXPAIR_SPACE_FOURIER, 0));
    MUST(fixpair_brick_reals(&length, &brick));
    MUST(fixpair_realisation_init(&normal, SEED));
    normal.scheme = scheme;
    normal.selection = selection;
    normal.sample = (uint32_t)sample;
    normal.nyquist = scheme == FIXPAIR_SCHEME_FASTPM ? FIXPAIR_NYQUIST_FILLED : FIXPAIR_NYQUIST_ZERO;
    fixed = normal;
    fixed.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    fixed.phase = FIXPAIR_PHASE_INVERTED;
    modes = (double *)malloc(length * sizeof *modes);
    unit = (double *)malloc(length * sizeof *unit);
    single = (float *)malloc(length * sizeof *single);
    expected = (polar *)calloc(length / 2, sizeof *expected);
    if (!modes || !unit || !single || !expected) {
        exit(2);
    }
    (scheme == FIXPAIR_SCHEME_FASTPM ? fastpm : ngenic)(expected, selection == FIXPAIR_SELECTION_SPHERE, sample);
    MUST(fixpair_white_modes_f64(modes, length, &brick, &normal, NULL, 0, NULL));
    MUST(fixpair_white_modes_f64(unit, length, &brick, &fixed, NULL, 0, NULL));
    MUST(fixpair_white_modes_f32(single, length, &brick, &normal, NULL, 0, NULL));
    for (i = 0; i < length / 2; i++) {
        double re = modes[2 * i], im = modes[2 * i + 1], modulus = expected[i].modulus, phase = expected[i].phase;
        all_rounded = all_rounded && single[2 * i] == (float)re && single[2 * i + 1] == (float)im;
        if (modulus == 0.0) {
            zeros++;
            same_zeros = same_zeros && re == 0.0 && im == 0.0 && unit[2 * i] == 0.0 && unit[2 * i + 1] == 0.0;
        } else if (phase == 0.0) {
            all_near = all_near && near(re, modulus, 5.8) && im == 0.0;
            all_unit = all_unit && unit[2 * i] == (modulus < 0.0 ? 1.0 : -1.0) && unit[2 * i + 1] == 0.0;
        } else {
            all_near = all_near && near(re, modulus * cos(phase), modulus) && near(im, modulus * sin(phase), modulus);
            all_unit = all_unit && near(unit[2 * i], -cos(phase), 1.0) && near(unit[2 * i + 1], -sin(phase), 1.0);
        }
    }
    CHECK(same_zeros);
    CHECK(all_near);
    CHECK(all_unit);
    CHECK(all_rounded);
    CHECK(zeros < length / 2);
    for (i = 0; i < n * n; i++) {
        size_t a = at(i / n, i % n, 0), b = at(negative(i / n), negative(i % n), 0);
        CHECK(modes[a] == modes[b] && modes[a + 1] == -modes[b + 1]);
    }
    free(modes);
    free(unit);
    free(single);
    free(expected);
}

int main(void) {
    static const size_t sides[] = {16, 64, 128};
    size_t s;
    own = gsl_rng_alloc(gsl_rng_ranlxd1);
    other = gsl_rng_alloc(gsl_rng_ranlxd1);
    uniforms_are_those_of_gsl();
    for (s = 0; s < 3; s++) {
        size_t samples[3], k;
        int32_t scheme, selection;
        n = sides[s];
        half = n / 2;
        samples[0] = n;
        samples[1] = half;
        samples[2] = half - 3;
        seeds_are_those_of_gsl();
        phases_are_those_of_gsl();
        for (k = 0; k < 3; k++) {
            for (scheme = FIXPAIR_SCHEME_NGENIC; scheme <= FIXPAIR_SCHEME_FASTPM; scheme++) {
                for (selection = FIXPAIR_SELECTION_CUBE; selection <= FIXPAIR_SELECTION_SPHERE; selection++) {
                    modes_are_those_of_gsl(scheme, selection, samples[k]);
                }
            }
        }
    }
    gsl_rng_free(own);
    gsl_rng_free(other);
    return check_report("gsl_noise");
}
