/*
 * The part of host.cpp about statistics: an ensemble that owns its state, a likelihood that is a value, exceptions for statuses.
 */

/* Every function as C calls it. */
namespace all {
#include "conformance_variance.h"
}

typedef std::vector<double> Numbers;

/* Samples one at a time, from as many processes as one likes. */
class Ensemble {
public:
    explicit Ensemble(std::size_t values) : values_(values), state_(length_of(values)) {
        must(fixpair_ensemble_init(state_.data(), state_.size(), values, FIXPAIR_MOMENTS_COVARIANCE));
    }
    Ensemble &operator+=(const Numbers &samples) {
        must(fixpair_ensemble_add(state_.data(), state_.size(), samples.data(), samples.size()));
        return *this;
    }
    Ensemble &operator+=(const Ensemble &other) {
        must(fixpair_ensemble_merge(state_.data(), state_.size(), other.state_.data()));
        return *this;
    }
    std::uint64_t count() const {
        std::uint64_t count;
        must(fixpair_ensemble_count(&count, state_.data(), state_.size()));
        return count;
    }
    Numbers mean() const { return read(fixpair_ensemble_mean); }
    Numbers deviation() const { return read(fixpair_ensemble_deviation); }
    Numbers error() const { return read(fixpair_ensemble_error_of_mean); }
    Numbers covariance() const {
        Numbers out(values_ * values_);
        must(fixpair_ensemble_covariance(out.data(), values_, values_, state_.data(), state_.size(), 0, 0));
        return out;
    }
    const Numbers &state() const { return state_; }

private:
    typedef fixpair_status_t (*Reader)(double *, std::size_t, const double *, std::size_t);
    Numbers read(Reader reader) const {
        Numbers out(values_);
        must(reader(out.data(), out.size(), state_.data(), state_.size()));
        return out;
    }
    static std::size_t length_of(std::size_t values) {
        std::size_t length;
        must(fixpair_ensemble_length(&length, values, FIXPAIR_MOMENTS_COVARIANCE));
        return length;
    }
    std::size_t values_;
    Numbers state_;
};

std::uint64_t hash_of(std::uint64_t hash, const Numbers &numbers) {
    return hash_bytes(hash, numbers.data(), numbers.size() * sizeof(double));
}

template <class T>
std::uint64_t hash_struct(std::uint64_t hash, const T &value) {
    return hash_bytes(hash, &value, sizeof value);
}

/* Measured spectra, and what their model is made of. */
struct Spectrum {
    Numbers power, sigma, linear, alpha;
    std::int32_t of;
};

/* Spectra of the halos of ffi-tests/vectors_variance.rs; with `rough` = 0 those of the model itself. */
Spectrum halos_of(const fixpair_bias &bias, std::int32_t of, double rough) {
    const std::size_t bins = 14;
    Spectrum made = {Numbers(bins), Numbers(bins), Numbers(bins), Numbers(bins), of};
    for (std::size_t b = 0; b < bins; b++) {
        const double x = static_cast<double>(b + 1);
        made.linear[b] = 20000.0 / (1.0 + 0.5 * x);
        made.alpha[b] = 500.0 * x * x / (1.0 + 0.1 * x);
    }
    must(fixpair_halo_power(made.power.data(), &bias, made.linear.data(), made.alpha.data(), bins, of));
    for (std::size_t b = 0; b < bins; b++) {
        made.power[b] = made.power[b] * (1.0 + rough * noise(b + 300));
        made.sigma[b] = 0.05 * made.power[b] / static_cast<double>(b + 1);
    }
    return made;
}

class Likelihood {
public:
    Likelihood() { must(fixpair_likelihood_init(&data_)); }
    Likelihood &operator+=(const Spectrum &of) {
        must(fixpair_likelihood_add(&data_, of.power.data(), of.sigma.data(), of.linear.data(), of.alpha.data(), of.power.size(),
                                    of.of));
        return *this;
    }
    Likelihood &operator+=(const Likelihood &other) {
        must(fixpair_likelihood_merge(&data_, &other.data_));
        return *this;
    }
    double operator()(const fixpair_bias &at) const {
        double value;
        must(fixpair_likelihood_chi_squared(&value, &data_, &at));
        return value;
    }
    std::pair<fixpair_bias_fit, std::vector<fixpair_posterior>> posterior(const fixpair_bias &start, std::uint32_t free,
                                                                          std::size_t points) const {
        std::pair<fixpair_bias_fit, std::vector<fixpair_posterior>> found;
        found.second.resize((free & 1) + (free >> 1 & 1) + (free >> 2 & 1));
        fixpair_layout layout;
        must(fixpair_bias_posterior_scratch(&layout, points));
        Memory scratch(layout.size);
        must(fixpair_bias_posterior(&found.first, found.second.data(), found.second.size(), &data_, &start, free, points, 0.68,
                                    scratch.data(), scratch.size()));
        return found;
    }
    const fixpair_bias_likelihood &data() const { return data_; }

private:
    fixpair_bias_likelihood data_;
};

/* The Cholesky factor of a covariance of any size. */
Numbers root_of(const Numbers &covariance, std::size_t values, fixpair_layout &layout) {
    must(fixpair_covariance_root_scratch(&layout, values));
    Memory scratch(layout.size);
    Numbers root(covariance.size());
    must(fixpair_covariance_root(root.data(), covariance.data(), values, scratch.data(), scratch.size()));
    return root;
}

void samples_and_matrices() {
    const std::size_t values = 5, samples = 12, first = 7, side = 40;
    Numbers low, high, wanted, cheap, controls, matrix;
    for (std::size_t i = 0; i < values * samples; i++) {
        const double of = static_cast<double>(i % values);
        wanted.push_back(100.0 + 10.0 * of + 3.0 * noise(i) + 2.0 * noise(i + 7000));
        cheap.push_back(90.0 + 5.0 * of + 2.0 * noise(i) + 0.5 * noise(i + 9000));
        (i < first * values ? low : high).push_back(wanted.back());
        if (i % values < 3) {
            controls.push_back(cheap.back());
        }
    }
    Ensemble here(values), there(values);
    here += low;
    there += high;
    here += there;
    const auto count = here.count();
    auto hash = hash_of(hash_struct(HASH_START, count), here.mean());
    check_case("ensemble_moments", hash_of(hash_of(hash, here.deviation()), here.error()));
    /* The covariance of a sample with itself is the square of its deviation. */
    const auto covariance = here.covariance(), deviation = here.deviation();
    for (std::size_t i = 0; i < values; i++) {
        CHECK(std::abs(covariance[i * values + i] / (deviation[i] * deviation[i]) - 1.0) < 1e-14);
    }
    std::vector<std::uint64_t> draws(samples);
    Numbers mean(values);
    must(fixpair_bootstrap_indices(draws.data(), samples, samples, SEED, (UINT64_C(1) << 40) + 3));
    must(fixpair_resampled_mean(mean.data(), values, wanted.data(), samples, draws.data(), samples));
    check_case("resampled_mean", hash_of(HASH_START, mean));
    fixpair_difference difference;
    must(fixpair_matched_difference(&difference, wanted.data(), cheap.data(), samples));
    check_case("matched_difference", hash_struct(HASH_START, difference));

    for (std::size_t i = 0; i < side * side; i++) {
        const double row = static_cast<double>(i / side), column = static_cast<double>(i % side);
        matrix.push_back((row == column ? 1.5 : 1.0 / (1.0 + std::abs(row - column))) * ((row + 1.0) * (column + 1.0)));
    }
    fixpair_layout layout;
    const auto root = root_of(matrix, side, layout);
    check_case("covariance_root", hash_of(hash_layout(HASH_START, layout), root));

    const std::size_t q = 3;
    const Numbers mu = {90.0, 95.0, 100.0}, of_mu = {0.015625, 0.0, 0.0, 0.0, 0.015625, 0.0, 0.0, 0.0, 0.015625};
    Numbers spread(values * values), beta(values * q);
    must(fixpair_carpool_scratch(&layout, values, q));
    Memory scratch(layout.size);
    hash = hash_layout(HASH_START, layout);
    for (const double *error : {static_cast<const double *>(nullptr), of_mu.data()}) {
        must(fixpair_carpool(mean.data(), spread.data(), beta.data(), wanted.data(), controls.data(), samples, values, mu.data(),
                             error, q, scratch.data(), scratch.size()));
        hash = hash_of(hash_of(hash_of(hash, mean), spread), beta);
    }
    check_case("carpool", hash);
    bool thrown = false;
    try {
        root_of(Numbers(4, 1.0), 2, layout);
    } catch (const std::runtime_error &error) {
        thrown = std::string(error.what()) == fixpair_status_message(FIXPAIR_ERROR_SINGULAR);
    }
    CHECK(thrown);
    thrown = false;
    try {
        Ensemble(values).deviation();
    } catch (const std::runtime_error &error) {
        thrown = std::string(error.what()) == fixpair_status_message(FIXPAIR_ERROR_SAMPLES);
    }
    CHECK(thrown);
}

/* Halos without noise give back the numbers that they were made with, from P_hh, from P_hm, and from both. */
void halos_of_the_paper() {
    const fixpair_bias truth = {2.32, 1.0, 100.0, 1.686};
    const std::uint32_t free = FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL;
    Likelihood rough, hh, hm, both;
    rough += halos_of(truth, FIXPAIR_SPECTRUM_HALO_HALO, 0.02);
    Likelihood of_both[2];
    of_both[0] = rough;
    of_both[1] += halos_of(truth, FIXPAIR_SPECTRUM_HALO_MATTER, 0.02);
    check_case("likelihood_add", hash_struct(hash_struct(HASH_START, of_both[0].data()), of_both[1].data()));
    hh += halos_of(truth, FIXPAIR_SPECTRUM_HALO_HALO, 0.0);
    hm += halos_of(truth, FIXPAIR_SPECTRUM_HALO_MATTER, 0.0);
    both += hh;
    both += hm;
    CHECK(both(truth) < 1e-12 && rough(truth) > 1.0);
    CHECK(both.data().bins == hh.data().bins + hm.data().bins);
    fixpair_bias start;
    must(fixpair_bias_init(&start));
    double widths[3];
    std::size_t i = 0;
    for (const auto *likelihood : {&hh, &hm, &both}) {
        const auto found = likelihood->posterior(start, free, 64);
        CHECK(std::abs(found.first.value.b_g - 2.32) < 1e-9 && std::abs(found.first.value.f_nl - 100.0) < 1e-6);
        CHECK(found.second.size() == 2 && found.second[1].low < 100.0 && found.second[1].high > 100.0);
        widths[i++] = found.second[1].deviation;
    }
    CHECK(widths[2] < widths[0] && widths[2] < widths[1]);
}

void statistics() {
    all::statistics();
    static_assert(sizeof(fixpair_suppression) == 24 && sizeof(fixpair_suppression_fit) == 136, "structs have their size");
    static_assert(sizeof(fixpair_bias) == 32 && sizeof(fixpair_bias_likelihood) == 296, "structs have their size");
    static_assert(sizeof(fixpair_bias_fit) == 144 && sizeof(fixpair_posterior) == 64, "structs have their size");
    static_assert(sizeof(fixpair_difference) == 72 && sizeof(fixpair_control_variate) == 48, "structs have their size");
    samples_and_matrices();
    halos_of_the_paper();
}
