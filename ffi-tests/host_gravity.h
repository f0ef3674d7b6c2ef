/*
 * The part of host.cpp about runs and halos: a run that owns what it borrows to the library, a lambda as its observer, groups in vectors.
 */

typedef std::function<bool(const fixpair_progress &)> Observer;

/* Meshes and scratch of runs on one transform. */
template <class T>
class Run {
public:
    Run(const Transform<T> &fft, std::size_t particles, const fixpair_gravity &gravity, const fixpair_exec *exec)
        : gravity_(gravity), fft_(fft.get()), exec_(exec), scratch_(size_of_scratch(fft_, particles, gravity.window, layout_)) {
        for (auto &mesh : meshes_) {
            mesh.resize(fft_->length);
        }
    }

    /* False if the observer stopped it: call again to go on. */
    bool go(std::vector<Particle<T>> &particles, fixpair_epoch &epoch, const std::vector<double> &steps,
            const typename Names<T>::Displacements *displacements, const Observer &observer) {
        const auto position = member(particles, &Particle<T>::position);
        const auto velocity = member(particles, &Particle<T>::velocity);
        const fixpair_observer told = {const_cast<Observer *>(&observer),
                                       [](void *context, const fixpair_progress *progress) -> std::int32_t {
                                           return !(*static_cast<const Observer *>(context))(*progress);
                                       }};
        const fixpair_status_t status = Names<T>::evolve(
            &position, &velocity, &epoch, &gravity_, displacements, steps.data(), steps.size(), nullptr, meshes_[0].data(),
            meshes_[1].data(), meshes_[2].data(), fft_->length, fft_, scratch_.data(), scratch_.size(), &told, exec_);
        if (status == FIXPAIR_ERROR_STOPPED) {
            return false;
        }
        must(status);
        return true;
    }

    const fixpair_layout &layout() const { return layout_; }

private:
    static std::size_t size_of_scratch(const typename Names<T>::Fft *fft, std::size_t particles, std::int32_t window,
                                       fixpair_layout &layout) {
        must(Names<T>::evolve_scratch(&layout, fft, particles, window));
        return layout.size;
    }
    fixpair_gravity gravity_;
    const typename Names<T>::Fft *fft_;
    const fixpair_exec *exec_;
    fixpair_layout layout_;
    Memory scratch_;
    std::array<std::vector<T>, 3> meshes_;
};

/* The run "evolve.fastpm" of ffi-tests/vectors_gravity.rs, watched by a lambda that stops it once. */
template <class T>
void runs(const fixpair_exec *exec) {
    const std::size_t side = 6;
    const Transform<T> fft(N, exec);
    std::vector<Particle<T>> particles(side * side * side);
    for (std::size_t i = 0; i < particles.size(); i++) {
        const std::size_t cell[3] = {i / (side * side), i / side % side, i % side};
        for (std::size_t axis = 0; axis < 3; axis++) {
            const std::size_t at = 3 * i + axis;
            particles[i].position[axis] = static_cast<T>(static_cast<double>(cell[axis]) * BOX / static_cast<double>(side)
                                                         + 2.0 * noise(at) + 0.25 * noise(at + 1000));
            particles[i].velocity[axis] = static_cast<T>(150.0 * noise(at + 2000));
        }
        particles[i].id = i;
    }
    fixpair_gravity gravity;
    must(fixpair_gravity_init(&gravity));
    must(fixpair_force_law_init(&gravity.law));
    gravity.box_size = BOX;
    std::vector<double> steps(5), reached;
    must(fixpair_logarithmic_steps(steps.data(), steps.size(), 0.125, 1.0));
    Run<T> run(fft, particles.size(), gravity, exec);
    fixpair_epoch epoch = {steps.front(), steps.front()};
    bool patient = false;
    const Observer observer = [&](const fixpair_progress &progress) {
        reached.push_back(progress.epoch.position);
        return patient || progress.step != 2;
    };
    CHECK(!run.go(particles, epoch, steps, nullptr, observer));
    CHECK(epoch.position == steps[2] && reached.size() == 2);
    patient = true;
    CHECK(run.go(particles, epoch, steps, nullptr, observer));
    CHECK(std::equal(reached.begin(), reached.end(), steps.begin() + 1) && reached.size() == steps.size() - 1);
    const std::uint64_t sizes[2] = {run.layout().size, run.layout().align};
    const double end[2] = {epoch.position, epoch.velocity};
    const auto hash = hash_of(hash_bytes(HASH_START, sizes, sizeof sizes), particles);
    check_case((std::string("evolve.fastpm") + Names<T>::ending()).c_str(), hash_bytes(hash, end, sizeof end));
    bool untouched = true;
    for (std::size_t i = 0; i < particles.size(); i++) {
        untouched &= particles[i].id == i && particles[i].padding == 0;
    }
    CHECK(untouched);
    bool thrown = false;
    try {
        std::reverse(steps.begin(), steps.end());
        run.go(particles, epoch, steps, nullptr, observer);
    } catch (const std::runtime_error &error) {
        thrown = std::string(error.what()) == fixpair_status_message(FIXPAIR_ERROR_RANGE);
    }
    CHECK(thrown);
}

/* Groups of particles and their catalogue. */
template <class T>
class Groups {
public:
    Groups(std::vector<Particle<T>> &particles, double b, const fixpair_exec *exec) : labels_(particles.size()) {
        const auto position = shown(member(particles, &Particle<T>::position));
        double length;
        fixpair_layout layout;
        must(fixpair_linking_length(&length, b, BOX, particles.size()));
        must(Names<T>::fof_labels_scratch(&layout, particles.size()));
        Memory scratch(layout.size);
        std::vector<std::uint64_t> ids;
        for (const auto &particle : particles) {
            ids.push_back(particle.id);
        }
        must(Names<T>::fof_labels(labels_.data(), labels_.size(), &position, ids.data(), ids.size(), BOX, length,
                                  scratch.data(), scratch.size(), exec));
    }

    std::vector<fixpair_halo> halos(std::vector<Particle<T>> &particles, std::uint64_t n_min, double mass,
                                    const fixpair_exec *exec) const {
        const auto position = shown(member(particles, &Particle<T>::position));
        const auto velocity = shown(member(particles, &Particle<T>::velocity));
        std::vector<fixpair_halo> found(particles.size() / n_min);
        std::size_t count;
        fixpair_layout layout;
        must(fixpair_halos_scratch(&layout, particles.size()));
        Memory scratch(layout.size);
        must(Names<T>::halos(found.data(), found.size(), &count, labels_.data(), labels_.size(), &position, &velocity, BOX,
                             n_min, mass, scratch.data(), scratch.size(), exec));
        found.resize(count);
        return found;
    }

private:
    static typename Names<T>::Positions shown(const typename Names<T>::Components &of) {
        return {of.x, of.y, of.z, of.stride, of.length};
    }
    std::vector<std::uint64_t> labels_;
};

/* Two tight clumps far apart, one across the edge of the box, are two halos of what was put in. */
template <class T>
void clumps(const fixpair_exec *exec) {
    std::vector<Particle<T>> particles(300);
    for (std::size_t i = 0; i < particles.size(); i++) {
        const bool first = i < 200;
        for (std::size_t axis = 0; axis < 3; axis++) {
            const double place = (first ? 0.0 : BOX / 2) + noise(3 * i + axis);
            particles[i].position[axis] = static_cast<T>(place);
            particles[i].velocity[axis] = static_cast<T>(first ? 100.0 : -200.0);
        }
        particles[i].id = 1000 - i;
    }
    const auto halos = Groups<T>(particles, 0.2, exec).halos(particles, 20, 1e10, exec);
    CHECK(halos.size() == 2);
    if (halos.size() == 2) {
        CHECK(halos[0].members == 200 && halos[1].members == 100);
        CHECK(halos[0].label == 801 && halos[1].label == 701);
        CHECK(halos[0].mass == 2e12 && halos[0].velocity[1] == 100.0 && halos[1].velocity[2] == -200.0);
        CHECK(halos[0].velocity_dispersion == 0 && halos[0].extent[0] > 1.5 && halos[0].extent[0] < 2.0);
        /* 200 places between -1 and 1: their mean is 0 to 0.04. */
        CHECK(std::min(halos[0].centre[0], BOX - halos[0].centre[0]) < 0.2);
        CHECK(std::abs(halos[1].centre[0] - BOX / 2) < 0.2);
    }
}
