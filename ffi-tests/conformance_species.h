/*
 * The part of conformance.c about species, and what the cases of ffi-tests/vectors_initial.rs are made of.
 */

/* A caller's own kernel. */
static const fixpair_shape_row kernel[] = {{2.0, 0.0, 0.0, 0.0}, {-1.5, -1.0, 0.0, 1.0}, {0.5, 1.0, -0.5, -0.5}};

/* What differs from fixpair_conditions_init; species: -1 none, 0 without reference, 1 with one; at: from positions of its own too. */
typedef struct {
    const char *name;
    int32_t order, shape;
    size_t fine;
    double g_nl;
    int species, at;
} kind_of_universe;

static const kind_of_universe kinds_of_universes[] = {
    {"third", FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_LOCAL, 0, 0.0, -1, 1},
    {"third_exact", FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_LOCAL, FINE, 0.0, -1, 0},
    {"equilateral", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_EQUILATERAL, 0, 0.0, -1, 0},
    {"equilateral_exact", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_EQUILATERAL, FINE, 0.0, -1, 1},
    {"rows", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_ROWS, 0, 0.0, -1, 0},
    {"rows_cubic", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_ROWS, FINER, 1e5, -1, 0},
    {"species", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_LOCAL, 0, 0.0, 0, 0},
    {"species_reference", FIXPAIR_ORDER_SECOND, FIXPAIR_SHAPE_LOCAL, FINE, 0.0, 1, 0},
    {"species_first", FIXPAIR_ORDER_FIRST, FIXPAIR_SHAPE_LOCAL, 0, 0.0, 0, 1},
    {"species_third", FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_LOCAL, 0, 0.0, 1, 0},
    {"everything", FIXPAIR_ORDER_THIRD, FIXPAIR_SHAPE_ROWS, FINER, 1e5, 1, 1},
};

enum { UNIVERSES = sizeof kinds_of_universes / sizeof *kinds_of_universes };

static void species_tables(const fixpair_exec *exec) {
    double columns[COLUMNS][ROWS], *table = (double *)take(table_length * sizeof *table);
    fixpair_species species[2];
    uint64_t hash = HASH_START;
    int reference;
    int32_t ratio;
    fill_columns(columns);
    MUST(fixpair_species_init(&species[0]));
    CHECK(species[0].struct_size == sizeof *species && species[0].rows == 0 && species[0].k == NULL);
    CHECK(species[0].matter == NULL && species[0].density == NULL && species[0].velocity == NULL);
    CHECK(species[0].reference == NULL);
    make_species(species, columns);
    for (reference = 0; reference < 2; reference++) {
        for (ratio = FIXPAIR_RATIO_MATTER; ratio <= FIXPAIR_RATIO_VELOCITY; ratio++) {
            MUST(fixpair_species_table(table, table_length, &species[reference], ratio, N, BOX, exec));
            hash = hash_bytes(hash, table, table_length * sizeof *table);
        }
    }
    check_case("species_table", hash);
    give_back(table);
}
