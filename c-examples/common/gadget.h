/*
 * Gadget-2 files of format 1: dark-matter particles of one mass, type 1 (the "halo" slot), in one file.
 *
 * A file is four records, each between two copies of its length in bytes (uint32): the header of 256 bytes, then for all
 * particles positions (3 floats), velocities (3 floats), ids (4 or 8 bytes). Byte order is the machine's; readers look at the
 * first four bytes.
 *
 * Units: masses 1e10 Msun/h; velocities the peculiar one over sqrt(a), km/s; lengths kpc/h, the unit of Gadget's own examples
 * and what readers assume who do not ask. Who runs Gadget with UnitLength_in_cm = 3.085678e24 takes GADGET_MPC.
 */

#ifndef GADGET_H
#define GADGET_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Lengths of the file in one Mpc/h. */
#define GADGET_KPC 1000.0
#define GADGET_MPC 1.0

/* The first record, as in the user guide of Gadget-2 (Springel 2005), where each name is explained. */
struct gadget_header {
    uint32_t npart[6];
    double mass[6];
    double time; /* a */
    double redshift;
    int32_t flag_sfr;
    int32_t flag_feedback;
    uint32_t npart_total[6];
    int32_t flag_cooling;
    int32_t num_files;
    double box_size;
    double omega_0;
    double omega_lambda;
    double hubble_param;
    int32_t flag_stellar_age;
    int32_t flag_metals;
    uint32_t npart_total_high_word[6];
    int32_t flag_entropy_instead_u;
    char fill[60];
};

/* What a header is made of. */
struct gadget_universe {
    double box_size; /* Mpc/h */
    double redshift;
    double omega_m;
    double omega_de;
    double h;
    double unit; /* GADGET_KPC or GADGET_MPC */
};

/* Particles in the units of fixpair: Mpc/h, in [0, box_size), and peculiar km/s, as triples. */
struct gadget_particles {
    size_t count;
    const double *position;
    const double *velocity;
    const uint64_t *id;
};

/* A file in memory, in the file's units. */
struct gadget_file {
    struct gadget_header header;
    size_t count;
    size_t id_bytes;
    float *position;
    float *velocity;
    uint64_t *id;
};

/*
 * Writes a file, with ids of id_bytes = 4 or 8. Returns 0, or 1 after saying what is wrong, and leaves no file then. A record is
 * below 2 GiB (560^3 particles), which any reader can take; more have to be dealt out to several files.
 */
int gadget_write(const char *path, const struct gadget_universe *universe, const struct gadget_particles *particles,
                 size_t id_bytes);

/*
 * Writes a file of any units, one of a snapshot of several too: the header as it is, positions times `length`, at or beyond
 * header->box_size brought to 0, and velocities times `velocity`. The same otherwise.
 */
int gadget_write_file(const char *path, const struct gadget_header *header, const struct gadget_particles *particles, double length,
                      double velocity, size_t id_bytes);

/*
 * Reads a file of this machine's byte order that holds particles of type 1 only. Returns 0, or 1 after saying what is wrong; in
 * both cases gadget_close gives the memory back, as it does for a struct of zeros.
 */
int gadget_read(struct gadget_file *file, const char *path);

/*
 * GADGET_KPC or GADGET_MPC, whichever makes the masses of the particles, in 1e10 Msun/h, fill the box to its omega_0 within 10%;
 * 0 if neither does.
 */
double gadget_unit(const struct gadget_header *header);

/* Reads the next record of a file, of `bytes` between two markers. Returns 0 if that is what stands there. */
int gadget_read_record(FILE *stream, void *data, size_t bytes);

void gadget_close(struct gadget_file *file);

#endif
