// 16^3 particles from fixed initial conditions to today in five steps, in C++: memory in vectors, statuses as exceptions. Exits with 0 if what must hold holds.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fixpair.h>

namespace {

void check(fixpair_status_t status) {
    if (status != FIXPAIR_OK) throw std::runtime_error(fixpair_status_message(status));
}

// Memory that a query asks for.
struct Memory {
    explicit Memory(fixpair_layout layout) : size(layout.size), bytes(std::aligned_alloc(layout.align, layout.size), std::free) {
        if (!bytes) throw std::bad_alloc();
    }
    void *get() const { return bytes.get(); }
    std::size_t size;
    std::unique_ptr<void, decltype(&std::free)> bytes;
};

fixpair_layout tables_of(std::size_t n) {
    fixpair_layout layout;
    check(fixpair_fft_tables_scratch_f32(&layout, n));
    return layout;
}

fixpair_layout scratch_of(std::size_t n) {
    fixpair_layout layout;
    check(fixpair_fft_scratch_f32(&layout, n));
    return layout;
}

struct Transform {
    explicit Transform(std::size_t n) : tables(tables_of(n)), scratch(scratch_of(n)) {
        check(fixpair_fft_tables_init_f32(tables.get(), tables.size, n));
        check(fixpair_fft_init_f32(&hook, tables.get(), tables.size, 0, scratch.get(), scratch.size, nullptr));
    }
    Memory tables, scratch;
    fixpair_fft_f32 hook;
};

double rms(const std::vector<float> &values) {
    double sum = 0.0;
    for (float value : values) sum += double(value) * value;
    return std::sqrt(sum / double(values.size()));
}

void run() {
    const std::size_t n = 16, particles = n * n * n;
    const double box = 64.0;
    Transform transform(n);
    std::vector<float> position(3 * particles), velocity(3 * particles);
    fixpair_components_f32 x = {&position[0], &position[1], &position[2], 3, particles};
    fixpair_components_f32 v = {&velocity[0], &velocity[1], &velocity[2], 3, particles};

    fixpair_conditions conditions;
    check(fixpair_conditions_init(&conditions, 1));
    conditions.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
    conditions.redshift = 9.0;
    conditions.box_size = box;
    fixpair_layout layout;
    check(fixpair_initial_conditions_scratch_f32(&layout, &conditions, &transform.hook, nullptr));
    Memory scratch(layout);
    check(fixpair_initial_conditions_f32(&x, &v, &conditions, &transform.hook, nullptr, scratch.get(), scratch.size, nullptr));
    const double slow = rms(velocity);

    fixpair_gravity gravity;
    check(fixpair_gravity_init(&gravity));
    gravity.box_size = box;
    std::vector<double> steps(6);
    check(fixpair_linear_steps(steps.data(), steps.size(), 0.1, 1.0));
    fixpair_epoch epoch = {0.1, 0.1};
    check(fixpair_evolve_scratch_f32(&layout, &transform.hook, particles, gravity.window));
    Memory work(layout);
    const std::size_t length = (transform.hook.length + 15) / 16 * 16;
    Memory meshes({3 * length * sizeof(float), 64});
    float *mesh = static_cast<float *>(meshes.get());
    check(fixpair_evolve_f32(&x, &v, &epoch, &gravity, nullptr, steps.data(), steps.size(), nullptr, mesh, mesh + length, mesh + 2 * length, length,
                             &transform.hook, work.get(), work.size, nullptr, nullptr));
    const double fast = rms(velocity);

    std::printf("fixpair %s: %zu particles, %.0f km/s at z = 9, %.0f km/s at z = 0\n", fixpair_version(), particles, slow, fast);
    // Peculiar velocities grow as a^(1/2) in matter domination: by 3, less what the cosmological constant takes, more where halos form.
    if (epoch.position != 1.0 || epoch.velocity != 1.0) throw std::runtime_error("the run did not reach today");
    if (!(fast > 1.5 * slow && fast < 6.0 * slow)) throw std::runtime_error("velocities did not grow as they should");
    for (float coordinate : position) {
        if (!(coordinate >= 0.0f && coordinate < float(box))) throw std::runtime_error("a particle left the box");
    }
}

} // namespace

int main() {
    try {
        run();
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
