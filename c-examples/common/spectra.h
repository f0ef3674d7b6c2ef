/*
 * From particles to P_l(k) and the squeezed bispectrum B(Delta k, k, k): deposit, transform, sums over modes and over triangles,
 * with memory that is taken once for any number of catalogues in one box.
 *
 * P_l: l = 0, 2, 4 about z in shells b <= |n| < b + 1, n = k L/(2 pi), b = 1, 2, ... B: shells of w about w, 2w, ...; a mode
 * belongs to the nearest; triangles have one side in the first shell and two in shell j = 1, 2, ... Nothing is subtracted: shot
 * noise is returned beside.
 *
 * In double precision. At high redshift the signal is a small part of what a mesh holds: the lattice that particles started from.
 */

#ifndef SPECTRA_H
#define SPECTRA_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>

#include "fixpair.h"
#include "transform.h"

/* What to measure. */
struct spectra_choice {
    size_t n;            /* cells on a side: one that the built-in transform takes */
    double box_size;     /* Mpc/h */
    int32_t window;      /* FIXPAIR_WINDOW_... */
    int interlaced;      /* two deposits, half a cell apart, for one */
    double highest;      /* k in h/Mpc up to which shells reach, within what the mesh holds */
    double width;        /* of the bispectrum's shells, in 2 pi/L */
    int subtract_noise;  /* do the points sample the field at random? Then Q is of B and P less shot noise */
    FILE *progress;      /* where to say so of work that takes seconds; or NULL */
};

/* Shells of one width, and their spectra. */
struct spectra_shells {
    uint64_t *edges; /* count + 1 */
    size_t count;
    size_t values; /* count times multipoles */
    struct fixpair_binning binning;
    struct fixpair_bin *bins; /* the same for all catalogues */
    int64_t *sums;
    size_t words;
};

struct spectra {
    struct spectra_choice choice;
    const struct fixpair_exec *exec;
    struct transform fft;
    struct fixpair_fft_f64 hook;  /* fft, counted: what takes long is mostly transforms */
    size_t transforms;
    time_t said;
    struct spectra_shells narrow; /* P_l */
    struct spectra_shells wide;   /* B */
    uint32_t *triangles;          /* three shells each; as many triangles as wide shells */
    uint64_t *counts;             /* of modes that close each */
    int64_t *triangle_sums;
    double *mesh;
    double *fields; /* three meshes: the second of interlacing, then shells */
    size_t fields_len;
    void *scratch;
    size_t scratch_len;
};

/* Of one catalogue; one block of memory, which `power` begins. */
struct spectra_result {
    double noise;             /* of P_0, if points sample the field at random: V/N */
    double *power;            /* narrow.count rows of P_0, P_2, P_4 in (Mpc/h)^3 */
    double *wide_power;       /* wide.count P_0 */
    double *bispectrum;       /* wide.count B in (Mpc/h)^6 */
    double *bispectrum_noise; /* what sampling at random adds to B */
    double *reduced;          /* Q = B/(P P + P P + P P) */
};

/*
 * Takes all memory: four meshes and little else. `exec` is not NULL; *spectra must not move. Returns 0, or 1 after saying what is
 * wrong; in both cases spectra_close gives the memory back, as it does for a struct of zeros.
 */
int spectra_open(struct spectra *spectra, const struct spectra_choice *choice, const struct fixpair_exec *exec);

void spectra_close(struct spectra *spectra);

/* Counts triangles, which depends on the mesh and the shells alone. */
int spectra_count(struct spectra *spectra);

/*
 * Counts kept in a file: numbers of 64 bits in the machine's byte order, what they belong to before them. Loading returns 0, or 1
 * where there is no such file or it belongs to another mesh, other shells or triangles; counts are then untouched. Saving returns
 * 0, or 1 after saying what is wrong.
 */
int spectra_save_counts(const struct spectra *spectra, const char *path);
int spectra_load_counts(struct spectra *spectra, const char *path);

/*
 * Measures particles, whose positions are in Mpc/h. Returns 0, or 1 after saying what is wrong; spectra_release gives the result
 * back.
 */
int spectra_measure(struct spectra *spectra, struct spectra_result *result, const struct fixpair_positions_f64 *position);

void spectra_release(struct spectra_result *result);

#endif
