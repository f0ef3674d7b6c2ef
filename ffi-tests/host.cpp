/*
 * A host in C++11: memory that frees itself, a loop over std::thread, particles in a std::vector of structs, and two ranks that share one
 * mesh in slabs, as with FFTW-MPI. Same bits as Rust.
 *
 * host FILE: the cases of ffi-tests/vectors.rs
 */
#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "check.h"

namespace {

/* What the two precisions call things. */
template <class T>
struct Names;

#define FIXPAIR_NAMES(real, suffix)                                                                        \
    template <>                                                                                            \
    struct Names<real> {                                                                                   \
        typedef fixpair_fft_##suffix Fft;                                                                  \
        typedef fixpair_components_##suffix Components;                                                    \
        static const char *ending() { return "." #suffix; }                                                \
        static constexpr auto tables_scratch = fixpair_fft_tables_scratch_##suffix;                        \
        static constexpr auto tables_init = fixpair_fft_tables_init_##suffix;                              \
        static constexpr auto fft_scratch = fixpair_fft_scratch_##suffix;                                  \
        static constexpr auto fft_init = fixpair_fft_init_##suffix;                                        \
        static constexpr auto self_test = fixpair_fft_self_test_##suffix;                                  \
        static constexpr auto conditions_scratch = fixpair_initial_conditions_scratch_##suffix;            \
        static constexpr auto conditions = fixpair_initial_conditions_##suffix;                            \
        static constexpr auto at_scratch = fixpair_initial_conditions_at_scratch_##suffix;                 \
        static constexpr auto at = fixpair_initial_conditions_at_##suffix;                                 \
        static constexpr auto white_modes = fixpair_white_modes_##suffix;                                  \
        static constexpr auto add_shape_scratch = fixpair_add_shape_scratch_##suffix;                      \
        static constexpr auto add_shape = fixpair_add_shape_##suffix;                                      \
        typedef fixpair_positions_##suffix Positions;                                                      \
        static constexpr auto deposit_scratch = fixpair_deposit_scratch_##suffix;                          \
        static constexpr auto deposit = fixpair_deposit_##suffix;                                          \
        static constexpr auto power_sums = fixpair_power_sums_##suffix;                                    \
        static constexpr auto bispectrum_meshes = fixpair_bispectrum_meshes_##suffix;                      \
        static constexpr auto bispectrum_scratch = fixpair_bispectrum_scratch_##suffix;                    \
        static constexpr auto bispectrum = fixpair_bispectrum_##suffix;                                    \
        typedef fixpair_displacements_##suffix Displacements;                                              \
        static constexpr auto evolve_scratch = fixpair_evolve_scratch_##suffix;                            \
        static constexpr auto evolve = fixpair_evolve_##suffix;                                            \
        static constexpr auto fof_labels_scratch = fixpair_fof_labels_scratch_##suffix;                    \
        static constexpr auto fof_labels = fixpair_fof_labels_##suffix;                                    \
        static constexpr auto halos = fixpair_halos_##suffix;                                              \
    };
FIXPAIR_NAMES(float, f32)
FIXPAIR_NAMES(double, f64)

void must(fixpair_status_t status) {
    if (status != FIXPAIR_OK) {
        throw std::runtime_error(fixpair_status_message(status));
    }
}

/* Aligned memory with canaries, given back at the end of its scope. */
class Memory {
public:
    explicit Memory(std::size_t size) : start_(take(size)), size_(size) {}
    ~Memory() { give_back(start_); }
    Memory(const Memory &) = delete;
    Memory &operator=(const Memory &) = delete;
    void *data() const { return start_; }
    std::size_t size() const { return size_; }

private:
    void *start_;
    std::size_t size_;
};

template <class T>
class Transform {
public:
    Transform(std::size_t n, const fixpair_exec *exec) : tables_(tables_size(n)), scratch_(scratch_size(n)) {
        must(Names<T>::tables_init(tables_.data(), tables_.size(), n));
        must(Names<T>::fft_init(&fft_, tables_.data(), tables_.size(), 0, scratch_.data(), scratch_.size(), exec));
    }
    const typename Names<T>::Fft *get() const { return &fft_; }

private:
    static std::size_t tables_size(std::size_t n) {
        fixpair_layout layout;
        must(Names<T>::tables_scratch(&layout, n));
        return layout.size;
    }
    static std::size_t scratch_size(std::size_t n) {
        fixpair_layout layout;
        must(Names<T>::fft_scratch(&layout, n));
        return layout.size;
    }
    Memory tables_, scratch_;
    typename Names<T>::Fft fft_;
};

/* The host's loop: four threads, interleaved. */
std::int32_t thread_for(void *, std::size_t count, void (*body)(void *, std::size_t), void *argument) {
    const std::size_t width = 4;
    std::vector<std::thread> threads;
    for (std::size_t first = 0; first < width; first++) {
        threads.emplace_back([=] {
            for (std::size_t i = first; i < count; i += width) {
                body(argument, i);
            }
        });
    }
    for (auto &thread : threads) {
        thread.join();
    }
    return 0;
}

/* A particle of the host's. */
template <class T>
struct Particle {
    T position[3];
    std::uint64_t id;
    T velocity[3];
    T padding;
};

template <class T>
typename Names<T>::Components member(std::vector<Particle<T>> &particles, T (Particle<T>::*triple)[3]) {
    T *first = particles.empty() ? nullptr : particles[0].*triple;
    return {first, first + 1, first + 2, sizeof(Particle<T>) / sizeof(T), particles.size()};
}

template <class T>
std::uint64_t hash_of(std::uint64_t hash, const std::vector<Particle<T>> &particles) {
    for (const auto &particle : particles) {
        hash = hash_bytes(hash, particle.position, sizeof particle.position);
    }
    for (const auto &particle : particles) {
        hash = hash_bytes(hash, particle.velocity, sizeof particle.velocity);
    }
    return hash;
}

fixpair_conditions universe(double f_nl, double g_nl) {
    fixpair_conditions conditions;
    must(fixpair_conditions_init(&conditions, SEED));
    conditions.box_size = BOX;
    conditions.f_nl = f_nl;
    conditions.g_nl = g_nl;
    if (f_nl != 0) {
        conditions.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
        conditions.realisation.phase = FIXPAIR_PHASE_INVERTED;
    }
    return conditions;
}

template <class T>
fixpair_layout make(std::vector<Particle<T>> &particles, const fixpair_conditions &conditions,
                    const typename Names<T>::Fft *fft, const typename Names<T>::Fft *fine, const fixpair_exec *exec) {
    fixpair_layout layout;
    must(Names<T>::conditions_scratch(&layout, &conditions, fft, fine));
    Memory scratch(layout.size);
    const auto position = member(particles, &Particle<T>::position);
    const auto velocity = member(particles, &Particle<T>::velocity);
    must(Names<T>::conditions(&position, &velocity, &conditions, fft, fine, scratch.data(), scratch.size(), exec));
    return layout;
}

template <class T>
void one_process(const fixpair_exec *exec) {
    const Transform<T> fft(N, exec), fine(FINE, exec), finer(FINER, exec);
    struct {
        const char *name;
        fixpair_conditions conditions;
        const Transform<T> *fine;
    } const runs[] = {
        {"initial.gaussian", universe(0, 0), nullptr},
        {"initial.local", universe(100, 0), &fine},
        {"initial.cubic", universe(100, 1e5), &finer},
    };
    for (const auto &run : runs) {
        std::vector<Particle<T>> particles(N * N * N);
        for (std::size_t i = 0; i < particles.size(); i++) {
            particles[i].id = i;
        }
        const auto layout = make(particles, run.conditions, fft.get(), run.fine ? run.fine->get() : nullptr, exec);
        const std::uint64_t sizes[2] = {layout.size, layout.align};
        const auto hash = hash_of(hash_bytes(HASH_START, sizes, sizeof sizes), particles);
        check_case((run.name + std::string(Names<T>::ending())).c_str(), hash);
        bool untouched = true;
        for (std::size_t i = 0; i < particles.size(); i++) {
            untouched &= particles[i].id == i && particles[i].padding == 0;
        }
        CHECK(untouched);
    }
}

/* Returns when all ranks have arrived. */
class Barrier {
public:
    explicit Barrier(int ranks) : ranks_(ranks), waiting_(0), turn_(0) {}
    void wait() {
        std::unique_lock<std::mutex> lock(mutex_);
        const unsigned long turn = turn_;
        if (++waiting_ == ranks_) {
            waiting_ = 0;
            turn_++;
            all_here_.notify_all();
        } else {
            all_here_.wait(lock, [&] { return turn_ != turn; });
        }
    }

private:
    std::mutex mutex_;
    std::condition_variable all_here_;
    int ranks_, waiting_;
    unsigned long turn_;
};

/* A mesh that two ranks share: x planes of cells, y rows of transposed modes. Its transform is the built-in one of rank 0. */
template <class T>
struct Mesh {
    explicit Mesh(const Transform<T> &fft) : barrier(2), whole(fft), data(fft.get()->length), total(0) {}
    Barrier barrier;
    const Transform<T> &whole;
    std::vector<T> data;
    double total;
};

template <class T>
class Rank {
public:
    static constexpr std::size_t row = N + 2;

    Rank(Mesh<T> &mesh, std::size_t number) : mesh_(mesh), number_(number) {
        first_plane_ = number == 0 ? 0 : 5;
        planes_ = number == 0 ? 5 : 7;
        first_row_ = number == 0 ? 0 : 8;
        rows_ = number == 0 ? 8 : 4;
        fft_ = typename Names<T>::Fft();
        fft_.struct_size = sizeof fft_;
        fft_.context = this;
        fft_.forward = [](void *context, T *data) { return static_cast<Rank *>(context)->forward(data); };
        fft_.inverse = [](void *context, T *data) { return static_cast<Rank *>(context)->inverse(data); };
        fft_.sum = [](void *context, double *values, std::size_t count) {
            return static_cast<Rank *>(context)->sum(values, count);
        };
        must(fixpair_brick_slab(&fft_.configuration, N, FIXPAIR_SPACE_CONFIGURATION, first_plane_, planes_));
        must(fixpair_brick_transposed_slab(&fft_.fourier, N, first_row_, rows_));
        fft_.length = std::max(planes_, rows_) * N * row;
    }

    /* Tries the hook, and makes this rank's particles. */
    void run(const fixpair_conditions &conditions) {
        std::vector<T> data(fft_.length);
        passed = Names<T>::self_test(&fft_, data.data(), data.size()) == FIXPAIR_OK;
        particles.resize(planes_ * N * N);
        make<T>(particles, conditions, &fft_, nullptr, nullptr);
    }

    std::vector<Particle<T>> particles;
    bool passed = false;

private:
    std::int32_t forward(T *data) {
        std::copy(data, data + planes_ * N * row, mesh_.data.begin() + first_plane_ * N * row);
        together(mesh_.whole.get()->forward);
        transpose([&](T *own, T *shared) { std::copy(shared, shared + row, own); }, data);
        mesh_.barrier.wait();
        return 0;
    }

    std::int32_t inverse(T *data) {
        transpose([&](T *own, T *shared) { std::copy(own, own + row, shared); }, data);
        together(mesh_.whole.get()->inverse);
        const auto first = mesh_.data.begin() + first_plane_ * N * row;
        std::copy(first, first + planes_ * N * row, data);
        mesh_.barrier.wait();
        return 0;
    }

    std::int32_t sum(double *values, std::size_t count) {
        for (std::size_t i = 0; i < count; i++) {
            mesh_.barrier.wait();
            if (number_ == 0) {
                mesh_.total = values[i];
            }
            mesh_.barrier.wait();
            if (number_ == 1) {
                mesh_.total += values[i];
            }
            mesh_.barrier.wait();
            values[i] = mesh_.total;
        }
        return 0;
    }

    void together(std::int32_t (*pass)(void *, T *)) {
        mesh_.barrier.wait();
        if (number_ == 0) {
            pass(mesh_.whole.get()->context, mesh_.data.data());
        }
        mesh_.barrier.wait();
    }

    template <class Move>
    void transpose(Move move, T *data) {
        for (std::size_t y = 0; y < rows_; y++) {
            for (std::size_t x = 0; x < N; x++) {
                move(data + (y * N + x) * row, &mesh_.data[(x * N + first_row_ + y) * row]);
            }
        }
    }

    Mesh<T> &mesh_;
    std::size_t number_, first_plane_, planes_, first_row_, rows_;
    typename Names<T>::Fft fft_;
};

template <class T>
void two_ranks() {
    const Transform<T> whole(N, nullptr);
    for (const double g_nl : {0.0, 1e5}) {
        const auto conditions = universe(100, g_nl);
        std::vector<Particle<T>> expected(N * N * N), together;
        make<T>(expected, conditions, whole.get(), nullptr, nullptr);
        Mesh<T> mesh(whole);
        Rank<T> low(mesh, 0), high(mesh, 1);
        std::thread other([&] { high.run(conditions); });
        low.run(conditions);
        other.join();
        CHECK(low.passed && high.passed);
        together = low.particles;
        together.insert(together.end(), high.particles.begin(), high.particles.end());
        if (g_nl == 0) {
            CHECK(hash_of(HASH_START, together) == hash_of(HASH_START, expected));
            continue;
        }
        /* <Phi^2> is summed in another order: the last bits may differ, nothing else. */
        bool near = true;
        for (std::size_t i = 0; i < together.size(); i++) {
            for (int axis = 0; axis < 3; axis++) {
                const double velocity = expected[i].velocity[axis];
                near &= std::abs(together[i].velocity[axis] - velocity) <= (sizeof(T) == 4 ? 1e-2 : 1e-9);
            }
        }
        CHECK(near);
    }
}

#include "host_estimate.h"
#include "host_gravity.h"
#include "host_shape.h"
#include "host_initial.h"
#include "host_variance.h"

/* A few refusals, as a host in C++ meets them: as exceptions, with vectors untouched. */
template <class T>
void refusals() {
    fixpair_brick brick;
    fixpair_realisation realisation;
    std::size_t length;
    must(fixpair_brick_whole(&brick, N, FIXPAIR_SPACE_FOURIER, 0));
    must(fixpair_brick_reals(&length, &brick));
    must(fixpair_realisation_init(&realisation, SEED));
    Memory modes(length * sizeof(T));
    T *data = static_cast<T *>(modes.data());
    CHECK(Names<T>::white_modes(data, length - 1, &brick, &realisation, nullptr, 0, nullptr) == FIXPAIR_ERROR_LENGTH);
    realisation.amplitude = 9;
    CHECK(Names<T>::white_modes(data, length, &brick, &realisation, nullptr, 0, nullptr) == FIXPAIR_ERROR_CHOICE);
    CHECK(std::all_of(data, data + length, [](T x) { return x == 0; }));
    bool thrown = false;
    try {
        Transform<T> refused(11, nullptr);
    } catch (const std::runtime_error &error) {
        thrown = std::string(error.what()) == fixpair_status_message(FIXPAIR_ERROR_MESH_SIZE);
    }
    CHECK(thrown);
}

}  // namespace

int main(int count, char **arguments) {
    if (count != 2) {
        std::printf("usage: %s FILE\n", arguments[0]);
        return 2;
    }
    read_cases(arguments[1]);
    const fixpair_exec exec = {nullptr, thread_for};
    must(fixpair_exec_self_test(&exec));
    for (const fixpair_exec *run : {&exec, static_cast<const fixpair_exec *>(nullptr)}) {
        one_process<float>(run);
        one_process<double>(run);
        shapes<float>(run);
        shapes<double>(run);
        beyond_second_order<float>(run);
        beyond_second_order<double>(run);
        estimates<float>(run);
        estimates<double>(run);
        runs<float>(run);
        runs<double>(run);
        clumps<float>(run);
        clumps<double>(run);
    }
    statistics();
    two_ranks<float>();
    two_ranks<double>();
    two_ranks_beyond_second_order<float>();
    two_ranks_beyond_second_order<double>();
    refusals<float>();
    refusals<double>();
    return check_report("host");
}
