/*
 * The part of bits.c about groups and spheres, in one precision, of clumps that come from no transform.
 */

enum { X(LEAST) = 20 };

/* Two hundred clumps of a few cells' size, and a background. */
static REAL *X(clumps)(void) {
    REAL *places = X(reals)(3 * PARTICLES);
    size_t i;
    for (i = 0; i < 3 * PARTICLES; i++) {
        size_t particle = i / 3, clump = particle / 2 % 200;
        double centre = BOX * (random_number(3 * clump + i % 3) + 1.0) / 2.0, near = random_number(i);
        places[i] = (REAL)(particle % 2 == 0 ? centre + 3.0 * near * near * near : BOX * (near + 1.0) / 2.0);
    }
    return places;
}

static void X(label)(uint64_t *labels, const REAL *places, const uint64_t *ids, size_t count, double length) {
    X(fixpair_positions) position = X(view)(places, count);
    fixpair_layout layout;
    void *scratch;
    MUST(X(fixpair_fof_labels_scratch)(&layout, count));
    scratch = take(layout.size);
    MUST(X(fixpair_fof_labels)(labels, count, &position, ids, count, BOX, length, scratch, layout.size, exec));
    give_back(scratch);
}

/* Labels of slabs with ghosts, merged, in place of those of the whole. */
static void X(label_slabs)(uint64_t *labels, const REAL *places, const uint64_t *ids, double length) {
    static const double ends[4] = {0.0, 0.11 * BOX, 0.5 * BOX, BOX};
    uint64_t *here[3], *pairs = (uint64_t *)take(4 * PARTICLES * sizeof *pairs), *map;
    size_t *particle[3], owns[3], all[3], pairs_len = 0, entries, i, j, axis;
    size_t *owner = (size_t *)take(PARTICLES * sizeof *owner), *place_there = (size_t *)take(PARTICLES * sizeof *place_there);
    int slab;
    for (slab = 0; slab < 3; slab++) {
        REAL *own = X(reals)(3 * PARTICLES);
        uint64_t *named = (uint64_t *)take(PARTICLES * sizeof *named);
        int ghosts;
        particle[slab] = (size_t *)take(PARTICLES * sizeof **particle);
        all[slab] = 0;
        for (ghosts = 0; ghosts < 2; ghosts++) {
            for (i = 0; i < PARTICLES; i++) {
                double x = (double)places[3 * i], l = 1.001 * length, below, above;
                int inside;
                x -= BOX * floor(x / BOX);
                inside = x >= ends[slab] && x < ends[slab + 1];
                below = ends[slab] - x, above = x - ends[slab + 1];
                below = below < 0 ? below + BOX : below, above = above < 0 ? above + BOX : above;
                if (inside != ghosts && (inside || below <= l || above <= l)) {
                    if (inside) {
                        owner[i] = (size_t)slab;
                        place_there[i] = all[slab];
                    }
                    for (axis = 0; axis < 3; axis++) {
                        own[3 * all[slab] + axis] = places[3 * i + axis];
                    }
                    named[all[slab]] = ids[i];
                    particle[slab][all[slab]++] = i;
                }
            }
            if (!ghosts) {
                owns[slab] = all[slab];
            }
        }
        here[slab] = (uint64_t *)take(all[slab] * sizeof **here);
        X(label)(here[slab], own, named, all[slab], length);
        give_back(own);
        give_back(named);
    }
    for (slab = 0; slab < 3; slab++) {
        for (j = owns[slab]; j < all[slab]; j++) {
            i = particle[slab][j];
            pairs[2 * pairs_len] = here[slab][j];
            pairs[2 * pairs_len++ + 1] = here[owner[i]][place_there[i]];
        }
    }
    map = (uint64_t *)take(4 * pairs_len * sizeof *map);
    MUST(fixpair_fof_merge(map, 2 * pairs_len, &entries, pairs, pairs_len));
    for (slab = 0; slab < 3; slab++) {
        MUST(fixpair_fof_relabel(here[slab], owns[slab], map, entries, exec));
        for (j = 0; j < owns[slab]; j++) {
            labels[particle[slab][j]] = here[slab][j];
        }
        give_back(here[slab]);
        give_back(particle[slab]);
    }
    give_back(map);
    give_back(pairs);
    give_back(owner);
    give_back(place_there);
}

static void X(halos)(void) {
    static const double densities[2] = {200.0, 1000.0};
    REAL *places = X(clumps)(), *speeds = X(numbers)(3 * PARTICLES, 4, 300.0);
    uint64_t *labels = (uint64_t *)take(PARTICLES * sizeof *labels), *ids = (uint64_t *)take(PARTICLES * sizeof *ids);
    fixpair_halo *halos = (fixpair_halo *)take(PARTICLES / X(LEAST) * sizeof *halos);
    X(fixpair_positions) position = X(view)(places, PARTICLES), velocity = X(view)(speeds, PARTICLES);
    fixpair_layout layout;
    double length;
    size_t count, i;
    void *scratch;
    for (i = 0; i < PARTICLES; i++) {
        ids[i] = (uint64_t)(uint32_t)((uint32_t)i * UINT32_C(2654435761));
    }
    MUST(fixpair_linking_length(&length, 0.2, BOX, PARTICLES));
    if (cut == WHOLE) {
        X(label)(labels, places, ids, PARTICLES, length);
    } else {
        X(label_slabs)(labels, places, ids, length);
    }
    line_of_bytes(EXACT, "fof_labels", SUFFIX, labels, PARTICLES * sizeof *labels);
    MUST(fixpair_halos_scratch(&layout, PARTICLES));
    scratch = take(layout.size);
    MUST(X(fixpair_halos)(halos, PARTICLES / X(LEAST), &count, labels, PARTICLES, &position, &velocity, BOX, X(LEAST), 1e10, scratch,
                          layout.size, exec));
    give_back(scratch);
    CHECK(count > 100);
    line_of_bytes(EXACT, "halos", SUFFIX, halos, count * sizeof *halos);
    if (cut == WHOLE) {
        fixpair_sphere *spheres = (fixpair_sphere *)take(2 * count * sizeof *spheres);
        double *centres = (double *)take(3 * count * sizeof *centres), *radii = (double *)take(count * sizeof *radii);
        for (i = 0; i < count; i++) {
            memcpy(centres + 3 * i, halos[i].centre, sizeof halos[i].centre);
            radii[i] = 3.0;
        }
        MUST(X(fixpair_spheres_scratch)(&layout, PARTICLES));
        scratch = take(layout.size);
        MUST(X(fixpair_refine_centres)(centres, count, radii, &position, BOX, 0.9, 10, scratch, layout.size, exec));
        line_of_bytes(EXACT, "refine_centres", SUFFIX, centres, 3 * count * sizeof *centres);
        MUST(X(fixpair_spheres)(spheres, 2 * count, centres, count, densities, 2, &position, BOX, PARTICLES, 1e10, 10, scratch, layout.size,
                                exec));
        line_of_bytes(EXACT, "spheres", SUFFIX, spheres, 2 * count * sizeof *spheres);
        give_back(scratch);
        give_back(spheres);
        give_back(centres);
        give_back(radii);
    }
    give_back(halos);
    give_back(labels);
    give_back(ids);
    give_back(places);
    give_back(speeds);
}
