/*
 * The part of conformance.c about gravity, in one precision: forces, kicks and drifts, runs.
 */

/* Values from place `from` of the sequence, `scale` large. */
static REAL *X(numbers)(size_t count, size_t from, double scale) {
    REAL *values = X(reals)(count);
    size_t i;
    for (i = 0; i < count; i++) {
        values[i] = (REAL)(scale * noise(i + from));
    }
    return values;
}

static X(fixpair_positions) X(view)(const REAL *triples, size_t length) {
    X(fixpair_positions) view;
    view.x = triples;
    view.y = triples + 1;
    view.z = triples + 2;
    view.stride = 3;
    view.length = length;
    return view;
}

/* The same elements, to be read. */
static X(fixpair_positions) X(shown)(const X(fixpair_components) *of) {
    X(fixpair_positions) view;
    view.x = of->x;
    view.y = of->y;
    view.z = of->z;
    view.stride = of->stride;
    view.length = of->length;
    return view;
}

/* Positions and velocities in 8 reals a particle: as triples, as arrays, as members of one struct. */
static void X(lay_out)(X(fixpair_components) *both, REAL *memory, size_t count, int kind) {
    int side;
    for (side = 0; side < 2; side++) {
        X(particle) *particles = (X(particle) *)memory;
        size_t step = kind == X(ARRAYS) ? count : 1;
        REAL *first = kind == X(MEMBERS) ? side == 0 ? particles->position : particles->velocity
                                         : memory + (size_t)side * 3 * count;
        both[side].x = first;
        both[side].y = first + step;
        both[side].z = first + 2 * step;
        both[side].length = count;
        both[side].stride = kind == X(ARRAYS) ? 1 : kind == X(TRIPLES) ? 3 : sizeof(X(particle)) / sizeof(REAL);
    }
}

static REAL *X(component)(const X(fixpair_components) *of, size_t i) {
    REAL *first = i % 3 == 0 ? of->x : i % 3 == 1 ? of->y : of->z;
    return first + i / 3 * of->stride;
}

static uint64_t X(hash_particles)(uint64_t hash, const X(fixpair_components) *of) {
    size_t i;
    for (i = 0; i < 3 * of->length; i++) {
        hash = hash_bytes(hash, X(component)(of, i), sizeof(REAL));
    }
    return hash;
}

static void X(forces)(const fixpair_exec *exec) {
    fixpair_brick bricks[BRICKS];
    fixpair_force_law laws[LAWS];
    fixpair_layout layout;
    void *scratch;
    int b, i;
    make_bricks(bricks);
    make_laws(laws);
    MUST(fixpair_force_scratch(&layout, N));
    scratch = take_scratch(layout.size);
    for (b = 0; b < BRICKS; b++) {
        uint64_t hash = HASH_START, potentials = HASH_START;
        const fixpair_brick *brick = &bricks[b];
        size_t length, axis;
        MUST(fixpair_brick_reals(&length, brick));
        for (i = 0; i < LAWS; i++) {
            REAL *modes = X(numbers)(length, 0, 1.0), *one = X(reals)(length), *mesh[3];
            for (axis = 0; axis < 3; axis++) {
                mesh[axis] = X(numbers)(length, 0, 1.0);
            }
            MUST(X(fixpair_forces)(mesh[0], mesh[1], mesh[2], length, brick, &laws[i], BOX, 500.0, scratch, layout.size,
                                   exec));
            for (axis = 0; axis < 3; axis++) {
                hash = hash_brick(hash, mesh[axis], brick, sizeof(REAL));
                memset(one, CANARY_BYTE, length * sizeof(REAL));
                MUST(X(fixpair_force)(one, modes, length, brick, axis, &laws[i], BOX, 500.0, scratch, layout.size, exec));
                CHECK(hash_brick(0, one, brick, sizeof(REAL)) == hash_brick(0, mesh[axis], brick, sizeof(REAL)));
                CHECK(gaps_untouched(one, length * sizeof(REAL), brick, sizeof(REAL)));
            }
            MUST(X(fixpair_potential)(modes, length, brick, &laws[i], BOX, 500.0, scratch, layout.size, exec));
            potentials = hash_brick(potentials, modes, brick, sizeof(REAL));
            for (axis = 0; axis < 3; axis++) {
                give_back(mesh[axis]);
            }
            give_back(one);
            give_back(modes);
        }
        check_named("forces.", brick_names[b], SUFFIX, hash);
        check_named("potential.", brick_names[b], SUFFIX, potentials);
    }
    give_back(scratch);
}

static void X(kicks_and_drifts)(const fixpair_exec *exec) {
    fixpair_brick region;
    REAL *mesh[3], *psi[2];
    X(fixpair_positions) order[2];
    size_t length, i;
    int kind, axis;
    MUST(fixpair_brick_whole(&region, N, FIXPAIR_SPACE_CONFIGURATION, PADDING));
    MUST(fixpair_brick_reals(&length, &region));
    for (axis = 0; axis < 3; axis++) {
        mesh[axis] = X(numbers)(length, 10000 * (size_t)(axis + 1), 1.0);
    }
    for (i = 0; i < 2; i++) {
        psi[i] = X(numbers)(3 * X(MANY), 40000 + 10000 * i, 2.0);
        order[i] = X(view)(psi[i], X(MANY));
    }
    for (kind = 0; kind < X(LAYOUTS); kind++) {
        REAL *memory = X(reals)(8 * X(MANY));
        X(fixpair_components) both[2];
        X(fixpair_positions) seen[2];
        uint64_t hash = HASH_START;
        int32_t window;
        X(lay_out)(both, memory, X(MANY), kind);
        for (i = 0; i < 3 * X(MANY); i++) {
            *X(component)(&both[0], i) = (REAL)(BOX * noise(i));
            *X(component)(&both[1], i) = (REAL)(300.0 * noise(i + 5000));
        }
        seen[0] = X(shown)(&both[0]);
        seen[1] = X(shown)(&both[1]);
        for (window = FIXPAIR_WINDOW_NGP; window <= FIXPAIR_WINDOW_PCS; window++) {
            fixpair_layout layout;
            void *scratch;
            /* Without displacements, with those of one order, and of both. */
            int orders = window > 2 ? 2 : window - 1;
            MUST(X(fixpair_kick_scratch)(&layout, &region, X(MANY), window));
            scratch = take_scratch(layout.size);
            MUST(X(fixpair_kick)(&both[1], &seen[0], mesh[0], mesh[1], mesh[2], length, &region, BOX, window,
                                 0.25 * (window - 1), 0.875, 2.5, orders > 0 ? 0.25 : 0.0, orders > 1 ? -0.125 : 0.0,
                                 orders > 0 ? &order[0] : NULL, orders > 1 ? &order[1] : NULL, scratch, layout.size, exec));
            give_back(scratch);
            hash = X(hash_particles)(hash_layout(hash, layout), &both[1]);
        }
        check_named("kick", "", SUFFIX, hash);
        hash = HASH_START;
        for (i = 0; i < 3; i++) {
            MUST(X(fixpair_drift)(&both[0], &seen[1], BOX, 0.125, i > 0 ? 0.5 : 0.0, i > 1 ? 0.25 : 0.0,
                                  i > 0 ? &order[0] : NULL, i > 1 ? &order[1] : NULL, exec));
            hash = X(hash_particles)(hash, &both[0]);
        }
        check_named("drift", "", SUFFIX, hash);
        give_back(memory);
    }
    for (axis = 0; axis < 3; axis++) {
        give_back(mesh[axis]);
    }
    give_back(psi[0]);
    give_back(psi[1]);
}

/* Two ranks with forces on slabs: ghosts are filled, each kicks its own particles. */
static void X(kicks_on_slabs)(const fixpair_exec *exec) {
    static const size_t first[2] = {0, 5}, planes[2] = {5, 7};
    fixpair_brick own[2], wide[2];
    REAL *places[2];
    size_t count[2] = {0, 0}, length, i;
    uint64_t hash = HASH_START;
    int rank, other, axis;
    for (rank = 0; rank < 2; rank++) {
        MUST(fixpair_brick_slab(&own[rank], N, FIXPAIR_SPACE_CONFIGURATION, first[rank], planes[rank]));
        MUST(fixpair_brick_with_ghosts(&wide[rank], &own[rank], FIXPAIR_WINDOW_PCS, 0.5));
        places[rank] = X(reals)(3 * X(MANY));
    }
    for (i = 0; i < X(MANY); i++) {
        REAL x = (REAL)(BOX * (noise(3 * i) + 1.0) / 2.0);
        rank = (double)x * N < 5.0 * BOX ? 0 : 1;
        for (axis = 0; axis < 3; axis++) {
            places[rank][3 * count[rank] + (size_t)axis] = (REAL)(BOX * (noise(3 * i + (size_t)axis) + 1.0) / 2.0);
        }
        count[rank]++;
    }
    for (rank = 0; rank < 2; rank++) {
        size_t wide_length = wide[rank].count[0] * wide[rank].count[1] * wide[rank].count[2];
        X(fixpair_positions) position = X(view)(places[rank], count[rank]);
        REAL *ghost[3], *speeds = X(numbers)(3 * count[rank], 70000 * (size_t)rank, 300.0);
        X(fixpair_components) velocity;
        fixpair_layout layout;
        void *scratch;
        for (axis = 0; axis < 3; axis++) {
            ghost[axis] = X(reals)(wide_length);
            for (other = 0; other < 2; other++) {
                REAL *mesh;
                MUST(fixpair_brick_reals(&length, &own[other]));
                mesh = X(numbers)(length, 10000 * (size_t)(3 * other + axis), 1.0);
                MUST(X(fixpair_copy_cells)(ghost[axis], wide_length, &wide[rank], mesh, length, &own[other], exec));
                give_back(mesh);
            }
        }
        velocity.x = speeds;
        velocity.y = speeds + 1;
        velocity.z = speeds + 2;
        velocity.stride = 3;
        velocity.length = count[rank];
        MUST(X(fixpair_kick_scratch)(&layout, &wide[rank], count[rank], FIXPAIR_WINDOW_PCS));
        scratch = take_scratch(layout.size);
        MUST(X(fixpair_kick)(&velocity, &position, ghost[0], ghost[1], ghost[2], wide_length, &wide[rank], BOX,
                             FIXPAIR_WINDOW_PCS, 0.5, 0.5, 1.5, 0.0, 0.0, NULL, NULL, scratch, layout.size, exec));
        hash = hash_bytes(hash, speeds, 3 * count[rank] * sizeof(REAL));
        give_back(scratch);
        give_back(speeds);
        for (axis = 0; axis < 3; axis++) {
            give_back(ghost[axis]);
        }
    }
    check_named("kick.slabs", "", SUFFIX, hash);
    give_back(places[0]);
    give_back(places[1]);
}
