/*
 * FFTW-MPI as the transform of fixpair: x slabs of cells, and modes either in the same slabs or, one exchange of the mesh cheaper, in slabs
 * of y (FFTW_MPI_TRANSPOSED_OUT). The library does not mind which.
 */

#ifndef FFTW_SLABS_H
#define FFTW_SLABS_H

#include <fftw3-mpi.h>

#include "fixpair.h"
#include "slabs.h"

struct fftw_slabs {
    struct fixpair_fft_f64 hook;
    struct slabs slabs; /* of the cells */
    size_t rows;        /* y indices of this process when modes are transposed */
    int transposed;
    fftw_plan forward, inverse;
};

/*
 * A transform of side n over all processes of `comm`, after fftw_mpi_init; all call it together. The hook points to the struct, which
 * therefore must not move. Returns 0, or 1 after saying what is wrong; in both cases fftw_slabs_close gives the memory back, as it does
 * for a struct of zeros.
 */
int fftw_slabs_open(struct fftw_slabs *fftw, MPI_Comm comm, size_t n, int transposed);

void fftw_slabs_close(struct fftw_slabs *fftw);

#endif
