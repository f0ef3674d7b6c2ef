/*
 * The part of conformance.c about bins and triangles: what has no precision.
 */

enum { EDGES = 7, SHELLS = 5, TRIANGLES = 100 };
static const uint64_t edges[EDGES] = {1, 4, 9, 16, 25, 36, 49};
static const double wedges[5] = {0.0, 0.25, 0.5, 0.75, 1.0};
static const double parallel[4] = {0.0, 1.0, 3.0, 7.0};

/* The triangles that close without centres, and how many triples close them. */
static uint32_t triangles[3 * TRIANGLES];
static uint64_t triangle_counts[TRIANGLES];
static size_t triangles_len;

static fixpair_binning wedge_binning(void) {
    fixpair_binning binning;
    MUST(fixpair_binning_init(&binning, edges, EDGES));
    CHECK(binning.struct_size == sizeof binning && binning.edges == edges && binning.edges_len == EDGES);
    CHECK(binning.second == FIXPAIR_SECOND_NONE && binning.orders == 1);
    CHECK(binning.second_edges == NULL && binning.second_edges_len == 0);
    CHECK(binning.axis[0] == 0 && binning.axis[1] == 0 && binning.axis[2] == 1);
    binning.second = FIXPAIR_SECOND_COSINE;
    binning.second_edges = wedges;
    binning.second_edges_len = 5;
    binning.orders = FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_1;
    return binning;
}

static uint64_t hash_sizes(uint64_t hash, size_t number) {
    uint64_t value = number;
    return hash_bytes(hash, &value, sizeof value);
}

static void ghosts(void) {
    fixpair_brick slab, ghosted;
    uint64_t hash = HASH_START;
    size_t reals;
    int32_t window;
    int half, axis;
    MUST(fixpair_brick_slab(&slab, N, FIXPAIR_SPACE_CONFIGURATION, 5, 7));
    for (window = FIXPAIR_WINDOW_NGP; window <= FIXPAIR_WINDOW_PCS; window++) {
        for (half = 0; half < 2; half++) {
            MUST(fixpair_brick_with_ghosts(&ghosted, &slab, window, half ? 0.5 : 0.0));
            MUST(fixpair_brick_reals(&reals, &ghosted));
            CHECK(reals == ghosted.count[0] * ghosted.count[1] * ghosted.count[2]);
            hash = hash_sizes(hash, ghosted.n);
            for (axis = 0; axis < 3; axis++) {
                hash = hash_sizes(hash, ghosted.start[axis]);
            }
            for (axis = 0; axis < 3; axis++) {
                hash = hash_sizes(hash, ghosted.count[axis]);
            }
            for (axis = 0; axis < 3; axis++) {
                hash = hash_sizes(hash, ghosted.stride[axis]);
            }
        }
    }
    check_case("brick_with_ghosts", hash);
}

static void bins_and_triangles(const fixpair_exec *exec) {
    static const double centres[SHELLS] = {1.0, 2.0, 3.0, 4.0, 5.0};
    static const double wavenumbers[5] = {0.03, 0.06, 0.1, 0.2, 0.4};
    fixpair_binning binning = wedge_binning();
    fixpair_layout layout;
    uint64_t three[15], hash = HASH_START;
    uint32_t squeezed[3 * (SHELLS - 1)], centred[3 * TRIANGLES];
    size_t bins, values, words, count;
    void *scratch;
    CHECK(sizeof(fixpair_bin) == 24);
    MUST(fixpair_edges_uniform(three, 5, 1.5, 3.0));
    MUST(fixpair_edges_wavenumbers(three + 5, wavenumbers, 5, BOX));
    MUST(fixpair_edges_exact(three + 10, 5, 3));
    check_case("edges", hash_bytes(HASH_START, three, sizeof three));
    MUST(fixpair_binning_lengths(&bins, &values, &words, &binning, 3));
    check_case("binning_lengths", hash_sizes(hash_sizes(hash_sizes(HASH_START, bins), values), words));

    MUST(fixpair_closed_triangle_count(&triangles_len, edges, SHELLS + 1, NULL));
    MUST(fixpair_closed_triangle_count(&count, edges, SHELLS + 1, centres));
    if (triangles_len > TRIANGLES || count > TRIANGLES) {
        printf("too many triangles\n");
        exit(2);
    }
    MUST(fixpair_closed_triangles(triangles, triangles_len, edges, SHELLS + 1, NULL));
    MUST(fixpair_closed_triangles(centred, count, edges, SHELLS + 1, centres));
    MUST(fixpair_squeezed_triangles(squeezed, SHELLS - 1, 1, SHELLS));
    hash = hash_bytes(hash, triangles, 3 * triangles_len * sizeof *triangles);
    hash = hash_bytes(hash, centred, 3 * count * sizeof *centred);
    check_case("triangles", hash_bytes(hash, squeezed, sizeof squeezed));
    MUST(fixpair_triangle_counts_scratch(&layout, triangles, triangles_len, edges, SHELLS + 1, N));
    scratch = take_scratch(layout.size);
    MUST(fixpair_triangle_counts(triangle_counts, triangles, triangles_len, edges, SHELLS + 1, N, scratch,
                                 layout.size, exec));
    check_case("triangle_counts", hash_bytes(hash_layout(HASH_START, layout), triangle_counts,
                                             triangles_len * sizeof *triangle_counts));
    give_back(scratch);
}
