/*
 * Where particles are before they are displaced: the positions of a Gadget file, tiled GlassTileFac^3 times, or one particle a
 * tile at its corner. Particles come in the order of their ids, which begin at 1: tiles with z fastest, and in each the particles
 * of the file.
 */

#ifndef GLASS_H
#define GLASS_H

#include <stddef.h>

struct glass {
    size_t tiles;     /* on a side */
    size_t each;      /* particles in a tile */
    size_t count;     /* particles in the box */
    double *position; /* of the particles of a tile, triples in [0, 1) of its side */
};

/*
 * Reads the particles of all types in a file of Gadget format 1, or in path.0, path.1 ... where there is path.0; no file for an
 * empty path. Returns 0, or 1 after saying what is wrong; in both cases glass_close gives the memory back, as it does for a
 * struct of zeros.
 */
int glass_open(struct glass *glass, const char *path, size_t tiles);

void glass_close(struct glass *glass);

/* Coordinate `axis` of a particle in [0, 1) of the side of the box. */
double glass_coordinate(const struct glass *glass, size_t particle, size_t axis);

/* Are the particles the cells of a mesh of side n, in their order and at their corners? */
int glass_is_mesh(const struct glass *glass, size_t n);

#endif
