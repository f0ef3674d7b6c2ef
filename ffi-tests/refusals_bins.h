/*
 * The part of refusals.c about bins, edges and triangles: what has no precision; and faults of binnings and regions.
 */

CALL(brick_with_ghosts, (P(0), P(1), a->i[0], a->d[0]))
CALL(binning_init, (P(0), P(1), L(0)))
CALL(binning_lengths, (P(0), P(1), P(2), P(3), L(0)))
CALL(binning_read, (P(0), L(0), P(1), L(1), P(2), L(2), P(3), L(3)))
CALL(binning_normalise, (P(0), L(0), P(1), L(1), (uint32_t)a->u, a->d[0]))
CALL(edges_uniform, (P(0), L(0), a->d[0], a->d[1]))
CALL(edges_wavenumbers, (P(0), P(1), L(0), a->d[0]))
CALL(edges_exact, (P(0), L(0), a->u))
CALL(power_sums_scratch, (P(0), P(1), P(2), L(0)))
CALL(subtract_shot_noise, (P(0), L(0), P(1), L(1), P(2), L(2), (uint32_t)a->u, P(3), L(3)))
CALL(compensate_scratch, (P(0), P(1)))
CALL(correlation_modes_scratch, (P(0), P(1)))
CALL(correlation_sums_scratch, (P(0), P(1), P(2), L(0)))
CALL(closed_triangle_count, (P(0), P(1), L(0), P(2)))
CALL(closed_triangles, (P(0), L(0), P(1), L(1), P(2)))
CALL(squeezed_triangles, (P(0), L(0), L(1), L(2)))
CALL(triangle_counts_scratch, (P(0), P(1), L(0), P(2), L(1), L(2)))
CALL(triangle_counts, (P(0), P(1), L(0), P(2), L(1), L(2), P(3), L(3), P(4)))
CALL(bispectrum_values, (P(0), L(0), P(1), L(1)))
CALL(bispectrum_normalise, (P(0), P(1), L(0), L(1), a->d[0], a->d[1]))
CALL(bispectrum_shot_noise, (P(0), P(1), L(0), P(2), L(1), a->d[0]))
CALL(bispectrum_reduced, (P(0), P(1), P(2), L(0), P(3), L(1)))

enum { EDGES = SHELLS + 1, TRIANGLES = 4, SUM = FIXPAIR_BISPECTRUM_WORDS };
static const uint64_t some_edges[EDGES] = {1, 2, 4, 9};
static const uint32_t some_triangles[3 * TRIANGLES] = {0, 0, 1, 0, 1, 2, 2, 2, 2, 1, 1, 1};

/* Wedges and multipoles at p[pointer], their edges in the arena. */
static fixpair_binning *binning_at(int pointer) {
    fixpair_binning *binning = STRUCT(pointer, IN, fixpair_binning);
    uint64_t *edges = (uint64_t *)lay(EDGES * sizeof *edges, IN);
    double *wedges = (double *)lay(3 * sizeof *wedges, IN);
    memcpy(edges, some_edges, sizeof some_edges);
    wedges[1] = 0.5;
    wedges[2] = 1.0;
    MUST(fixpair_binning_init(binning, edges, EDGES));
    binning->second = FIXPAIR_SECOND_COSINE;
    binning->second_edges = wedges;
    binning->second_edges_len = 3;
    binning->orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2;
    return binning;
}

/* `out` is some output. */
static void refuse_binnings(fixpair_binning *binning, void *out) {
    uint64_t *edges = (uint64_t *)(uintptr_t)binning->edges;
    double *wedges = (double *)(uintptr_t)binning->second_edges;
    REFUSED(FIXPAIR_ERROR_VERSION, binning->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, binning->struct_size++);
    REFUSED(FIXPAIR_ERROR_CHOICE, binning->second = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, binning->second = -1);
    REFUSED(FIXPAIR_ERROR_LENGTH, binning->second = FIXPAIR_SECOND_NONE);
    REFUSED(FIXPAIR_ERROR_NULL, binning->edges = NULL);
    REFUSED(FIXPAIR_ERROR_NULL, binning->second_edges = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, binning->edges = (uint64_t *)(void *)((char *)edges + 4));
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, binning->second_edges = (double *)(void *)((char *)wedges + 1));
    REFUSED(FIXPAIR_ERROR_OVERLAP, binning->edges = (uint64_t *)out);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, binning->edges_len = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, binning->second_edges_len = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_TABLE, binning->edges_len = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, binning->edges_len = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, binning->second_edges_len = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, binning->second_edges_len = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, edges[2] = edges[1]);
    REFUSED(FIXPAIR_ERROR_TABLE, edges[0] = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_TABLE, wedges[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_TABLE, wedges[2] = 1.5);
    REFUSED(FIXPAIR_ERROR_TABLE, wedges[0] = -0.5);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, wedges[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, wedges[2] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, binning->axis[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, binning->axis[2] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, binning->axis[2] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, binning->orders = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, binning->orders = 32);
    REFUSED(FIXPAIR_ERROR_RANGE, binning->orders = UINT32_MAX);
}

/* As refuse_bricks, for one that may run over the edge of the mesh. */
static void refuse_regions(fixpair_brick *region) {
    size_t n = region->n;
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, region->n = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, region->n = n + 1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, region->n = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_CHOICE, region->space = 2);
    REFUSED(FIXPAIR_ERROR_CHOICE, region->space = INT32_MIN);
    REFUSED(FIXPAIR_ERROR_BRICK, region->space = FIXPAIR_SPACE_FOURIER);
    REFUSED(FIXPAIR_ERROR_BRICK, region->start[0] = n);
    REFUSED(FIXPAIR_ERROR_BRICK, region->start[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_BRICK, region->count[1] = n + 1);
    REFUSED(FIXPAIR_ERROR_BRICK, region->count[2] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_BRICK, region->stride[2] = 0);
    REFUSED(FIXPAIR_ERROR_BRICK, region->stride[0] = region->stride[1]);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, region->stride[0] = SIZE_MAX);
}

static void refuse_windows(void) {
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 0);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 5);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
}

static void refuse_shifts(int d) {
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[d] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[d] = (double)INFINITY);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = 1.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[d] = -0.25);
}

static void ghosts_of_bricks(void) {
    fixpair_brick *brick;
    begin("brick_with_ghosts", call_brick_with_ghosts);
    STRUCT(0, OUT, fixpair_brick);
    brick = STRUCT(1, IN, fixpair_brick);
    MUST(fixpair_brick_slab(brick, SIDE, FIXPAIR_SPACE_CONFIGURATION, 4, 2));
    t.a.i[0] = FIXPAIR_WINDOW_CIC;
    refuse_pointers_and_lengths();
    refuse_regions(brick);
    REFUSED(FIXPAIR_ERROR_BRICK, brick->start[0] = 5);
    refuse_windows();
    refuse_shifts(0);
}

static void edges_of_bins(void) {
    double *wavenumbers;
    int i;
    begin("edges_uniform", call_edges_uniform);
    ARRAY(0, OUT, uint64_t, EDGES);
    length(0, EDGES, FREE);
    t.a.d[0] = t.a.d[1] = 1.0;
    refuse_pointers_and_lengths();
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = -(double)INFINITY);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[i] = 1e300);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -1.0);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.d[1] = 0.0);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.d[1] = 1e-6);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 0);

    begin("edges_wavenumbers", call_edges_wavenumbers);
    ARRAY(0, OUT, uint64_t, EDGES);
    wavenumbers = ARRAY(1, IN, double, EDGES);
    for (i = 0; i < EDGES; i++) {
        wavenumbers[i] = 0.1 * (i + 1);
    }
    length(0, EDGES, FREE);
    t.a.d[0] = BOX;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1e300);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, wavenumbers[2] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, wavenumbers[0] = -0.1);
    REFUSED(FIXPAIR_ERROR_TABLE, wavenumbers[2] = wavenumbers[1]);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 1);

    begin("edges_exact", call_edges_exact);
    ARRAY(0, OUT, uint64_t, EDGES);
    length(0, EDGES, FREE);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.u = UINT64_MAX - 1);
}

static void binnings(void) {
    fixpair_binning *binning;
    fixpair_bin *bins;
    uint64_t *edges;
    int64_t *sums;
    double *noise;
    size_t bins_len, values_len, words, *pairs;
    begin("binning_init", call_binning_init);
    STRUCT(0, OUT, fixpair_binning);
    edges = ARRAY(1, IN, uint64_t, EDGES);
    memcpy(edges, some_edges, sizeof some_edges);
    length(0, EDGES, FREE);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[0] = 1);
    REFUSED(FIXPAIR_ERROR_TABLE, edges[1] = edges[0]);

    begin("binning_lengths", call_binning_lengths);
    ARRAY(0, OUT, size_t, 1);
    ARRAY(1, OUT, size_t, 1);
    ARRAY(2, OUT, size_t, 1);
    binning = binning_at(3);
    length(0, 2, FREE);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
    refuse_binnings(binning, t.a.p[0]);
    restore();
    MUST(fixpair_binning_lengths(&bins_len, &values_len, &words, binning, 2));

    begin("binning_read", call_binning_read);
    ARRAY(0, OUT, fixpair_bin, bins_len);
    ARRAY(1, OUT, double, values_len);
    sums = ARRAY(2, IN, int64_t, words);
    binning = binning_at(3);
    length(0, bins_len, EXACT);
    length(1, values_len, EXACT);
    length(2, words, EXACT);
    length(3, 2, FREE);
    refuse_pointers_and_lengths();
    CHECK(sums[0] == 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[3] = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[3] = 1);
    refuse_binnings(binning, t.a.p[0]);

    begin("binning_normalise", call_binning_normalise);
    ARRAY(0, OUT, double, values_len);
    bins = ARRAY(1, IN, fixpair_bin, bins_len);
    bins[0].count = 2;
    length(0, values_len, EXACT);
    length(1, bins_len, EXACT);
    t.a.u = 5;
    t.a.d[0] = 2.0;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 32);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)INFINITY);

    begin("subtract_shot_noise", call_subtract_shot_noise);
    ARRAY(0, OUT, double, values_len);
    pairs = ARRAY(1, IN, size_t, 4);
    pairs[2] = pairs[3] = 1;
    bins = ARRAY(2, IN, fixpair_bin, bins_len);
    bins[0].count = 2;
    noise = ARRAY(3, IN, double, 2);
    length(0, values_len, EXACT);
    length(1, 2, EXACT);
    length(2, bins_len, EXACT);
    length(3, 2, FREE);
    t.a.u = 5;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[3] = 1);
    REFUSED(FIXPAIR_ERROR_RANGE, pairs[3] = 2);
    REFUSED(FIXPAIR_ERROR_RANGE, pairs[0] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.u = 64);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, noise[1] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, noise[0] = (double)INFINITY);
}

static void scratch_of_sums(void) {
    fixpair_binning *binning;
    fixpair_brick *brick;
    int which;
    for (which = 0; which < 2; which++) {
        int32_t space = which ? FIXPAIR_SPACE_CONFIGURATION : FIXPAIR_SPACE_FOURIER;
        begin(which ? "correlation_sums_scratch" : "power_sums_scratch",
              which ? call_correlation_sums_scratch : call_power_sums_scratch);
        STRUCT(0, OUT, fixpair_layout);
        brick = STRUCT(1, IN, fixpair_brick);
        binning = binning_at(2);
        MUST(fixpair_brick_whole(brick, SIDE, space, 0));
        length(0, 2, FREE);
        refuse_pointers_and_lengths();
        REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[0] = 0);
        refuse_bricks(brick);
        refuse_binnings(binning, t.a.p[0]);
    }
    for (which = 0; which < 2; which++) {
        begin(which ? "compensate_scratch" : "correlation_modes_scratch",
              which ? call_compensate_scratch : call_correlation_modes_scratch);
        STRUCT(0, OUT, fixpair_layout);
        brick = STRUCT(1, IN, fixpair_brick);
        MUST(fixpair_brick_whole(brick, SIDE, FIXPAIR_SPACE_FOURIER, 0));
        refuse_pointers_and_lengths();
        refuse_bricks(brick);
    }
}

/* Edges at p[pointer]. */
static uint64_t *edges_at(int pointer) {
    uint64_t *edges = ARRAY(pointer, IN, uint64_t, EDGES);
    memcpy(edges, some_edges, sizeof some_edges);
    return edges;
}

static uint32_t *triangles_at(int pointer) {
    uint32_t *triangles = ARRAY(pointer, IN, uint32_t, 3 * TRIANGLES);
    memcpy(triangles, some_triangles, sizeof some_triangles);
    return triangles;
}

/* Edges of shells, their length being n[number]. */
static void refuse_shells(uint64_t *edges, int number) {
    REFUSED(FIXPAIR_ERROR_TABLE, edges[2] = edges[1]);
    REFUSED(FIXPAIR_ERROR_TABLE, edges[0] = UINT64_MAX);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[number] = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, t.a.n[number] = 1);
}

static void lists_of_triangles(void) {
    uint64_t *edges;
    double *centres;
    size_t count, i;
    int which;
    MUST(fixpair_closed_triangle_count(&count, some_edges, EDGES, NULL));
    for (which = 0; which < 2; which++) {
        begin(which ? "closed_triangles" : "closed_triangle_count",
              which ? call_closed_triangles : call_closed_triangle_count);
        argument(0, OUT, which ? 3 * count * sizeof(uint32_t) : sizeof(size_t), which ? sizeof(uint32_t) : sizeof(size_t));
        edges = edges_at(1);
        centres = ARRAY(2, IN, double, SHELLS);
        t.slots[2].optional = 1;
        for (i = 0; i < SHELLS; i++) {
            centres[i] = (double)i;
        }
        if (which) {
            size_t centred;
            MUST(fixpair_closed_triangle_count(&centred, edges, EDGES, centres));
            length(0, centred, EXACT);
            /* As much of it as is written with centres. */
            t.slots[0].size = 3 * centred * sizeof(uint32_t);
        }
        length(which, EDGES, FREE);
        refuse_pointers_and_lengths();
        ACCEPTED((t.a.p[2] = NULL, t.a.n[0] = which ? count : EDGES));
        refuse_shells(edges, which);
        REFUSED(FIXPAIR_ERROR_TABLE, centres[2] = centres[1]);
        REFUSED(FIXPAIR_ERROR_TABLE, centres[0] = -1.0);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, centres[1] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, centres[2] = (double)INFINITY);
    }
    begin("squeezed_triangles", call_squeezed_triangles);
    ARRAY(0, OUT, uint32_t, 6);
    length(0, 2, EXACT);
    t.a.n[1] = 1;
    t.a.n[2] = 3;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 3);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = SIZE_MAX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[2] = 0);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[2] = 4);
}

static void counts_of_triangles(void) {
    fixpair_layout layout;
    uint64_t *edges;
    uint32_t *triangles;
    int which;
    MUST(fixpair_triangle_counts_scratch(&layout, some_triangles, TRIANGLES, some_edges, EDGES, SIDE));
    for (which = 0; which < 2; which++) {
        begin(which ? "triangle_counts" : "triangle_counts_scratch",
              which ? call_triangle_counts : call_triangle_counts_scratch);
        argument(0, OUT, which ? TRIANGLES * sizeof(uint64_t) : sizeof layout, sizeof(uint64_t));
        triangles = triangles_at(1);
        edges = edges_at(2);
        length(0, TRIANGLES, FREE);
        length(1, EDGES, FREE);
        t.a.n[2] = SIDE;
        if (which) {
            SCRATCH_OF(3, layout.size);
            length(3, layout.size, SCRATCH);
            exec_at(4);
        }
        refuse_pointers_and_lengths();
        refuse_shells(edges, 1);
        REFUSED(FIXPAIR_ERROR_RANGE, edges[3] = 10);
        REFUSED(FIXPAIR_ERROR_RANGE, triangles[4] = SHELLS);
        REFUSED(FIXPAIR_ERROR_RANGE, triangles[0] = UINT32_MAX);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 3);
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[2] = 0);
        REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[2] = 7);
        REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[2] = SIZE_MAX - 1);
    }
}

static void numbers_of_triangles(void) {
    uint32_t *triangles;
    double *values, *power;
    int64_t *sums;
    int which, i;
    begin("bispectrum_values", call_bispectrum_values);
    ARRAY(0, OUT, double, TRIANGLES);
    sums = ARRAY(1, IN, int64_t, SUM * TRIANGLES);
    length(0, TRIANGLES, EXACT);
    length(1, SUM * TRIANGLES, EXACT);
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, sums[SUM - 1] = 1);
    ACCEPTED((t.a.n[0] = t.a.n[1] = 0, t.a.p[0] = NULL, t.a.p[1] = NULL));

    begin("bispectrum_normalise", call_bispectrum_normalise);
    values = ARRAY(0, OUT, double, TRIANGLES);
    ((uint64_t *)ARRAY(1, IN, uint64_t, TRIANGLES))[0] = 3;
    length(0, TRIANGLES, FREE);
    t.a.n[1] = SIDE;
    t.a.d[0] = BOX;
    t.a.d[1] = 1.0;
    values[0] = 1.0;
    refuse_pointers_and_lengths();
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1e100);
    for (i = 0; i < 2; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[i] = (double)INFINITY);
    }
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, values[2] = (double)NAN);

    for (which = 0; which < 2; which++) {
        begin(which ? "bispectrum_reduced" : "bispectrum_shot_noise",
              which ? call_bispectrum_reduced : call_bispectrum_shot_noise);
        ARRAY(0, OUT, double, TRIANGLES);
        values = which ? ARRAY(1, IN, double, TRIANGLES) : NULL;
        triangles = triangles_at(1 + which);
        power = ARRAY(2 + which, IN, double, SHELLS);
        power[0] = power[1] = power[2] = 1.0;
        length(0, TRIANGLES, FREE);
        length(1, SHELLS, FREE);
        refuse_pointers_and_lengths();
        REFUSED(FIXPAIR_ERROR_RANGE, triangles[6] = SHELLS);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = SHELLS - 1);
        REFUSED(FIXPAIR_ERROR_RANGE, t.a.n[1] = 0);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, power[1] = (double)NAN);
        if (which) {
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, values[1] = (double)INFINITY);
            REFUSED(FIXPAIR_ERROR_RANGE, (values[0] = 1e300, power[0] = power[1] = 1e-100));
        } else {
            REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
            REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 1e200);
        }
    }
}
