/*
 * The part of refusals.c about species and kernels of the caller's own.
 */

CALL(species_init, (P(0)))
CALL(species_table, (P(0), L(0), P(1), a->i[0], L(1), a->d[0], P(2)))

/* Columns in the arena. */
static void lay_columns(fixpair_species *species) {
    double (*columns)[ROWS] = (double (*)[ROWS])lay(COLUMNS * sizeof *columns, IN);
    fixpair_species both[2];
    fill_columns(columns);
    make_species(both, columns);
    *species = both[1];
}

/* `box` is what the function takes as L, `out` is some output. */
static void refuse_species(fixpair_species *species, double *box, void *out) {
    const double **columns[COLUMNS];
    double *k = (double *)(uintptr_t)species->k, *last = (double *)(uintptr_t)species->reference + ROWS - 1;
    int i;
    columns[0] = &species->k;
    columns[1] = &species->matter;
    columns[2] = &species->density;
    columns[3] = &species->velocity;
    columns[4] = &species->reference;
    REFUSED(FIXPAIR_ERROR_VERSION, species->struct_size = 0);
    REFUSED(FIXPAIR_ERROR_VERSION, species->struct_size++);
    for (i = 0; i < COLUMNS; i++) {
        double *column = (double *)(uintptr_t)*columns[i];
        if (i < 4) {
            REFUSED(FIXPAIR_ERROR_NULL, *columns[i] = NULL);
        } else {
            ACCEPTED(*columns[i] = NULL);
        }
        REFUSED(FIXPAIR_ERROR_ALIGNMENT, *columns[i] = (double *)(void *)((char *)column + 4));
        REFUSED(FIXPAIR_ERROR_OVERLAP, *columns[i] = (double *)out);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, column[ROWS - 1] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, column[0] = (double)INFINITY);
        REFUSED(FIXPAIR_ERROR_TABLE, column[0] = 0.0);
        REFUSED(FIXPAIR_ERROR_TABLE, column[2] = -column[2]);
    }
    REFUSED(FIXPAIR_ERROR_TABLE, k[3] = k[2]);
    REFUSED(FIXPAIR_ERROR_TABLE, k[3] = k[1]);
    REFUSED(FIXPAIR_ERROR_TABLE, species->rows = 0);
    REFUSED(FIXPAIR_ERROR_TABLE, species->rows = 1);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, species->rows = SIZE_MAX);
    /* Beyond the last row a ratio goes on as a power law, and this one is steep. */
    REFUSED(FIXPAIR_ERROR_RANGE, (*last = 1e-300, *box = 1.0));
}

/* `conditions` has the kernel as its rows, in the arena; the power of |n| that a row asks for depends on n_s too. */
static void refuse_rows(fixpair_conditions *conditions) {
    double *numbers;
    int i;
    restore();
    numbers = (double *)(uintptr_t)&conditions->rows[1].coefficient;
    for (i = 0; i < 4; i++) {
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, numbers[i] = (double)NAN);
        REFUSED(FIXPAIR_ERROR_NOT_FINITE, numbers[i] = (double)INFINITY);
    }
    for (i = 1; i < 4; i++) {
        REFUSED(FIXPAIR_ERROR_RANGE, numbers[i] += 1e-9);
        REFUSED(FIXPAIR_ERROR_RANGE, numbers[i] = 1e300);
    }
    REFUSED(FIXPAIR_ERROR_RANGE, (numbers[1] = 0.0, numbers[2] = 8.5, numbers[3] = -8.5));
    REFUSED(FIXPAIR_ERROR_RANGE, (numbers[1] = 0.0, numbers[2] = 8.0, numbers[3] = -8.0, conditions->cosmology.n_s = -5.0));
    ACCEPTED((numbers[1] = 0.0, numbers[2] = 8.0, numbers[3] = -8.0));
    ACCEPTED(numbers[0] = 0.0);
    ACCEPTED(conditions->rows_len = 1);
}

/* What the scratch query reads of rows. */
static void refuse_lists_of_rows(fixpair_conditions *conditions, void *out) {
    const char *rows = (const char *)conditions->rows;
    REFUSED(FIXPAIR_ERROR_NULL, conditions->rows = NULL);
    REFUSED(FIXPAIR_ERROR_ALIGNMENT, conditions->rows = (const fixpair_shape_row *)(const void *)(rows + 4));
    REFUSED(FIXPAIR_ERROR_OVERLAP, conditions->rows = (const fixpair_shape_row *)out);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, conditions->rows_len = SIZE_MAX);
    ACCEPTED((conditions->rows_len = 0, conditions->rows = NULL));
    /* Nobody looks at the rows of a shape with a name. */
    ACCEPTED((conditions->shape = FIXPAIR_SHAPE_LOCAL, conditions->rows = NULL));
}

static void species(void) {
    fixpair_species *one;
    size_t entries;
    begin("species_init", call_species_init);
    STRUCT(0, OUT, fixpair_species);
    refuse_pointers_and_lengths();

    MUST(fixpair_mode_table_length(&entries, SIDE));
    begin("species_table", call_species_table);
    ARRAY(0, OUT, double, entries);
    one = STRUCT(1, IN, fixpair_species);
    lay_columns(one);
    exec_at(2);
    length(0, entries, EXACT);
    t.a.n[1] = SIDE;
    t.a.d[0] = BOX;
    refuse_pointers_and_lengths();
    refuse_species(one, &t.a.d[0], t.a.p[0]);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = 3);
    REFUSED(FIXPAIR_ERROR_CHOICE, t.a.i[0] = -1);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 0);
    REFUSED(FIXPAIR_ERROR_MESH_SIZE, t.a.n[1] = 7);
    REFUSED(FIXPAIR_ERROR_OVERFLOW, t.a.n[1] = SIZE_MAX - 1);
    REFUSED(FIXPAIR_ERROR_LENGTH, t.a.n[1] = SIDE + 2);
    REFUSED(FIXPAIR_ERROR_NOT_FINITE, t.a.d[0] = (double)NAN);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = 0.0);
    REFUSED(FIXPAIR_ERROR_RANGE, t.a.d[0] = -BOX);
}
