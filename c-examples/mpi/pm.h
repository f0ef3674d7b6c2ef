/*
 * A particle-mesh run on slabs, kernel by kernel: what fixpair_evolve_f64 does on one process, with the exchanges between.
 */

#ifndef PM_H
#define PM_H

#include <stddef.h>

#include "fftw_slabs.h"
#include "ghosts.h"
#include "migrate.h"
#include "spectrum.h"
#include "universe.h"

struct pm {
    const struct universe *universe;
    struct fftw_slabs fft;
    struct ghosts ghosts;
    struct particles particles;
    struct spectrum spectrum;
    double *mesh[3]; /* with ghosts */
    void *scratch;
    size_t scratch_len;
    struct fixpair_epoch epoch;
    size_t most;         /* particles that this process had at most */
    size_t moved;        /* particles that left this process since the start */
};

/* `universe` stays where it is. All processes call these together. Returns 0, or 1 after saying what is wrong; pm_close as ever. */
int pm_open(struct pm *pm, MPI_Comm comm, const struct universe *universe, int transposed);

void pm_close(struct pm *pm);

/* Initial conditions, and each particle to the process of its slab. */
int pm_begin(struct pm *pm);

/*
 * From the first scale factor to the last. P(k) comes with each force: power[i * shells + b] is that of shell b of pm->spectrum at
 * scale factor i, for (steps + 1) * shells values.
 */
int pm_evolve(struct pm *pm, double *power);

#endif
