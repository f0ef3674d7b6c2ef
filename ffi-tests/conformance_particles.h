/*
 * The part of conformance.c about particles and meshes, in one precision: deposit, read-out, ghosts, interlacing.
 */

enum { X(MANY) = 500 };

/* Deposits at the places; goes on with the hash of the scratch's layout. */
static uint64_t X(put)(uint64_t hash, REAL *mesh, size_t length, const fixpair_brick *region,
                       const X(fixpair_positions) *position, const REAL *weights, size_t weights_stride,
                       int32_t window, double shift, const fixpair_exec *exec) {
    fixpair_layout layout;
    void *scratch;
    MUST(X(fixpair_deposit_scratch)(&layout, region, position->length, window));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_deposit)(mesh, length, region, position, weights, weights_stride, BOX, window, shift, scratch,
                            layout.size, exec));
    give_back(scratch);
    return hash_layout(hash, layout);
}

/* Reads out at the places, every other value; hashes the values. */
static uint64_t X(get)(uint64_t hash, const REAL *mesh, size_t length, const fixpair_brick *region,
                       const X(fixpair_positions) *position, int32_t window, double shift, const fixpair_exec *exec) {
    fixpair_layout layout;
    REAL *values = X(reals)(2 * position->length);
    void *scratch;
    size_t i;
    int untouched = 1;
    MUST(X(fixpair_read_out_scratch)(&layout, region, position->length, window));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_read_out)(values, 2, mesh, length, region, position, BOX, window, shift, scratch, layout.size,
                             exec));
    for (i = 0; i < position->length; i++) {
        hash = hash_bytes(hash, values + 2 * i, sizeof(REAL));
        untouched &= values[2 * i + 1] == 0;
    }
    CHECK(untouched);
    give_back(scratch);
    give_back(values);
    return hash;
}

/* Two ranks of a host that are one process: ghosts go from one to the other as they would between machines. */
static void X(two_slabs)(const fixpair_exec *exec) {
    static const size_t first[2] = {0, 5}, planes[2] = {5, 7};
    fixpair_brick own[2], wide[2];
    X(fixpair_positions) position[2];
    REAL *places[2], *mesh[2], *ghost[2];
    size_t length[2], wide_length[2], i;
    uint64_t hash = HASH_START;
    int rank, other, axis;
    for (rank = 0; rank < 2; rank++) {
        MUST(fixpair_brick_slab(&own[rank], N, FIXPAIR_SPACE_CONFIGURATION, first[rank], planes[rank]));
        MUST(fixpair_brick_with_ghosts(&wide[rank], &own[rank], FIXPAIR_WINDOW_PCS, 0.5));
        mesh[rank] = X(array_of)(&own[rank], &length[rank]);
        /* A brick with ghosts may run over the edge: its length is the product. */
        wide_length[rank] = wide[rank].count[0] * wide[rank].count[1] * wide[rank].count[2];
        ghost[rank] = X(reals)(wide_length[rank]);
        places[rank] = X(reals)(3 * X(MANY));
        position[rank].x = places[rank];
        position[rank].y = places[rank] + 1;
        position[rank].z = places[rank] + 2;
        position[rank].stride = 3;
        position[rank].length = 0;
    }
    for (i = 0; i < X(MANY); i++) {
        REAL x = (REAL)(BOX * (noise(3 * i) + 1.0) / 2.0);
        rank = (double)x * N < 5.0 * BOX ? 0 : 1;
        for (axis = 0; axis < 3; axis++) {
            places[rank][3 * position[rank].length + (size_t)axis] =
                (REAL)(BOX * (noise(3 * i + (size_t)axis) + 1.0) / 2.0);
        }
        position[rank].length++;
    }
    for (rank = 0; rank < 2; rank++) {
        X(put)(0, ghost[rank], wide_length[rank], &wide[rank], &position[rank], NULL, 0, FIXPAIR_WINDOW_PCS, 0.5, exec);
    }
    for (rank = 0; rank < 2; rank++) {
        for (other = 0; other < 2; other++) {
            MUST(X(fixpair_add_cells)(mesh[rank], length[rank], &own[rank], ghost[other], wide_length[other],
                                      &wide[other], exec));
        }
        hash = hash_brick(hash, mesh[rank], &own[rank], sizeof(REAL));
    }
    check_named("deposit.slabs", "", SUFFIX, hash);
    hash = HASH_START;
    for (rank = 0; rank < 2; rank++) {
        memset(ghost[rank], 0, wide_length[rank] * sizeof(REAL));
        for (other = 0; other < 2; other++) {
            MUST(X(fixpair_copy_cells)(ghost[rank], wide_length[rank], &wide[rank], mesh[other], length[other],
                                       &own[other], exec));
        }
        hash = X(get)(hash, ghost[rank], wide_length[rank], &wide[rank], &position[rank], FIXPAIR_WINDOW_PCS, 0.5, exec);
    }
    check_named("read_out.slabs", "", SUFFIX, hash);
    for (rank = 0; rank < 2; rank++) {
        give_back(mesh[rank]);
        give_back(ghost[rank]);
        give_back(places[rank]);
    }
}

static void X(particles_and_meshes)(const fixpair_exec *exec) {
    fixpair_brick cells;
    X(built_in) transform;
    X(fixpair_positions) position;
    REAL *memory = X(reals)(8 * X(MANY)), *weights = X(reals)(8 * X(MANY)), *mesh, *both[2];
    size_t length, i;
    uint64_t hash;
    int32_t window;
    int kind, half, axis;
    MUST(fixpair_brick_whole(&cells, N, FIXPAIR_SPACE_CONFIGURATION, PADDING));
    mesh = X(array_of)(&cells, &length);
    for (kind = 0; kind < X(LAYOUTS); kind++) {
        /* From a component to the next, and from a particle to the next. */
        size_t step = kind == X(ARRAYS) ? X(MANY) : 1;
        size_t stride = kind == X(ARRAYS) ? 1 : kind == X(TRIPLES) ? 3 : 8;
        size_t weights_stride = kind == X(MEMBERS) ? 8 : 1;
        for (i = 0; i < X(MANY); i++) {
            for (axis = 0; axis < 3; axis++) {
                memory[i * stride + (size_t)axis * step] = (REAL)(BOX * noise(3 * i + (size_t)axis));
            }
            weights[i * weights_stride] = (REAL)(1.25 + noise(5 * i));
        }
        position.x = memory;
        position.y = memory + step;
        position.z = memory + 2 * step;
        position.stride = stride;
        position.length = X(MANY);
        hash = HASH_START;
        for (window = FIXPAIR_WINDOW_NGP; window <= FIXPAIR_WINDOW_PCS; window++) {
            for (half = 0; half < 2; half++) {
                memset(mesh, 0, length * sizeof(REAL));
                hash = X(put)(hash, mesh, length, &cells, &position, window > 2 ? weights : NULL,
                              window > 2 ? weights_stride : 0, window, half ? 0.5 : 0.0, exec);
                hash = hash_brick(hash, mesh, &cells, sizeof(REAL));
            }
        }
        check_named("deposit", "", SUFFIX, hash);
        for (i = 0; i < length; i++) {
            mesh[i] = (REAL)noise(i);
        }
        hash = HASH_START;
        for (window = FIXPAIR_WINDOW_NGP; window <= FIXPAIR_WINDOW_PCS; window++) {
            hash = X(get)(hash, mesh, length, &cells, &position, window, 0.25 * (window - 1), exec);
        }
        check_named("read_out", "", SUFFIX, hash);
    }
    give_back(mesh);
    X(open)(&transform, N, 0, exec);
    for (half = 0; half < 2; half++) {
        both[half] = X(reals)(transform.fft.length);
        X(put)(0, both[half], transform.fft.length, &transform.fft.configuration, &position, NULL, 0,
               FIXPAIR_WINDOW_TSC, half ? 0.5 : 0.0, exec);
        CHECK(transform.fft.forward(transform.fft.context, both[half]) == 0);
    }
    MUST(X(fixpair_interlace)(both[0], both[1], transform.fft.length, &transform.fft.fourier, exec));
    check_named("interlace", "", SUFFIX, hash_brick(HASH_START, both[0], &transform.fft.fourier, sizeof(REAL)));
    for (half = 0; half < 2; half++) {
        give_back(both[half]);
    }
    X(close)(&transform);
    give_back(memory);
    give_back(weights);
    X(two_slabs)(exec);
}
