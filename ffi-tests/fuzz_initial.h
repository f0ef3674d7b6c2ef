/*
 * The part of fuzz.c about shapes, species, the third order and the host's own positions.
 */

/* Entries of a mode table of side 8. */
enum { KERNEL = 3, TABLE = 49 };

/* A length that the memory has. */
static size_t at_most(size_t length) {
    return word() % 8 ? length : few(length) % (length + 1);
}

/* Rows whose exponents mostly sum to 0. */
static void some_rows(fixpair_shape_row *rows) {
    int i;
    for (i = 0; i < KERNEL; i++) {
        rows[i].coefficient = maybe(2.0);
        rows[i].s_a = word() % 8 ? (double)(word() % 5) - 2.0 : maybe(0.5);
        rows[i].s_b = word() % 8 ? (double)(word() % 5) - 2.0 : maybe(8.0);
        rows[i].s_out = word() % 8 ? -(rows[i].s_a + rows[i].s_b) : number();
    }
}

static void some_species(fixpair_species *species, double (*columns)[ROWS]) {
    fixpair_species both[2];
    fill_columns(columns);
    make_species(both, columns);
    *species = both[word() % 2];
    if (word() % 2) {
        columns[word() % COLUMNS][word() % ROWS] = number();
    }
    if (word() % 8 == 0) {
        species->rows = (size_t)(word() % (ROWS + 1));
    }
    if (word() % 16 == 0) {
        species->struct_size = size();
    }
}

static void sources(double *data, double *scratch, const fixpair_fft_f64 *fft) {
    const size_t mesh = fft->length;
    fixpair_layout layout;
    size_t i;
    for (i = 0; i < mesh; i++) {
        data[6 * mesh + i] = word() % 1024 ? noise(i) : number();
    }
    sane(fixpair_third_order_sources_scratch_f64(&layout, fft));
    sane(fixpair_third_order_sources_f64(data, data + mesh, data + 2 * mesh, data + 3 * mesh, data + 4 * mesh, data + 5 * mesh,
                                         data + 6 * mesh, at_most(mesh), fft, scratch, at_most(BYTES), NULL));
    sane(fixpair_transverse_displacement_f64(data, at_most(mesh), data + 3 * mesh, data + 4 * mesh, data + 5 * mesh, at_most(mesh),
                                             few(4), maybe(30.0), fft, NULL));
}

static void beginnings(double *data, double *scratch, const fixpair_fft_f64 *fft) {
    fixpair_conditions conditions;
    fixpair_species species;
    fixpair_shape_row rows[KERNEL];
    fixpair_components_f64 position, velocity;
    fixpair_positions_f64 pre_initial;
    fixpair_layout layout;
    double columns[COLUMNS][ROWS], table[TABLE];
    fixpair_status_t status;
    int at = word() % 2, sound = 1;
    size_t i, particles = at ? (size_t)CLOUD : (size_t)512;
    MUST(fixpair_conditions_init(&conditions, word()));
    some_rows(rows);
    some_species(&species, columns);
    conditions.redshift = maybe(32.0);
    conditions.box_size = maybe(100.0);
    conditions.f_nl = maybe(100.0);
    conditions.g_nl = maybe(0.0);
    conditions.order = word() % 4 ? 1 + (int32_t)(word() % 3) : choice();
    conditions.shape = word() % 4 ? (int32_t)(word() % 6) : choice();
    conditions.rows = rows;
    conditions.rows_len = word() % 8 ? (size_t)(word() % (KERNEL + 1)) : 0;
    conditions.species = word() % 2 ? &species : NULL;
    conditions.cosmology.n_s = maybe(1.0);
    sane(fixpair_species_table(table, at_most(TABLE), &species, choice(), word() % 8 ? 8 : size(), maybe(100.0), NULL));
    sane(fixpair_initial_conditions_scratch_f64(&layout, &conditions, fft, NULL));
    sane(fixpair_initial_conditions_at_scratch_f64(&layout, &conditions, size(), fft, NULL));
    scatter(data, 3 * CLOUD);
    pre_initial = seen(data, CLOUD);
    position = moved(data + LENGTH, particles);
    velocity = moved(data + LENGTH + 3 * particles, particles);
    if (at) {
        status = fixpair_initial_conditions_at_f64(&position, &velocity, &pre_initial, &conditions, fft, NULL, scratch,
                                                   at_most(BYTES), NULL);
    } else {
        status = fixpair_initial_conditions_f64(&position, &velocity, &conditions, fft, NULL, scratch,
                                                at_most(BYTES), NULL);
    }
    sane(status);
    if (status == FIXPAIR_OK) {
        for (i = 0; i < 3 * position.length; i++) {
            sound &= position.x[i] >= 0 && position.x[i] < conditions.box_size && isfinite(velocity.x[i]);
        }
        CHECK(sound);
    }
    sources(data, scratch, fft);
}
