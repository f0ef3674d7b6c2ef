/*
 * The part of host.cpp about shapes of primordial non-Gaussianity: rows in vectors, which a host may change.
 */

inline std::vector<fixpair_shape_row> rows_of(std::int32_t shape) {
    std::size_t count = 0;
    CHECK(fixpair_shape_rows(nullptr, 0, &count, shape) == FIXPAIR_ERROR_LENGTH);
    std::vector<fixpair_shape_row> rows(count);
    must(fixpair_shape_rows(rows.data(), rows.size(), &count, shape));
    return rows;
}

/* Phi of one f_NL with a kernel, from the Gaussian Phi. */
template <class T>
std::vector<T> with_shape(std::vector<T> phi, double f_nl, const std::vector<fixpair_shape_row> &rows,
                          const Transform<T> &work, fixpair_layout &layout, const fixpair_exec *exec) {
    fixpair_brick brick;
    must(fixpair_brick_whole(&brick, N, FIXPAIR_SPACE_FOURIER, 0));
    must(Names<T>::add_shape_scratch(&layout, &brick, work.get()));
    Memory scratch(layout.size);
    must(Names<T>::add_shape(phi.data(), phi.size(), &brick, f_nl, 0.96, rows.data(), rows.size(), work.get(), scratch.data(),
                             scratch.size(), exec));
    return phi;
}

template <class T>
void shapes(const fixpair_exec *exec) {
    const fixpair_conditions conditions = universe(0, 0);
    std::size_t entries, reals;
    fixpair_brick brick;
    fixpair_layout layout;
    must(fixpair_mode_table_length(&entries, N));
    std::vector<double> amplitude(entries);
    must(fixpair_potential_amplitude_table(amplitude.data(), entries, N, BOX, &conditions.cosmology, &conditions.linear,
                                           FIXPAIR_CONVENTION_CMB, exec));
    must(fixpair_brick_whole(&brick, N, FIXPAIR_SPACE_FOURIER, 0));
    must(fixpair_brick_reals(&reals, &brick));
    std::vector<T> gaussian(reals);
    must(Names<T>::white_modes(gaussian.data(), reals, &brick, &conditions.realisation, amplitude.data(), entries, exec));
    const Transform<T> work(FINE, exec);
    auto rows = rows_of(FIXPAIR_SHAPE_FOLDED);
    const auto folded = with_shape(gaussian, 5000.0, rows, work, layout, exec);
    const auto hash = hash_layout(HASH_START, layout);
    check_case((std::string("add_shape.folded") + Names<T>::ending()).c_str(),
               hash_brick(hash, folded.data(), &brick, sizeof(T)));
    /* Rows of opposite sign, and f_NL of opposite sign, are the same. */
    for (auto &row : rows) {
        row.coefficient = -row.coefficient;
    }
    CHECK(with_shape(gaussian, -5000.0, rows, work, layout, exec) == folded);
    CHECK(with_shape(gaussian, 0.0, rows, work, layout, exec) == gaussian);
}
