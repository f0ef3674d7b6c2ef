/*
 * The part of conformance.c about groups, halos and spherical overdensities, in one precision.
 */

/* Component `axis` of particle i: ten clumps, one of them on a corner of the box, a thread through the box, and a background. */
static REAL X(place)(size_t i, size_t axis) {
    size_t clump = i % CLUMPS;
    double centre = clump == 0 ? 0.0 : BOX * (noise(7 * clump + axis) + 1.0) / 2.0;
    double around = centre + 4.0 * noise(3 * i + axis + 9000);
    if (i >= CLUMPED && i < THREADED) {
        return (REAL)(axis == 0 ? BOX * (double)(i - CLUMPED) / 50.0 : axis == 1 ? 77.0 : 33.0);
    }
    return (REAL)(i < CLUMPED ? around : BOX * (noise(3 * i + axis) + 1.0) / 2.0);
}

static void X(crowd)(X(fixpair_components) *both) {
    size_t i;
    for (i = 0; i < 3 * CROWD; i++) {
        *X(component)(&both[0], i) = X(place)(i / 3, i % 3);
        *X(component)(&both[1], i) = (REAL)(300.0 * noise(i + 5000));
    }
}

static void X(label)(uint64_t *labels, const X(fixpair_positions) *position, const uint64_t *ids, double length,
                     const fixpair_exec *exec) {
    fixpair_layout layout;
    void *scratch;
    size_t count = position->length;
    MUST(X(fixpair_fof_labels_scratch)(&layout, count));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_fof_labels)(labels, count, position, ids, ids == NULL ? 0 : count, BOX, length, scratch, layout.size,
                               exec));
    give_back(scratch);
}

/* Two ranks with ghosts from each other; what they find together is what `whole` has. */
static void X(halos_on_slabs)(const uint64_t *ids, const uint64_t *named, const fixpair_halo *whole, size_t whole_len,
                              double length, const fixpair_exec *exec) {
    size_t own[2][CROWD], ghost[2][CROWD], owns[2] = {0, 0}, ghosts[2] = {0, 0}, pairs_len = 0, entries, sums_len = 0;
    size_t groups, count, i, j, axis;
    uint64_t *labels[2], *pairs, *map, hash = HASH_START;
    fixpair_halo_sums *sums = (fixpair_halo_sums *)take(4 * CROWD * sizeof *sums);
    fixpair_halo *halos;
    REAL *places[2], *speeds[2];
    int rank, same = 1;
    for (i = 0; i < CROWD; i++) {
        double x = (double)X(place)(i, 0), l = 1.001 * length, border = 80.0;
        x = x < 0.0 ? x + BOX : x;
        rank = x >= border;
        own[rank][owns[rank]++] = i;
        /* A little more than the linking length: more ghosts than needed do no harm. */
        if ((x > border ? x - border : border - x) <= l || x <= l || BOX - x <= l) {
            ghost[1 - rank][ghosts[1 - rank]++] = i;
        }
    }
    CHECK(ghosts[0] > 0 && ghosts[1] > 0);
    for (rank = 0; rank < 2; rank++) {
        size_t all = owns[rank] + ghosts[rank];
        uint64_t *named_here = (uint64_t *)take(all * sizeof *named_here);
        X(fixpair_positions) position;
        labels[rank] = (uint64_t *)take(all * sizeof *labels[rank]);
        places[rank] = X(reals)(3 * all);
        speeds[rank] = X(reals)(3 * all);
        for (j = 0; j < all; j++) {
            i = j < owns[rank] ? own[rank][j] : ghost[rank][j - owns[rank]];
            named_here[j] = ids[i];
            for (axis = 0; axis < 3; axis++) {
                places[rank][3 * j + axis] = X(place)(i, axis);
                speeds[rank][3 * j + axis] = (REAL)(300.0 * noise(3 * i + axis + 5000));
            }
        }
        position = X(view)(places[rank], all);
        X(label)(labels[rank], &position, named_here, length, exec);
        give_back(named_here);
    }
    pairs = (uint64_t *)take(2 * (ghosts[0] + ghosts[1]) * sizeof *pairs);
    for (rank = 0; rank < 2; rank++) {
        for (j = 0; j < ghosts[rank]; j++) {
            size_t there = 0;
            while (own[1 - rank][there] != ghost[rank][j]) {
                there++;
            }
            pairs[2 * pairs_len] = labels[rank][owns[rank] + j];
            pairs[2 * pairs_len++ + 1] = labels[1 - rank][there];
        }
    }
    map = (uint64_t *)take(4 * pairs_len * sizeof *map);
    MUST(fixpair_fof_merge(map, 2 * pairs_len, &entries, pairs, pairs_len));
    hash = hash_bytes(hash, map, 2 * entries * sizeof *map);
    for (rank = 0; rank < 2; rank++) {
        X(fixpair_positions) position = X(view)(places[rank], owns[rank]), velocity = X(view)(speeds[rank], owns[rank]);
        fixpair_layout layout;
        void *scratch;
        MUST(fixpair_halos_scratch(&layout, owns[rank]));
        scratch = take_scratch(layout.size);
        MUST(X(fixpair_halo_sums)(sums + sums_len, owns[rank] / LEAST_MEMBERS + entries, &count, labels[rank], owns[rank],
                                  &position, &velocity, BOX, LEAST_MEMBERS, map, entries, scratch, layout.size, exec));
        sums_len += count;
        MUST(fixpair_fof_relabel(labels[rank], owns[rank], map, entries, exec));
        hash = hash_bytes(hash, labels[rank], owns[rank] * sizeof *labels[rank]);
        for (j = 0; j < owns[rank]; j++) {
            same &= labels[rank][j] == named[own[rank][j]];
        }
        give_back(scratch);
    }
    CHECK(same);
    check_named("fof_labels.slabs", "", SUFFIX, hash);
    MUST(fixpair_halo_sums_merge(sums, sums_len, &groups, BOX));
    halos = (fixpair_halo *)take(groups * sizeof *halos);
    MUST(fixpair_halos_finish(halos, groups, &count, sums, groups, BOX, LEAST_MEMBERS, 1e10));
    CHECK(count == whole_len);
    for (i = 0; i < count && i < whole_len; i++) {
        CHECK(halos[i].label == whole[i].label && halos[i].members == whole[i].members);
    }
    hash = hash_bytes(HASH_START, sums, groups * sizeof *sums);
    check_named("halos.slabs", "", SUFFIX, hash_bytes(hash, halos, count * sizeof *halos));
    for (rank = 0; rank < 2; rank++) {
        give_back(labels[rank]);
        give_back(places[rank]);
        give_back(speeds[rank]);
    }
    give_back(pairs);
    give_back(map);
    give_back(sums);
    give_back(halos);
}

static void X(spheres)(const X(fixpair_positions) *position, const fixpair_halo *halos, size_t count,
                       const fixpair_exec *exec) {
    static const double densities[DENSITIES] = {50.0, 200.0, 1000.0};
    fixpair_sphere *spheres = (fixpair_sphere *)take(DENSITIES * count * sizeof *spheres);
    double *centres = (double *)take(3 * count * sizeof *centres), *radii = (double *)take(count * sizeof *radii);
    fixpair_layout layout;
    void *scratch;
    size_t i;
    for (i = 0; i < count; i++) {
        memcpy(centres + 3 * i, halos[i].centre, sizeof halos[i].centre);
        radii[i] = 2.0 * halos[i].radius < 20.0 ? 2.0 * halos[i].radius : 20.0;
    }
    MUST(X(fixpair_spheres_scratch)(&layout, CROWD));
    scratch = take_scratch(layout.size);
    MUST(X(fixpair_refine_centres)(centres, count, radii, position, BOX, 0.975, 5, scratch, layout.size, exec));
    check_named("refine_centres", "", SUFFIX, hash_bytes(HASH_START, centres, 3 * count * sizeof *centres));
    MUST(X(fixpair_spheres)(spheres, DENSITIES * count, centres, count, densities, DENSITIES, position, BOX, CROWD, 1e10,
                            5, scratch, layout.size, exec));
    check_named("spheres", "", SUFFIX,
                hash_bytes(hash_layout(HASH_START, layout), spheres, DENSITIES * count * sizeof *spheres));
    give_back(spheres);
    give_back(centres);
    give_back(radii);
    give_back(scratch);
}

static void X(halos)(const fixpair_exec *exec) {
    enum { PLACES = CROWD / LEAST_MEMBERS };
    uint64_t *labels = (uint64_t *)take(CROWD * sizeof *labels), *named = (uint64_t *)take(CROWD * sizeof *named);
    uint64_t *ids = (uint64_t *)take(CROWD * sizeof *ids), hash;
    fixpair_halo *halos = (fixpair_halo *)take(PLACES * sizeof *halos);
    fixpair_halo_sums *sums = (fixpair_halo_sums *)take(PLACES * sizeof *sums);
    fixpair_layout layout;
    double length;
    void *scratch;
    size_t count = 0, groups, i;
    int kind, with;
    MUST(fixpair_linking_length(&length, 0.2, BOX, CROWD));
    for (i = 0; i < CROWD; i++) {
        ids[i] = (uint64_t)i * 7919 % 100003;
    }
    for (kind = 0; kind < X(LAYOUTS); kind++) {
        REAL *memory = X(reals)(8 * CROWD);
        X(fixpair_components) both[2];
        X(fixpair_positions) position, velocity;
        X(lay_out)(both, memory, CROWD, kind);
        X(crowd)(both);
        position = X(shown)(&both[0]);
        velocity = X(shown)(&both[1]);
        X(label)(labels, &position, NULL, length, exec);
        X(label)(named, &position, ids, length, exec);
        MUST(X(fixpair_fof_labels_scratch)(&layout, CROWD));
        hash = hash_bytes(hash_layout(HASH_START, layout), labels, CROWD * sizeof *labels);
        check_named("fof_labels", "", SUFFIX, hash_bytes(hash, named, CROWD * sizeof *named));
        MUST(fixpair_halos_scratch(&layout, CROWD));
        scratch = take_scratch(layout.size);
        MUST(fixpair_halo_count(&groups, named, CROWD, LEAST_MEMBERS, scratch, layout.size, exec));
        check_named("halo_count", "", SUFFIX, hash_bytes(HASH_START, &groups, sizeof groups));
        hash = HASH_START;
        for (with = 0; with < 2; with++) {
            MUST(X(fixpair_halos)(halos, PLACES, &count, named, CROWD, &position, with ? &velocity : NULL, BOX,
                                  LEAST_MEMBERS, 1e10, scratch, layout.size, exec));
            hash = hash_bytes(hash, halos, count * sizeof *halos);
        }
        check_named("halos", "", SUFFIX, hash);
        MUST(X(fixpair_halo_sums)(sums, PLACES, &groups, named, CROWD, &position, &velocity, BOX, LEAST_MEMBERS, NULL, 0,
                                  scratch, layout.size, exec));
        check_named("halo_sums", "", SUFFIX, hash_bytes(HASH_START, sums, groups * sizeof *sums));
        give_back(scratch);
        X(spheres)(&position, halos, count, exec);
        give_back(memory);
    }
    X(halos_on_slabs)(ids, named, halos, count, length, exec);
    give_back(labels);
    give_back(named);
    give_back(ids);
    give_back(halos);
    give_back(sums);
}
