//! What a run costs and shows at three sizes, and how a choice of numbers shares out memory.

/// The numbers that a preset sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Preset {
    pub(crate) name: &'static str,
    /// Particles a side.
    pub(crate) size: usize,
    /// Side of the box, Mpc/h.
    pub(crate) length: f64,
    pub(crate) seeds: usize,
    /// Steps in time from z = 32 to z = 1.
    pub(crate) steps: usize,
    /// Cells of the mesh of the force a particle and axis.
    pub(crate) mesh_factor: usize,
    /// Time and memory, for `--help`.
    cost: &'static str,
}

pub(crate) const PRESETS: [Preset; 3] = [
    Preset {
        name: "quick",
        size: 128,
        length: 500.0,
        seeds: 12,
        steps: 12,
        mesh_factor: 2,
        cost: "6 minutes; 0.5 GB a thread",
    },
    Preset {
        name: "medium",
        size: 256,
        length: 750.0,
        seeds: 12,
        steps: 15,
        mesh_factor: 2,
        cost: "1 hour (extrapolated); 4 GB a thread",
    },
    // The box, the particles and the seeds of Avila & Adame 2022.
    Preset {
        name: "paper",
        size: 512,
        length: 1000.0,
        seeds: 41,
        steps: 15,
        mesh_factor: 2,
        cost: "32 hours (extrapolated); 19 GB",
    },
];

/// The lines of `--help` about presets.
pub(crate) fn table() -> String {
    let mut table = format!(
        "{:>10}{:>9}{:>12}{:>7}{:>7}{:>6}   {}\n",
        "preset", "size", "box [Mpc/h]", "seeds", "steps", "mesh", "time on 2 cores; memory"
    );
    for Preset { name, size, length, seeds, steps, mesh_factor, cost } in PRESETS {
        table +=
            &format!("{name:>10}{size:>7}^3{length:>12}{seeds:>7}{steps:>7}{mesh_factor:>5}x   {cost}\n");
    }
    table
}

/// Bytes that one universe needs at a time, the largest of three stages: the evolution has
/// 24 bytes of positions and velocities a particle, 12 a cell of the force's mesh and up to 20 of scratch a particle; initial conditions
/// and halos have up to 80 a particle; bispectra have a mesh for each of their shells.
pub(crate) fn memory(size: usize, mesh_factor: usize, bispectrum_reals: usize) -> usize {
    let particles = size.pow(3);
    let evolution = particles * (24 + 20 + 12 * mesh_factor.pow(3));
    let conditions = particles * 80;
    evolution.max(conditions).max(4 * bispectrum_reals + 30 * particles)
}

/// Universes at a time, and threads inside each of them: one a thread where memory allows, which needs no waiting for each other; else one
/// with all threads.
pub(crate) fn share(threads: usize, universe: usize, available: usize) -> [usize; 2] {
    if threads.saturating_mul(universe) <= available { [threads, 1] } else { [1, threads] }
}

/// Bytes that programs may still take, as Linux says; elsewhere 8 GB.
pub(crate) fn available() -> usize {
    const UNKNOWN: usize = 8 << 30;
    let read = || {
        let text = std::fs::read_to_string("/proc/meminfo").ok()?;
        let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
        Some(line.split_whitespace().nth(1)?.parse::<usize>().ok()? << 10)
    };
    read().unwrap_or(UNKNOWN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_share_a_universe_only_where_memory_is_short() {
        assert_eq!(share(4, 1 << 30, 4 << 30), [4, 1]);
        assert_eq!(share(4, (1 << 30) + 1, 4 << 30), [1, 4]);
        assert_eq!(share(1, 1 << 40, 1 << 30), [1, 1]);
    }
}
