/*
 * The part of bits.c that has no precision: tables of the cosmology, seeds of columns.
 */

static double *amplitudes, *alphas;
static size_t table_len;

static void make_tables(void) {
    fixpair_conditions conditions;
    fixpair_growth growth[40];
    double a[40], e[40];
    int i;
    MUST(fixpair_conditions_init(&conditions, SEED));
    MUST(fixpair_mode_table_length(&table_len, MESH));
    amplitudes = (double *)take(table_len * sizeof *amplitudes);
    alphas = (double *)take(table_len * sizeof *alphas);
    MUST(fixpair_potential_amplitude_table(amplitudes, table_len, MESH, BOX, &conditions.cosmology, &conditions.linear,
                                           FIXPAIR_CONVENTION_CMB, exec));
    MUST(fixpair_alpha_table(alphas, table_len, MESH, BOX, &conditions.cosmology, &conditions.linear, 32.0, FIXPAIR_CONVENTION_CMB, exec));
    for (i = 0; i < 40; i++) {
        a[i] = (double)(i + 1) / 32.0;
    }
    MUST(fixpair_expansion(e, a, 40, &conditions.cosmology));
    MUST(fixpair_growth_factors(growth, a, 40, &conditions.cosmology));
    line_of_bytes(EXACT, "potential_amplitude_table", "", amplitudes, table_len * sizeof *amplitudes);
    line_of_bytes(EXACT, "alpha_table", "", alphas, table_len * sizeof *alphas);
    line_of_bytes(EXACT, "expansion", "", e, sizeof e);
    line_of_bytes(EXACT, "growth_factors", "", growth, sizeof growth);
}

static void seeds(void) {
    fixpair_brick bricks[MOST_PIECES];
    uint32_t *all = (uint32_t *)take(MESH * MESH * sizeof *all), *own = (uint32_t *)take(MESH * MESH * sizeof *own);
    size_t pieces = pieces_of(bricks, MESH, FIXPAIR_SPACE_FOURIER, 0), i, a, b;
    double uniforms[1000];
    for (i = 0; i < pieces; i++) {
        const fixpair_brick *brick = &bricks[i];
        MUST(fixpair_ngenic_seeds(own, brick->count[0] * brick->count[1], brick, SEED));
        for (a = 0; a < brick->count[0]; a++) {
            for (b = 0; b < brick->count[1]; b++) {
                all[(brick->start[0] + a) * MESH + brick->start[1] + b] = own[a * brick->count[1] + b];
            }
        }
    }
    line_of_bytes(EXACT, "ngenic_seeds", "", all, MESH * MESH * sizeof *all);
    MUST(fixpair_ranlxd1(uniforms, 1000, SEED));
    line_of_bytes(EXACT, "ranlxd1", "", uniforms, sizeof uniforms);
    give_back(all);
    give_back(own);
}
