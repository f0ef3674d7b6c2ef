/*
 * The part of conformance.c about spectra, correlation functions and bispectra, in one precision.
 */

/* Bins and values of sums, which it gives back. */
static uint64_t X(read)(uint64_t hash, int64_t *sums, size_t sums_len, const fixpair_binning *binning, size_t spectra,
                        double factor, const size_t *pairs) {
    const double noises[2] = {1.5, 2.5};
    size_t bins_len, values_len, words;
    fixpair_bin *bins;
    double *values;
    MUST(fixpair_binning_lengths(&bins_len, &values_len, &words, binning, spectra));
    bins = (fixpair_bin *)take(bins_len * sizeof *bins);
    values = (double *)take(values_len * sizeof *values);
    MUST(fixpair_binning_read(bins, bins_len, values, values_len, sums, sums_len, binning, spectra));
    if (factor != 0) {
        MUST(fixpair_binning_normalise(values, values_len, bins, bins_len, binning->orders, factor));
    }
    if (pairs != NULL) {
        MUST(fixpair_subtract_shot_noise(values, values_len, pairs, spectra, bins, bins_len, binning->orders, noises, 2));
    }
    hash = hash_bytes(hash, bins, bins_len * sizeof *bins);
    hash = hash_bytes(hash, values, values_len * sizeof *values);
    give_back(bins);
    give_back(values);
    give_back(sums);
    return hash;
}

/* The sums of spectra of f and g on the whole mesh, which those of two slabs have to be too. */
static int64_t *X(sums)(const REAL *const *fields, size_t length, const size_t *pairs, size_t pairs_len,
                        const int32_t *compensation, const fixpair_brick *brick, const fixpair_binning *binning,
                        fixpair_layout *layout, size_t *words, const fixpair_exec *exec) {
    const size_t plane = 2 * brick->stride[0];
    size_t bins, values;
    int64_t *sums, *parts;
    void *scratch;
    int part;
    MUST(fixpair_binning_lengths(&bins, &values, words, binning, pairs_len));
    sums = (int64_t *)take(*words * sizeof *sums);
    parts = (int64_t *)take(*words * sizeof *parts);
    MUST(fixpair_power_sums_scratch(layout, brick, binning, pairs_len));
    scratch = take_scratch(layout->size);
    MUST(X(fixpair_power_sums)(sums, *words, fields, 2, length, pairs, pairs_len, compensation, brick, binning,
                               scratch, layout->size, exec));
    give_back(scratch);
    for (part = 0; part < 2; part++) {
        size_t first = part == 0 ? 0 : 5, planes = part == 0 ? 5 : N - 5;
        const REAL *starts[2];
        fixpair_layout needed;
        fixpair_brick slab;
        starts[0] = fields[0] + first * plane;
        starts[1] = fields[1] + first * plane;
        MUST(fixpair_brick_slab(&slab, N, FIXPAIR_SPACE_FOURIER, first, planes));
        MUST(fixpair_power_sums_scratch(&needed, &slab, binning, pairs_len));
        scratch = take_scratch(needed.size);
        MUST(X(fixpair_power_sums)(parts, *words, starts, 2, planes * plane, pairs, pairs_len, compensation, &slab,
                                   binning, scratch, needed.size, exec));
        give_back(scratch);
    }
    CHECK(memcmp(sums, parts, *words * sizeof *sums) == 0);
    give_back(parts);
    return sums;
}

static void X(powers)(const REAL *f, const REAL *g, size_t length, const fixpair_brick *brick,
                      const fixpair_exec *exec) {
    static const size_t pairs[] = {0, 0, 0, 1}, more[] = {0, 0, 1, 1, 1, 0};
    static const int32_t aliased[2] = {FIXPAIR_COMPENSATION_NONE, FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_CIC};
    static const int32_t windows[2] = {FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC,
                                       FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC};
    const REAL *fields[2];
    fixpair_binning binning, second = wedge_binning();
    fixpair_layout layout;
    REAL *weights = X(reals)(1500);
    double noises[2];
    int64_t *sums;
    size_t words, i;
    fields[0] = f;
    fields[1] = g;
    MUST(fixpair_binning_init(&binning, edges, EDGES));
    binning.axis[2] = 2.0;
    binning.orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2 | FIXPAIR_MULTIPOLE_4;
    sums = X(sums)(fields, length, pairs, 2, aliased, brick, &binning, &layout, &words, exec);
    check_named("power_sums", "", SUFFIX,
                hash_bytes(hash_layout(HASH_START, layout), sums, words * sizeof *sums));
    check_named("power", "", SUFFIX, X(read)(HASH_START, sums, words, &binning, 2, BOX * BOX * BOX, pairs));
    sums = X(sums)(fields, length, more, 3, windows, brick, &second, &layout, &words, exec);
    check_named("power", ".wedges", SUFFIX,
                X(read)(hash_bytes(HASH_START, sums, words * sizeof *sums), sums, words, &second, 3, 0.0, NULL));
    for (i = 0; i < 500; i++) {
        weights[3 * i] = (REAL)(1.25 + noise(5 * i));
    }
    MUST(X(fixpair_shot_noise)(&noises[0], weights, 3, 500, BOX));
    MUST(X(fixpair_shot_noise)(&noises[1], NULL, 0, 500, BOX));
    check_named("shot_noise", "", SUFFIX, hash_bytes(HASH_START, noises, sizeof noises));
    give_back(weights);
}

static void X(compensations)(const REAL *f, size_t length, const fixpair_brick *brick, const fixpair_exec *exec) {
    REAL *modes = X(reals)(length);
    fixpair_layout layout;
    uint64_t hash;
    void *scratch;
    int aliased;
    MUST(fixpair_compensate_scratch(&layout, brick));
    scratch = take_scratch(layout.size);
    hash = hash_layout(HASH_START, layout);
    memcpy(modes, f, length * sizeof(REAL));
    for (aliased = 0; aliased < 2; aliased++) {
        int32_t compensation = aliased ? FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_PCS
                                       : FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC;
        MUST(X(fixpair_compensate)(modes, length, compensation, aliased ? -2.0 : 0.3, brick, scratch, layout.size, exec));
        hash = hash_brick(hash, modes, brick, sizeof(REAL));
    }
    check_named("compensate", "", SUFFIX, hash);
    give_back(scratch);
    give_back(modes);
}

static void X(correlations)(const REAL *f, const REAL *g, size_t length, const fixpair_brick *brick,
                            const X(fixpair_fft) *fft, const fixpair_exec *exec) {
    REAL *meshes[2];
    const REAL *both[2];
    fixpair_binning binning;
    fixpair_layout layout;
    size_t bins, values, words;
    int64_t *sums;
    uint64_t hash;
    void *scratch;
    int cross;
    MUST(fixpair_correlation_modes_scratch(&layout, brick));
    scratch = take_scratch(layout.size);
    hash = hash_layout(HASH_START, layout);
    for (cross = 0; cross < 2; cross++) {
        meshes[cross] = X(reals)(length);
        memcpy(meshes[cross], f, length * sizeof(REAL));
        /* Without another field its compensation is not read. */
        MUST(X(fixpair_correlation_modes)(meshes[cross], cross ? g : NULL, length,
                                          FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_CIC,
                                          cross ? FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_PCS : -1, 0.5, brick,
                                          scratch, layout.size, exec));
        hash = hash_brick(hash, meshes[cross], brick, sizeof(REAL));
        CHECK(fft->inverse(fft->context, meshes[cross]) == 0);
    }
    give_back(scratch);
    check_named("correlation_modes", "", SUFFIX, hash);
    MUST(fixpair_binning_init(&binning, edges, EDGES));
    binning.second = FIXPAIR_SECOND_PARALLEL;
    binning.second_edges = parallel;
    binning.second_edges_len = 4;
    MUST(fixpair_correlation_sums_scratch(&layout, &fft->configuration, &binning, 2));
    MUST(fixpair_binning_lengths(&bins, &values, &words, &binning, 2));
    scratch = take_scratch(layout.size);
    sums = (int64_t *)take(words * sizeof *sums);
    both[0] = meshes[0];
    both[1] = meshes[1];
    MUST(X(fixpair_correlation_sums)(sums, words, both, 2, length, &fft->configuration, &binning, scratch,
                                     layout.size, exec));
    hash = hash_bytes(hash_layout(HASH_START, layout), sums, words * sizeof *sums);
    check_named("correlation", "", SUFFIX, X(read)(hash, sums, words, &binning, 2, 1.0, NULL));
    give_back(scratch);
    give_back(meshes[0]);
    give_back(meshes[1]);
}

static void X(bispectra)(const REAL *modes, size_t length, const X(fixpair_fft) *fft, const fixpair_exec *exec) {
    static const double power[SHELLS] = {100.0, 200.0, 300.0, 400.0, 500.0};
    const size_t words = triangles_len * FIXPAIR_BISPECTRUM_WORDS, size = words * sizeof(int64_t), plane = fft->configuration.stride[0];
    double values[TRIANGLES], noises[TRIANGLES], reduced[TRIANGLES];
    int64_t *sums = (int64_t *)take(size), *again = (int64_t *)take(size);
    REAL *shells[SHELLS];
    const REAL *fields[SHELLS];
    fixpair_layout layout, streaming;
    uint64_t hash = HASH_START, sizes = HASH_START;
    void *scratch;
    int i, part, meshes;
    for (i = 0; i < SHELLS; i++) {
        fields[i] = shells[i] = X(reals)(length);
        MUST(X(fixpair_shell_modes)(shells[i], modes, length, &fft->fourier, edges[i], edges[i + 1], exec));
        hash = hash_brick(hash, shells[i], &fft->fourier, sizeof(REAL));
        CHECK(fft->inverse(fft->context, shells[i]) == 0);
    }
    check_named("shell_modes", "", SUFFIX, hash);
    MUST(X(fixpair_bispectrum_sums_scratch)(&layout, &fft->configuration, SHELLS, triangles_len));
    sizes = hash_layout(sizes, layout);
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_bispectrum_sums)(sums, words, triangles, triangles_len, fields, SHELLS, length, &fft->configuration,
                                    scratch, layout.size, exec));
    check_named("bispectrum_sums", "", SUFFIX, hash_bytes(HASH_START, sums, size));
    for (part = 0; part < 2; part++) {
        size_t first = part == 0 ? 0 : 5, planes = part == 0 ? 5 : N - 5;
        fixpair_layout needed;
        fixpair_brick slab;
        for (i = 0; i < SHELLS; i++) {
            fields[i] = shells[i] + first * plane;
        }
        MUST(fixpair_brick_slab(&slab, N, FIXPAIR_SPACE_CONFIGURATION, first, planes));
        MUST(X(fixpair_bispectrum_sums_scratch)(&needed, &slab, SHELLS, triangles_len));
        CHECK(needed.size <= layout.size);
        MUST(X(fixpair_bispectrum_sums)(again, words, triangles, triangles_len, fields, SHELLS, planes * plane, &slab,
                                        scratch, layout.size, exec));
    }
    CHECK(memcmp(sums, again, size) == 0);
    give_back(scratch);
    MUST(X(fixpair_bispectrum_scratch)(&streaming, fft, SHELLS, triangles_len));
    sizes = hash_layout(sizes, streaming);
    scratch = take_scratch(streaming.size);
    for (meshes = 3; meshes <= SHELLS; meshes += SHELLS - 3) {
        size_t reals, transforms;
        REAL *memory;
        MUST(X(fixpair_bispectrum_meshes)(&reals, fft, (size_t)meshes));
        memory = X(reals)(reals);
        memset(again, 0, size);
        MUST(X(fixpair_bispectrum)(again, words, &transforms, triangles, triangles_len, edges, SHELLS + 1, modes, length, fft,
                                   memory, reals, scratch, streaming.size, exec));
        CHECK(memcmp(sums, again, size) == 0);
        sizes = hash_sizes(hash_sizes(sizes, reals), transforms);
        give_back(memory);
    }
    give_back(scratch);
    check_named("bispectrum_sizes", "", SUFFIX, sizes);
    MUST(fixpair_bispectrum_values(values, triangles_len, sums, words));
    MUST(fixpair_bispectrum_normalise(values, triangle_counts, triangles_len, N, BOX, 0.75));
    MUST(fixpair_bispectrum_shot_noise(noises, triangles, triangles_len, power, SHELLS, 3.5));
    MUST(fixpair_bispectrum_reduced(reduced, values, triangles, triangles_len, power, SHELLS));
    hash = hash_bytes(HASH_START, values, triangles_len * sizeof *values);
    hash = hash_bytes(hash, noises, triangles_len * sizeof *noises);
    check_named("bispectrum", "", SUFFIX, hash_bytes(hash, reduced, triangles_len * sizeof *reduced));
    for (i = 0; i < SHELLS; i++) {
        give_back(shells[i]);
    }
    give_back(sums);
    give_back(again);
}

static void X(estimates)(const fixpair_exec *exec) {
    fixpair_realisation realisation;
    X(built_in) transform;
    REAL *f, *g;
    size_t length;
    X(open)(&transform, N, 0, exec);
    f = X(array_of)(&transform.fft.fourier, &length);
    g = X(reals)(length);
    MUST(fixpair_realisation_init(&realisation, SEED));
    MUST(X(fixpair_white_modes)(f, length, &transform.fft.fourier, &realisation, NULL, 0, exec));
    realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    realisation.phase = FIXPAIR_PHASE_INVERTED;
    MUST(X(fixpair_white_modes)(g, length, &transform.fft.fourier, &realisation, NULL, 0, exec));
    CHECK(length == transform.fft.length);
    X(powers)(f, g, length, &transform.fft.fourier, exec);
    X(compensations)(f, length, &transform.fft.fourier, exec);
    X(correlations)(f, g, length, &transform.fft.fourier, &transform.fft, exec);
    X(bispectra)(f, length, &transform.fft, exec);
    give_back(f);
    give_back(g);
    X(close)(&transform);
}
