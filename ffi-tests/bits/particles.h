/*
 * The part of bits.c about particles and meshes, in one precision. No transform is on the way.
 */

/* Triples, to be read and to be written. */
static X(fixpair_positions) X(view)(const REAL *triples, size_t length) {
    X(fixpair_positions) view;
    view.x = triples;
    view.y = triples + 1;
    view.z = triples + 2;
    view.stride = 3;
    view.length = length;
    return view;
}

static X(fixpair_components) X(triples)(REAL *triples, size_t length) {
    X(fixpair_components) components;
    components.x = triples;
    components.y = triples + 1;
    components.z = triples + 2;
    components.stride = 3;
    components.length = length;
    return components;
}

/* Places all over the box and beyond it, in no order; or, `ordered`, near a lattice and in its order, so that runs of neighbours are sorted. */
static REAL *X(places)(int ordered) {
    REAL *places = X(reals)(3 * PARTICLES);
    size_t i;
    for (i = 0; i < 3 * PARTICLES; i++) {
        size_t particle = i / 3, side = MESH;
        size_t cell = i % 3 == 0 ? particle / (side * side) : i % 3 == 1 ? particle / side % side : particle % side;
        places[i] = (REAL)(ordered ? BOX * ((double)cell + 0.25 * random_number(i)) / MESH : 1.5 * BOX * random_number(i));
    }
    return places;
}

static void X(displaced)(void) {
    fixpair_brick bricks[MOST_PIECES];
    const size_t cells = MESH * MESH * MESH;
    REAL *psi[2], *moved[2], *position = X(reals)(3 * cells), *velocity = X(reals)(3 * cells);
    uint64_t *all = (uint64_t *)take(cells * sizeof *all);
    size_t pieces = pieces_of(bricks, MESH, FIXPAIR_SPACE_CONFIGURATION, 0), i, side, axis, a, b, c;
    for (side = 0; side < 2; side++) {
        psi[side] = X(numbers)(cells, 8 + side, side == 0 ? 3.0 : 0.5);
    }
    for (i = 0; i < pieces; i++) {
        const fixpair_brick *brick = &bricks[i];
        const size_t count = brick->count[0] * brick->count[1] * brick->count[2];
        X(fixpair_components) both[2];
        uint64_t *ids = (uint64_t *)take(count * sizeof *ids);
        REAL *one[2];
        size_t length = 0, at = 0;
        for (side = 0; side < 2; side++) {
            moved[side] = X(reals)(3 * count);
            both[side] = X(triples)(moved[side], count);
            one[side] = X(part)(psi[side], brick, &length);
        }
        MUST(fixpair_particle_ids(ids, count, brick, 1, exec));
        for (axis = 0; axis < 3; axis++) {
            MUST(X(fixpair_displace)(&both[0], &both[1], one[0], one[1], length, brick, axis, BOX, 55.5, 111.25, exec));
        }
        for (a = 0; a < brick->count[0]; a++) {
            for (b = 0; b < brick->count[1]; b++) {
                for (c = 0; c < brick->count[2]; c++, at++) {
                    size_t x = brick->start[0] + a, y = brick->start[1] + b, z = brick->start[2] + c;
                    size_t particle = (x * MESH + y) * MESH + z;
                    all[particle] = ids[at];
                    memcpy(position + 3 * particle, moved[0] + 3 * at, 3 * sizeof(REAL));
                    memcpy(velocity + 3 * particle, moved[1] + 3 * at, 3 * sizeof(REAL));
                }
            }
        }
        for (side = 0; side < 2; side++) {
            give_back(moved[side]);
            give_back(one[side]);
        }
        give_back(ids);
    }
    X(line_of_reals)(EXACT, "displace.position", 0, position, 3 * cells);
    X(line_of_reals)(EXACT, "displace.velocity", 0, velocity, 3 * cells);
    line_of_bytes(EXACT, "particle_ids", SUFFIX, all, cells * sizeof *all);
    for (side = 0; side < 2; side++) {
        give_back(psi[side]);
    }
    give_back(position);
    give_back(velocity);
    give_back(all);
}

/* Sums of masses round in the order of the region's particles: promised for the whole mesh alone. */
static void X(deposits)(void) {
    static const char *const windows[] = {"ngp", "cic", "tsc", "pcs"};
    REAL *weights = X(numbers)(PARTICLES, 10, 1.0);
    int ordered;
    int32_t window;
    if (cut != WHOLE) {
        give_back(weights);
        return;
    }
    for (ordered = 0; ordered < 2; ordered++) {
        REAL *places = X(places)(ordered), *mesh;
        X(fixpair_positions) position = X(view)(places, PARTICLES);
        for (window = FIXPAIR_WINDOW_NGP; window <= FIXPAIR_WINDOW_PCS; window++) {
            fixpair_brick cells;
            fixpair_layout layout;
            size_t length;
            void *scratch;
            char name[40];
            MUST(fixpair_brick_whole(&cells, MESH, FIXPAIR_SPACE_CONFIGURATION, 0));
            MUST(fixpair_brick_reals(&length, &cells));
            mesh = X(reals)(length);
            MUST(X(fixpair_deposit_scratch)(&layout, &cells, PARTICLES, window));
            scratch = take(layout.size);
            MUST(X(fixpair_deposit)(mesh, length, &cells, &position, window > 2 ? weights : NULL, window > 2 ? 1 : 0, BOX, window,
                                    0.25 * (window - 1), scratch, layout.size, exec));
            give_back(scratch);
            snprintf(name, sizeof name, "deposit.%s.%s", windows[window - 1], ordered ? "ordered" : "random");
            X(line_of_reals)(EXACT, name, 0, mesh, length);
            give_back(mesh);
        }
        give_back(places);
    }
    give_back(weights);
}

/* A brick with its ghosts, filled from a mesh. */
static REAL *X(with_ghosts)(const REAL *mesh, const fixpair_brick *wide, size_t *length) {
    REAL *data;
    size_t a, b, c;
    MUST(fixpair_brick_reals(length, wide));
    data = X(reals)(*length);
    for (a = 0; a < wide->count[0]; a++) {
        for (b = 0; b < wide->count[1]; b++) {
            for (c = 0; c < wide->count[2]; c++) {
                size_t x = (wide->start[0] + a) % MESH, y = (wide->start[1] + b) % MESH, z = (wide->start[2] + c) % MESH;
                data[a * wide->stride[0] + b * wide->stride[1] + c * wide->stride[2]] = mesh[(x * MESH + y) * MESH + z];
            }
        }
    }
    return data;
}

/* Is the place in the brick's part of the box? */
static int X(inside)(const REAL *place, const fixpair_brick *brick) {
    int axis, in = 1;
    for (axis = 0; axis < 3; axis++) {
        double cell = ((double)place[axis] - BOX * floor((double)place[axis] / BOX)) * MESH / BOX;
        in &= cell >= (double)brick->start[axis] && cell < (double)(brick->start[axis] + brick->count[axis]);
    }
    return in;
}

/* Each piece reads out and kicks the particles that are its own. What a particle gets depends on it and its cells alone. */
static void X(from_meshes)(void) {
    fixpair_brick bricks[MOST_PIECES], wide;
    size_t pieces = pieces_of(bricks, MESH, FIXPAIR_SPACE_CONFIGURATION, 0), i, j, axis, met = 0;
    const int32_t windows[2] = {FIXPAIR_WINDOW_CIC, FIXPAIR_WINDOW_PCS};
    REAL *mesh[3], *places = X(places)(0);
    int w;
    for (axis = 0; axis < 3; axis++) {
        mesh[axis] = X(numbers)(MESH * MESH * MESH, 11 + axis, 1.0);
    }
    for (w = 0; w < 2; w++) {
        REAL *values = X(reals)(PARTICLES), *speeds = X(numbers)(3 * PARTICLES, 14, 300.0);
        size_t *own = (size_t *)take(PARTICLES * sizeof *own);
        for (i = 0; i < pieces; i++) {
            REAL *ghosts[3], *here = X(reals)(3 * PARTICLES), *fast = X(reals)(3 * PARTICLES), *read = X(reals)(PARTICLES);
            X(fixpair_positions) position, order;
            X(fixpair_components) velocity;
            fixpair_layout layout;
            size_t count = 0, length = 0;
            void *scratch;
            for (j = 0; j < PARTICLES; j++) {
                if (X(inside)(places + 3 * j, &bricks[i])) {
                    memcpy(here + 3 * count, places + 3 * j, 3 * sizeof(REAL));
                    memcpy(fast + 3 * count, speeds + 3 * j, 3 * sizeof(REAL));
                    own[count++] = j;
                }
            }
            met += count;
            MUST(fixpair_brick_with_ghosts(&wide, &bricks[i], windows[w], 0.5));
            for (axis = 0; axis < 3; axis++) {
                ghosts[axis] = X(with_ghosts)(mesh[axis], &wide, &length);
            }
            position = order = X(view)(here, count);
            velocity = X(triples)(fast, count);
            MUST(X(fixpair_read_out_scratch)(&layout, &wide, count, windows[w]));
            scratch = take(layout.size);
            MUST(X(fixpair_read_out)(read, 1, ghosts[0], length, &wide, &position, BOX, windows[w], 0.5, scratch, layout.size, exec));
            give_back(scratch);
            MUST(X(fixpair_kick_scratch)(&layout, &wide, count, windows[w]));
            scratch = take(layout.size);
            MUST(X(fixpair_kick)(&velocity, &position, ghosts[0], ghosts[1], ghosts[2], length, &wide, BOX, windows[w], 0.5, 0.875, 2.5,
                                 0.25, -0.125, &order, &order, scratch, layout.size, exec));
            give_back(scratch);
            for (j = 0; j < count; j++) {
                values[own[j]] = read[j];
                memcpy(speeds + 3 * own[j], fast + 3 * j, 3 * sizeof(REAL));
            }
            for (axis = 0; axis < 3; axis++) {
                give_back(ghosts[axis]);
            }
            give_back(here);
            give_back(fast);
            give_back(read);
        }
        X(line_of_reals)(EXACT, w == 0 ? "read_out.cic" : "read_out.pcs", 0, values, PARTICLES);
        X(line_of_reals)(EXACT, w == 0 ? "kick.cic" : "kick.pcs", 0, speeds, 3 * PARTICLES);
        give_back(values);
        give_back(speeds);
        give_back(own);
    }
    CHECK(met == 2 * PARTICLES);
    for (axis = 0; axis < 3; axis++) {
        give_back(mesh[axis]);
    }
    give_back(places);
}

static void X(drifts)(void) {
    REAL *places = X(places)(0), *speeds = X(numbers)(3 * PARTICLES, 15, 300.0);
    X(fixpair_components) position = X(triples)(places, PARTICLES);
    X(fixpair_positions) velocity = X(view)(speeds, PARTICLES);
    MUST(X(fixpair_drift)(&position, &velocity, BOX, 0.125, 0.5, 0.25, &velocity, &velocity, exec));
    X(line_of_reals)(EXACT, "drift", 0, places, 3 * PARTICLES);
    give_back(places);
    give_back(speeds);
}
