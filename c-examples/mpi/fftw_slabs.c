#include "fftw_slabs.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "memory.h"
#include "traffic.h"

/* Plans run on other arrays than their own, which are aligned alike: to 16 bytes at least, see ghosts.h. All processes call these
   together, as often, in the same order: every kernel of the library that transforms does so on all of them. */
static int32_t forward(void *context, double *data) {
    const struct fftw_slabs *fftw = context;
    enum traffic before = traffic_of(TRAFFIC_TRANSFORM);
    fftw_mpi_execute_dft_r2c(fftw->forward, data, (fftw_complex *)data);
    traffic_of(before);
    return 0;
}

static int32_t inverse(void *context, double *data) {
    const struct fftw_slabs *fftw = context;
    enum traffic before = traffic_of(TRAFFIC_TRANSFORM);
    fftw_mpi_execute_dft_c2r(fftw->inverse, (fftw_complex *)data, data);
    traffic_of(before);
    return 0;
}

/* Asked for by g_nl: the mean of Phi^2 is one of the whole box. */
static int32_t sum(void *context, double *values, size_t count) {
    const struct fftw_slabs *fftw = context;
    if (count > INT_MAX) return 1;
    return MPI_Allreduce(MPI_IN_PLACE, values, (int)count, MPI_DOUBLE, MPI_SUM, fftw->slabs.comm) != MPI_SUCCESS;
}

int fftw_slabs_open(struct fftw_slabs *fftw, MPI_Comm comm, size_t n, int transposed) {
    struct fixpair_fft_f64 *hook = &fftw->hook;
    ptrdiff_t side = (ptrdiff_t)n, planes, first, rows, first_row;
    memset(fftw, 0, sizeof *fftw);
    fftw->transposed = transposed;

    /* In complex numbers: room for the cells, for the modes in either order, and for what FFTW needs on the way. */
    ptrdiff_t room = fftw_mpi_local_size_3d_transposed(side, side, side / 2 + 1, comm, &planes, &first, &rows, &first_row);
    TRY(slabs_open(&fftw->slabs, comm, n, (size_t)planes));
    fftw->rows = (size_t)rows;

    hook->struct_size = sizeof *hook;
    hook->context = fftw;
    hook->forward = forward;
    hook->inverse = inverse;
    hook->sum = sum;
    hook->length = 2 * (size_t)(room > 0 ? room : 1);
    TRY(slabs_brick(&hook->configuration, &fftw->slabs, fftw->slabs.rank));
    if (transposed) {
        TRY(fixpair_brick_transposed_slab(&hook->fourier, n, (size_t)(rows > 0 ? first_row : 0), (size_t)rows));
    } else {
        TRY(fixpair_brick_slab(&hook->fourier, n, FIXPAIR_SPACE_FOURIER, hook->configuration.start[0], (size_t)planes));
    }

    /* Planning may write to the array. */
    double *data = memory_take_doubles(hook->length);
    if (data == NULL) return 1;
    fftw->forward = fftw_mpi_plan_dft_r2c_3d(side, side, side, data, (fftw_complex *)data, comm,
                                             FFTW_ESTIMATE | (transposed ? FFTW_MPI_TRANSPOSED_OUT : 0));
    fftw->inverse = fftw_mpi_plan_dft_c2r_3d(side, side, side, (fftw_complex *)data, data, comm,
                                             FFTW_ESTIMATE | (transposed ? FFTW_MPI_TRANSPOSED_IN : 0));
    free(data);
    if (fftw->forward != NULL && fftw->inverse != NULL) return 0;
    fprintf(stderr, "FFTW has no plan for side %lu\n", (unsigned long)n);
    return 1;
}

void fftw_slabs_close(struct fftw_slabs *fftw) {
    if (fftw->forward != NULL) fftw_destroy_plan(fftw->forward);
    if (fftw->inverse != NULL) fftw_destroy_plan(fftw->inverse);
    slabs_close(&fftw->slabs);
    memset(fftw, 0, sizeof *fftw);
}
