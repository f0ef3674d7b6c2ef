/*
 * The part of fuzz.c about particles, spectra, correlation functions and bispectra.
 */

enum { WORDS = 16384, BYTES = 1 << 20, CLOUD = 64 };

/* Small numbers mostly, so that some sets get far. */
static size_t few(size_t below) {
    return word() % 4 ? (size_t)(word() % below) : size();
}

/* A part of a mesh that may run over its edge, or anything. */
static fixpair_brick region(void) {
    fixpair_brick result = brick();
    if (word() % 2) {
        fixpair_brick ghosted;
        sane(fixpair_brick_with_ghosts(&ghosted, &result, choice(), maybe(0.5)));
        if (fixpair_brick_with_ghosts(&ghosted, &result, 1 + (int32_t)(word() % 4), 0.5) == FIXPAIR_OK) {
            return ghosted;
        }
    }
    return result;
}

static void clouds(double *data, float *single, double *scratch) {
    fixpair_brick b = region(), c = region();
    fixpair_layout layout = {0, 0};
    fixpair_positions_f64 position;
    fixpair_positions_f32 narrow;
    double *places = data + LENGTH, box = maybe(100.0), shift = word() % 2 ? 0.0 : maybe(0.5);
    int32_t window = choice();
    size_t i;
    for (i = 0; i < 3 * CLOUD; i++) {
        places[i] = word() % 64 ? 100.0 * (double)(word() >> 11) / 9007199254740992.0 : number();
        single[LENGTH / 2 + i] = (float)(word() % 100);
    }
    position.x = places;
    position.y = places + 1;
    position.z = places + 2;
    position.stride = 3;
    position.length = CLOUD;
    narrow.x = single + LENGTH / 2;
    narrow.y = narrow.x + 1;
    narrow.z = narrow.x + 2;
    narrow.stride = 3;
    narrow.length = CLOUD;
    sane(fixpair_deposit_scratch_f64(&layout, &b, few(100), window));
    sane(fixpair_read_out_scratch_f32(&layout, &b, few(100), window));
    sane(fixpair_deposit_f64(data, LENGTH, &b, &position, NULL, size(), box, window, shift, scratch, BYTES, NULL));
    sane(fixpair_deposit_f64(data, LENGTH, &b, &position, places + 3 * CLOUD, 1, box, window, shift, scratch, BYTES, NULL));
    sane(fixpair_deposit_f32(single, LENGTH / 2, &b, &narrow, NULL, 0, box, window, shift, scratch, BYTES, NULL));
    sane(fixpair_read_out_f64(places + 3 * CLOUD, 1, data, LENGTH, &b, &position, box, window, shift, scratch, BYTES,
                              NULL));
    sane(fixpair_add_cells_f64(data, LENGTH, &b, data + LENGTH, LENGTH, &c, NULL));
    sane(fixpair_copy_cells_f64(data, LENGTH, &b, data + LENGTH, LENGTH, &c, NULL));
    b = brick();
    sane(fixpair_interlace_f64(data, data + LENGTH, LENGTH, &b, NULL));
}

static void estimates(double *data, float *single, double *scratch, int64_t *sums) {
    fixpair_brick b = brick();
    fixpair_binning binning;
    fixpair_layout layout = {0, 0};
    fixpair_bin bins[64];
    const double *fields[3];
    const float *narrow[1];
    double second[4], values[256] = {0.0}, noises[2];
    uint64_t edges[5], counts[4];
    uint32_t triangles[12];
    size_t pairs[4], numbers[3], spectra = few(3), shells = few(5), i;
    edges[0] = few(4);
    for (i = 1; i < 5; i++) {
        edges[i] = word() % 16 ? edges[i - 1] + 1 + word() % 8 : word();
    }
    for (i = 0; i < 4; i++) {
        second[i] = maybe((double)i / 3.0);
    }
    for (i = 0; i < 12; i++) {
        triangles[i] = word() % 32 ? (uint32_t)(word() % 4) : (uint32_t)word();
    }
    for (i = 0; i < 4; i++) {
        pairs[i] = few(2);
        counts[i] = word() % 4;
    }
    binning.struct_size = sizeof binning;
    binning.edges = edges;
    binning.edges_len = word() % 8 ? 5 : (size_t)(word() % 6);
    binning.second = word() % 2 ? 0 : choice();
    binning.orders = word() % 4 ? 1 : (uint32_t)word() >> (word() % 32);
    binning.second_edges = second;
    binning.second_edges_len = binning.second == 0 ? 0 : 4;
    for (i = 0; i < 3; i++) {
        binning.axis[i] = maybe((double)i);
    }
    fields[0] = fields[2] = data;
    fields[1] = data + LENGTH;
    narrow[0] = single;
    noises[0] = noises[1] = maybe(1.0);
    sane(fixpair_edges_uniform(edges, 5, maybe(1.0), maybe(1.0)));
    sane(fixpair_edges_wavenumbers(edges, second, 4, maybe(100.0)));
    sane(fixpair_edges_exact(edges, word() % 6, word() % 4 ? few(9) : word()));
    sane(fixpair_power_sums_scratch(&layout, &b, &binning, size()));
    sane(fixpair_correlation_sums_scratch(&layout, &b, &binning, size()));
    if (fixpair_binning_lengths(&numbers[0], &numbers[1], &numbers[2], &binning, spectra) == FIXPAIR_OK
        && numbers[0] <= 64 && numbers[1] <= 256 && numbers[2] <= WORDS && spectra <= 2) {
        fixpair_status_t status;
        memset(sums, 0, WORDS * sizeof *sums);
        sane(fixpair_power_sums_f64(sums, numbers[2], fields, 2, LENGTH, pairs, spectra, NULL, &b, &binning,
                                    scratch, BYTES, NULL));
        sane(fixpair_power_sums_f32(sums, numbers[2], narrow, 1, LENGTH, pairs, spectra, NULL, &b, &binning,
                                    scratch, BYTES, NULL));
        sane(fixpair_correlation_sums_f64(sums, numbers[2], fields, spectra, LENGTH, &b, &binning, scratch, BYTES, NULL));
        status = fixpair_binning_read(bins, numbers[0], values, numbers[1], sums, numbers[2], &binning, spectra);
        sane(status);
        if (status == FIXPAIR_OK) {
            sane(fixpair_binning_normalise(values, numbers[1], bins, numbers[0], binning.orders, maybe(1.0)));
            sane(fixpair_subtract_shot_noise(values, numbers[1], pairs, spectra, bins, numbers[0], binning.orders, noises,
                                             word() % 3));
        }
    }
    sane(fixpair_shot_noise_f64(noises, data, word() % 3, few(LENGTH) % LENGTH, maybe(100.0)));
    sane(fixpair_compensate_scratch(&layout, &b));
    sane(fixpair_compensate_f64(data, LENGTH, word() % 2 ? choice() : 18, maybe(1.0), &b, scratch, BYTES, NULL));
    sane(fixpair_compensate_f32(single, LENGTH / 2, 33 + choice(), maybe(1.0), &b, scratch, size(), NULL));
    sane(fixpair_correlation_modes_scratch(&layout, &b));
    sane(fixpair_correlation_modes_f64(data, data + LENGTH, LENGTH, word() % 2 ? choice() : 34, choice() + 16, maybe(1.0), &b,
                                       scratch, BYTES, NULL));
    sane(fixpair_closed_triangle_count(numbers, edges, 5, word() % 2 ? second : NULL));
    sane(fixpair_closed_triangles(triangles, 4, edges, word() % 6, NULL));
    sane(fixpair_squeezed_triangles(triangles, 1 + word() % 4, few(4), few(6)));
    sane(fixpair_triangle_counts_scratch(&layout, triangles, 4, edges, 5, size()));
    sane(fixpair_triangle_counts(counts, triangles, 4, edges, 5, 2 * few(8), scratch, BYTES, NULL));
    sane(fixpair_shell_modes_f64(data, data + LENGTH, LENGTH, &b, few(5), few(20), NULL));
    sane(fixpair_bispectrum_sums_scratch_f64(&layout, &b, shells, size()));
    sane(fixpair_bispectrum_sums_f64(sums, 4 * FIXPAIR_BISPECTRUM_WORDS, triangles, 4, fields, shells % 4, LENGTH, &b, scratch,
                                     BYTES, NULL));
    sane(fixpair_bispectrum_values(values, 4, sums, word() % 4 ? 4 * FIXPAIR_BISPECTRUM_WORDS : word() % WORDS));
    values[0] = maybe(1.0);
    sane(fixpair_bispectrum_normalise(values, counts, 4, size(), maybe(100.0), maybe(1.0)));
    sane(fixpair_bispectrum_shot_noise(values, triangles, 4, second, 4, maybe(1.0)));
    sane(fixpair_bispectrum_reduced(values, values + 4, triangles, 4, second, 4));
}

static void bispectra(double *data, double *scratch, int64_t *sums, const fixpair_fft_f64 *fft) {
    const uint64_t edges[4] = {word() % 3, 2 + word() % 4, 6 + word() % 4, 10 + word() % 8};
    uint32_t triangles[6];
    fixpair_layout layout;
    size_t reals, i;
    for (i = 0; i < 6; i++) {
        triangles[i] = (uint32_t)(word() % 4);
    }
    memset(sums, 0, WORDS * sizeof *sums);
    sane(fixpair_bispectrum_meshes_f64(&reals, fft, size()));
    sane(fixpair_bispectrum_scratch_f64(&layout, fft, few(5), size()));
    sane(fixpair_bispectrum_f64(sums, 2 * FIXPAIR_BISPECTRUM_WORDS, NULL, triangles, 2, edges, 1 + word() % 4, data,
                                640 + word() % 2, fft, data + LENGTH, few(LENGTH) % LENGTH, scratch, BYTES, NULL));
}
