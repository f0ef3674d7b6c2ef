/*
 * The part of bits.c about sums over modes, separations and triangles, in one precision, of meshes that come from no transform.
 */

/* Sums are integers: those of the pieces of a mesh, added to one array, are those of the whole. */
static void X(powers)(void) {
    static const uint64_t edges[EDGES_OF_SHELLS] = {1, 10, 40, 90, 200, 500, 1200};
    static const double wedges[4] = {0.0, 0.4, 0.8, 1.0};
    static const size_t pairs[4] = {0, 0, 0, 1};
    static const int32_t compensation[2] = {FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_CIC, FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_PCS};
    const size_t volume = X(volume)(MESH, FIXPAIR_SPACE_FOURIER);
    REAL *mesh[2];
    fixpair_brick bricks[MOST_PIECES];
    size_t pieces = pieces_of(bricks, MESH, FIXPAIR_SPACE_FOURIER, 0), bins, values_len, words, i, field;
    int kind;
    mesh[0] = X(numbers)(volume, 1, 2.0);
    mesh[1] = X(numbers)(volume, 2, 1.0);
    for (kind = 0; kind < 2; kind++) {
        fixpair_binning binning;
        int64_t *sums;
        MUST(fixpair_binning_init(&binning, edges, EDGES_OF_SHELLS));
        binning.orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2 | FIXPAIR_MULTIPOLE_4;
        if (kind == 1) {
            binning.axis[0] = 1.0;
            binning.orders |= FIXPAIR_MULTIPOLE_1;
            binning.second = FIXPAIR_SECOND_COSINE;
            binning.second_edges = wedges;
            binning.second_edges_len = 4;
        }
        MUST(fixpair_binning_lengths(&bins, &values_len, &words, &binning, 2));
        sums = (int64_t *)take(words * sizeof *sums);
        for (i = 0; i < pieces; i++) {
            const REAL *fields[2];
            REAL *parts[2];
            fixpair_layout layout;
            size_t length = 0;
            void *scratch;
            for (field = 0; field < 2; field++) {
                fields[field] = parts[field] = X(part)(mesh[field], &bricks[i], &length);
            }
            MUST(fixpair_power_sums_scratch(&layout, &bricks[i], &binning, 2));
            scratch = take(layout.size);
            MUST(X(fixpair_power_sums)(sums, words, fields, 2, length, pairs, 2, compensation, &bricks[i], &binning, scratch, layout.size,
                                       exec));
            give_back(scratch);
            give_back(parts[0]);
            give_back(parts[1]);
        }
        line_of_bytes(EXACT, kind == 0 ? "power_sums.multipoles" : "power_sums.wedges", SUFFIX, sums, words * sizeof *sums);
        give_back(sums);
    }
    give_back(mesh[0]);
    give_back(mesh[1]);
}

static void X(correlate)(REAL *data, size_t length, const fixpair_brick *brick, const void *context) {
    fixpair_layout layout;
    void *scratch;
    (void)context;
    MUST(fixpair_correlation_modes_scratch(&layout, brick));
    scratch = take(layout.size);
    MUST(X(fixpair_correlation_modes)(data, NULL, length, FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_CIC, 0, 0.5, brick, scratch,
                                      layout.size, exec));
    give_back(scratch);
}

static void X(correlations)(void) {
    static const uint64_t edges[EDGES_OF_SHELLS] = {0, 10, 40, 90, 200, 300, 500};
    const size_t volume = X(volume)(MESH, FIXPAIR_SPACE_FOURIER);
    REAL *mesh = X(numbers)(volume, 3, 1.0);
    fixpair_brick bricks[MOST_PIECES];
    fixpair_binning binning;
    size_t pieces = pieces_of(bricks, MESH, FIXPAIR_SPACE_CONFIGURATION, 0), bins, values_len, words, i;
    int64_t *sums;
    X(each)(mesh, MESH, FIXPAIR_SPACE_FOURIER, 1, X(correlate), NULL);
    X(line_of_reals)(EXACT, "correlation_modes", 0, mesh, volume);
    MUST(fixpair_binning_init(&binning, edges, EDGES_OF_SHELLS));
    binning.orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2;
    MUST(fixpair_binning_lengths(&bins, &values_len, &words, &binning, 1));
    sums = (int64_t *)take(words * sizeof *sums);
    for (i = 0; i < pieces; i++) {
        const REAL *fields[1];
        fixpair_layout layout;
        size_t length;
        void *scratch;
        REAL *data = X(part)(mesh, &bricks[i], &length);
        fields[0] = data;
        MUST(fixpair_correlation_sums_scratch(&layout, &bricks[i], &binning, 1));
        scratch = take(layout.size);
        MUST(X(fixpair_correlation_sums)(sums, words, fields, 1, length, &bricks[i], &binning, scratch, layout.size, exec));
        give_back(scratch);
        give_back(data);
    }
    line_of_bytes(EXACT, "correlation_sums", SUFFIX, sums, words * sizeof *sums);
    give_back(sums);
    give_back(mesh);
}

/* Sums of x slabs are those of the whole; other cuts are not promised. */
static void X(bispectra)(void) {
    static const uint64_t edges[EDGES_OF_SHELLS] = {1, 4, 9, 16, 25, 36, 49};
    fixpair_brick bricks[MOST_PIECES];
    size_t pieces = pieces_of(bricks, MESH, FIXPAIR_SPACE_CONFIGURATION, 0), triangles_len, words, i, s;
    REAL *shells[SHELLS_OF_MODES];
    uint32_t *triangles;
    int64_t *sums;
    if (cut == PENCILS) {
        return;
    }
    MUST(fixpair_closed_triangle_count(&triangles_len, edges, EDGES_OF_SHELLS, NULL));
    triangles = (uint32_t *)take(3 * triangles_len * sizeof *triangles);
    MUST(fixpair_closed_triangles(triangles, triangles_len, edges, EDGES_OF_SHELLS, NULL));
    words = triangles_len * FIXPAIR_BISPECTRUM_WORDS;
    sums = (int64_t *)take(words * sizeof *sums);
    for (s = 0; s < SHELLS_OF_MODES; s++) {
        shells[s] = X(numbers)(MESH * MESH * MESH, 20 + s, 1.0);
    }
    for (i = 0; i < pieces; i++) {
        const REAL *fields[SHELLS_OF_MODES];
        REAL *parts[SHELLS_OF_MODES];
        fixpair_layout layout;
        size_t length = 0;
        void *scratch;
        for (s = 0; s < SHELLS_OF_MODES; s++) {
            fields[s] = parts[s] = X(part)(shells[s], &bricks[i], &length);
        }
        MUST(X(fixpair_bispectrum_sums_scratch)(&layout, &bricks[i], SHELLS_OF_MODES, triangles_len));
        scratch = take(layout.size);
        MUST(X(fixpair_bispectrum_sums)(sums, words, triangles, triangles_len, fields, SHELLS_OF_MODES, length, &bricks[i], scratch,
                                        layout.size, exec));
        give_back(scratch);
        for (s = 0; s < SHELLS_OF_MODES; s++) {
            give_back(parts[s]);
        }
    }
    line_of_bytes(EXACT, "bispectrum_sums", SUFFIX, sums, words * sizeof *sums);
    for (s = 0; s < SHELLS_OF_MODES; s++) {
        give_back(shells[s]);
    }
    give_back(sums);
    give_back(triangles);
}
