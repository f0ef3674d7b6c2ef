/*
 * The half of conformance.c about the stages of the third order that exists in both precisions.
 */

/* The modes of delta of a normal realisation at z = 32 on a mesh whose planes are padded, and the sources of second and third order. */
static void X(sources)(const fixpair_exec *exec) {
    fixpair_realisation normal;
    fixpair_layout layout;
    X(built_in) transform;
    const X(fixpair_fft) *fft = &transform.fft;
    REAL *density, *out[6], *psi;
    void *scratch;
    size_t length, i;
    uint64_t hash;
    X(open)(&transform, N, PADDING, exec);
    MUST(fixpair_realisation_init(&normal, SEED));
    /* As long as the modes need, which is less than the transform does. */
    density = X(array_of)(&fft->fourier, &length);
    MUST(X(fixpair_white_modes)(density, length, &fft->fourier, &normal, amplitude_table, table_length, exec));
    MUST(X(fixpair_scale_modes)(density, length, &fft->fourier, alpha_table, table_length, exec));
    for (i = 0; i < 6; i++) {
        out[i] = X(reals)(length);
    }
    MUST(X(fixpair_third_order_sources_scratch)(&layout, fft));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_third_order_sources)(out[0], out[1], out[2], out[3], out[4], out[5], density, length, fft, scratch,
                                        layout.size, exec));
    hash = hash_layout(HASH_START, layout);
    for (i = 0; i < 6; i++) {
        hash = hash_brick(hash, out[i], &fft->fourier, sizeof(REAL));
    }
    check_named("third_order_sources", "", SUFFIX, hash);
    psi = X(reals)(fft->length);
    hash = HASH_START;
    for (i = 0; i < 3; i++) {
        MUST(X(fixpair_transverse_displacement)(psi, fft->length, out[3], out[4], out[5], length, i, 32.0, fft, exec));
        hash = hash_brick(hash, psi, &fft->configuration, sizeof(REAL));
    }
    check_named("transverse_displacement", "", SUFFIX, hash);
    give_back(density);
    give_back(psi);
    give_back(scratch);
    for (i = 0; i < 6; i++) {
        give_back(out[i]);
    }
    X(close)(&transform);
}

/* Particles put together from all five displacements, at z = 0, where the third order is large. */
static void X(third_order_by_stages)(const fixpair_exec *exec) {
    enum { PARTICLES = N * N * N };
    /* Positions up to 200, rounded a few times on the way; velocities are about 100 times displacements. */
    const double tolerance = sizeof(REAL) == 4 ? 1e-4 : 1e-11;
    fixpair_conditions conditions;
    fixpair_growth g;
    fixpair_layout layout, sources;
    X(fixpair_components) particles[2];
    X(built_in) transform;
    const X(fixpair_fft) *fft = &transform.fft;
    double *table = (double *)take(table_length * sizeof *table), e, now = 1.0, unit, largest = 0;
    double scale[5], rate[5];
    REAL *density, *out[6], *psi[5], *moved = X(reals)(6 * PARTICLES);
    void *scratch;
    size_t length, axis, i, order;
    int near = 1;
    MUST(fixpair_conditions_init(&conditions, SEED));
    conditions.box_size = BOX;
    conditions.redshift = 0.0;
    conditions.order = FIXPAIR_ORDER_THIRD;
    for (i = 0; i < 2; i++) {
        particles[i].x = moved + 3 * i * PARTICLES;
        particles[i].y = particles[i].x + 1;
        particles[i].z = particles[i].x + 2;
        particles[i].stride = 3;
        particles[i].length = PARTICLES;
    }
    X(open)(&transform, N, 0, exec);
    MUST(X(fixpair_initial_conditions_scratch)(&layout, &conditions, fft, NULL));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_initial_conditions)(&particles[0], &particles[1], &conditions, fft, NULL, scratch, layout.size, exec));
    MUST(fixpair_alpha_table(table, table_length, N, BOX, &conditions.cosmology, &conditions.linear, conditions.redshift,
                             conditions.convention, exec));
    MUST(fixpair_growth_factors(&g, &now, 1, &conditions.cosmology));
    MUST(fixpair_expansion(&e, &now, 1, &conditions.cosmology));
    density = X(array_of)(&fft->fourier, &length);
    MUST(X(fixpair_white_modes)(density, length, &fft->fourier, &conditions.realisation, amplitude_table, table_length, exec));
    MUST(X(fixpair_scale_modes)(density, length, &fft->fourier, table, table_length, exec));
    for (i = 0; i < 6; i++) {
        out[i] = X(reals)(length);
    }
    MUST(X(fixpair_third_order_sources_scratch)(&sources, fft));
    CHECK(sources.size <= layout.size);
    MUST(X(fixpair_third_order_sources)(out[0], out[1], out[2], out[3], out[4], out[5], density, length, fft, scratch,
                                        sources.size, exec));
    unit = BOX / (2.0 * 3.14159265358979323846);
    scale[0] = unit;
    scale[1] = -g.d2 / (g.d * g.d) * unit;
    scale[2] = g.d3a / (g.d * g.d * g.d) * unit;
    scale[3] = g.d3b / (g.d * g.d * g.d) * unit;
    scale[4] = g.d3c / (g.d * g.d * g.d) * unit;
    rate[0] = g.f;
    rate[1] = g.f2;
    rate[2] = g.f3a;
    rate[3] = g.f3b;
    rate[4] = g.f3c;
    for (order = 0; order < 5; order++) {
        psi[order] = X(reals)(fft->length);
    }
    for (axis = 0; axis < 3; axis++) {
        for (order = 0; order < 4; order++) {
            MUST(X(fixpair_displacement)(psi[order], fft->length, order == 0 ? density : out[order - 1], length, &fft->fourier,
                                         axis, scale[order], fft, exec));
        }
        MUST(X(fixpair_transverse_displacement)(psi[4], fft->length, out[3], out[4], out[5], length, axis, scale[4], fft, exec));
        for (i = 0; i < PARTICLES; i++) {
            size_t cell[3], at;
            double moved_by = 0, velocity = 0, apart;
            cell[0] = i / N / N;
            cell[1] = i / N % N;
            cell[2] = i % N;
            at = (cell[0] * N + cell[1]) * (N + 2) + cell[2];
            for (order = 0; order < 5; order++) {
                moved_by += psi[order][at];
                velocity += 100.0 * e * rate[order] * psi[order][at];
            }
            apart = fabs((double)cell[axis] * BOX / N + moved_by - particles[0].x[3 * i + axis]);
            apart = fmin(apart, fabs(apart - BOX));
            near &= apart <= tolerance && fabs(velocity - particles[1].x[3 * i + axis]) <= 100.0 * tolerance;
            largest = fmax(largest, fmin(fabs((double)psi[2][at]), fabs((double)psi[4][at])));
        }
    }
    CHECK(near);
    /* Were one of them missing, it would show. */
    CHECK(largest > 10 * tolerance);
    give_back(table);
    give_back(density);
    give_back(scratch);
    give_back(moved);
    for (i = 0; i < 6; i++) {
        give_back(out[i]);
    }
    for (i = 0; i < 5; i++) {
        give_back(psi[i]);
    }
    X(close)(&transform);
}

static void X(third_order)(const fixpair_exec *exec) {
    X(sources)(exec);
    if (exec == NULL) {
        X(third_order_by_stages)(exec);
    }
}
