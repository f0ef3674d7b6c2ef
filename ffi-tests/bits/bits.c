/*
 * What one seed gives, as lines "promise name hash", for bits.py to compare between threads, cuts, processors and builds.
 *
 * bits CUT THREADS [FILE]   CUT: whole, slabs, transposed or pencils. FILE gets the numbers of all lines whose bits are promised on one
 *                           processor only
 * bits FILE FILE            how far the numbers of two such files are apart
 */
#define _POSIX_C_SOURCE 200112L

#include "bits.h"

#define check_case line_of_case
#include "../conformance_variance.h"
#undef check_case

#include "compare.h"
#include "scalars.h"

#define REAL float
#define X(name) name##_f32
#define SUFFIX ".f32"
#define line_of_f32 line_of_floats
#include "meshes.h"
#include "particles.h"
#include "universes.h"
#include "halos.h"
#include "estimates.h"
#undef REAL
#undef X
#undef SUFFIX

#define REAL double
#define X(name) name##_f64
#define SUFFIX ".f64"
#define line_of_f64 line_of_doubles
#include "meshes.h"
#include "particles.h"
#include "universes.h"
#include "halos.h"
#include "estimates.h"

int main(int count, char **arguments) {
    fixpair_threads *pool;
    fixpair_exec hook;
    int threads;
    if (count == 3 && strtol(arguments[2], NULL, 10) == 0) {
        return compare(arguments[1], arguments[2]);
    }
    while (count > 2 && cut < CUTS && strcmp(arguments[1], cuts[cut]) != 0) {
        cut++;
    }
    threads = count > 2 ? (int)strtol(arguments[2], NULL, 10) : 0;
    if ((count != 3 && count != 4) || cut == CUTS || threads < 1) {
        printf("usage: %s whole|slabs|transposed|pencils THREADS [FILE]\n       %s FILE FILE\n", arguments[0], arguments[0]);
        return 2;
    }
    if (count == 4 && (values = fopen(arguments[3], "wb")) == NULL) {
        printf("cannot write %s\n", arguments[3]);
        return 2;
    }
    MUST(fixpair_threads_create(&pool, &hook, (size_t)threads));
    exec = &hook;
    make_tables();
    seeds();
    modes_f32(amplitudes, alphas, table_len);
    modes_f64(amplitudes, alphas, table_len);
    displaced_f32();
    displaced_f64();
    deposits_f32();
    deposits_f64();
    from_meshes_f32();
    from_meshes_f64();
    drifts_f32();
    drifts_f64();
    powers_f32();
    powers_f64();
    correlations_f32();
    correlations_f64();
    bispectra_f32();
    bispectra_f64();
    halos_f32();
    halos_f64();
    universes_f32();
    universes_f64();
    if (cut == WHOLE) {
        statistics();
    }
    give_back(amplitudes);
    give_back(alphas);
    exec = NULL;
    fixpair_threads_destroy(pool);
    if (values != NULL && fclose(values) != 0) {
        printf("cannot write %s\n", arguments[3]);
        return 2;
    }
    return check_failures > 0;
}
