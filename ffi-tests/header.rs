//! `include/fixpair.h` is what cbindgen makes of `src/capi`: generated here, compared, and written where FIXPAIR_BLESS=1 asks for it.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The files whose items the header holds, in its order, with the title of each section of functions.
const SECTIONS: [(&str, &str); 38] = [
    ("status", "Statuses and version"),
    ("mesh", "Meshes and bricks"),
    ("exec", "Threads"),
    ("fft", "Transform hook"),
    ("built_in", "Built-in transform"),
    ("noise", "Random modes"),
    ("cosmology", "Cosmology"),
    ("mode_table", "Cosmology on a mesh"),
    ("species", "Species"),
    ("initial", "Initial conditions in one call"),
    ("pre_initial", "Initial conditions at the host's own positions"),
    ("stages", "Initial conditions stage by stage"),
    ("shape", "Shapes of primordial non-Gaussianity"),
    ("third", "Third order"),
    ("particles", "Particles"),
    ("pm", "Deposit and read-out"),
    ("cells", "Ghost planes and interlacing"),
    ("force", "Forces on a mesh"),
    ("kick", "Kick and drift"),
    ("factors", "Steps in time"),
    ("evolve", "Runs"),
    ("fof", "Friends of friends"),
    ("halos", "Halo catalogue"),
    ("spheres", "Spherical overdensities"),
    ("binning", "Bins of spectra and correlation functions"),
    ("power", "Power spectrum"),
    ("correlation", "Correlation function"),
    ("triangles", "Triangles"),
    ("bispectrum_sums", "Bispectrum with the host's own transform"),
    ("bispectrum", "Bispectrum"),
    ("bispectrum_values", "From sums to bispectra"),
    ("ensemble", "Ensembles and pairs"),
    ("resample", "Jackknife and bootstrap"),
    ("scatter", "Models of scatter"),
    ("bias", "Bias and its likelihood"),
    ("posterior", "Fits and posteriors"),
    ("matched", "Matched simulations"),
    ("covariance", "Covariance matrices"),
];

/// Files without functions that define structs of the interface.
const STRUCTS: [&str; 18] = [
    "src/capi/run.rs",
    "src/scratch.rs",
    "src/cosmology/growth.rs",
    "src/initial/shape_rows.rs",
    "src/pm/factors.rs",
    "src/pm/evolve.rs",
    "src/halos/sums.rs",
    "src/halos/catalogue.rs",
    "src/halos/spheres.rs",
    "src/estimate/binning.rs",
    "src/variance/models.rs",
    "src/variance/suppression.rs",
    "src/variance/bias.rs",
    "src/variance/likelihood.rs",
    "src/variance/fit.rs",
    "src/variance/posterior.rs",
    "src/variance/matched.rs",
    "src/variance/control.rs",
];

/// The header that belongs to the sources.
pub(crate) static HEADER: LazyLock<String> = LazyLock::new(generate);

const PREAMBLE: &str = include_str!("header_preamble.h");

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn generate() -> String {
    let mut config = cbindgen::Config {
        language: cbindgen::Language::C,
        cpp_compat: true,
        include_guard: Some("FIXPAIR_H".into()),
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        usize_is_size_t: true,
        style: cbindgen::Style::Both,
        documentation_style: cbindgen::DocumentationStyle::Doxy,
        header: Some(PREAMBLE.trim_end().into()),
        line_length: 110,
        ..cbindgen::Config::default()
    };
    config.function.sort_by = Some(cbindgen::SortKey::None);
    for (rust, c) in [
        ("Layout", "fixpair_layout"),
        ("Growth", "fixpair_growth"),
        ("ShapeRow", "fixpair_shape_row"),
        ("StepFactors", "fixpair_step_factors"),
        ("Epoch", "fixpair_epoch"),
        ("HaloSums", "fixpair_halo_sums"),
        ("Halo", "fixpair_halo"),
        ("Sphere", "fixpair_sphere"),
        ("Bin", "fixpair_bin"),
        ("Suppression", "fixpair_suppression"),
        ("SuppressionFit", "fixpair_suppression_fit"),
        ("Bias", "fixpair_bias"),
        ("BiasLikelihood", "fixpair_bias_likelihood"),
        ("BiasFit", "fixpair_bias_fit"),
        ("Posterior", "fixpair_posterior"),
        ("MatchedDifference", "fixpair_difference"),
        ("ControlVariate", "fixpair_control_variate"),
    ] {
        config.export.rename.insert(rust.into(), c.into());
    }
    config.defines.insert("feature = std".into(), "FIXPAIR_THREADS".into());
    config.defines.insert("feature = linalg".into(), "FIXPAIR_LINALG".into());
    config.export.exclude.extend([
        "EARLIEST_GROWTH".into(),
        "COLA_EXPONENT".into(),
        "STEP".into(),
        "ALIGN".into(),
        "HIGHEST_ORDER".into(),
        "LEAST_OVERDENSITY".into(),
        "DELTA_C".into(),
        "FREE_B_G".into(),
        "FREE_P".into(),
        "FREE_F_NL".into(),
        "Shape".into(),
        "Shape_ALL".into(),
    ]);
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in STRUCTS {
        builder = builder.with_src(root().join(file));
    }
    for (file, _) in SECTIONS {
        builder = builder.with_src(root().join("src/capi").join(file).with_extension("rs"));
    }
    let mut header = Vec::new();
    builder.generate().expect("cbindgen understands src/capi").write(&mut header);
    polish(&String::from_utf8(header).expect("a header is text"))
}

/// Drops what is meant for Rust readers, and puts a title before each section's first function.
fn polish(header: &str) -> String {
    let firsts: Vec<(String, &str)> = SECTIONS
        .iter()
        .map(|&(file, title)| {
            let source = std::fs::read_to_string(root().join("src/capi").join(file).with_extension("rs"));
            let source = source.expect("a file of src/capi");
            let after = source.split("extern \"C\" fn fixpair_").nth(1);
            let name: String = after
                .unwrap_or_default()
                .chars()
                .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                .collect();
            (format!("fixpair_{name}("), title)
        })
        .collect();
    let mut lines: Vec<String> = Vec::new();
    let mut comment = 0; // where the last comment began
    let mut skipping = false;
    for line in header.lines() {
        let text = line.trim();
        if text.starts_with("/*") {
            comment = lines.len();
        }
        if text == "* # Safety" {
            skipping = true;
            while lines.last().is_some_and(|last| last.trim() == "*") {
                lines.pop();
            }
        }
        skipping &= text != "*/";
        if skipping || text.starts_with("* ```") {
            continue;
        }
        let named = |(name, _): &&(String, &str)| line.contains(name.as_str()) && !text.starts_with('*');
        if let Some((_, title)) = firsts.iter().find(named) {
            let rule = "=".repeat(title.len());
            lines.insert(comment, format!("/*\n * {title}\n * {rule}\n */\n"));
        }
        let line =
            line.replace("/**", "/*").replace("defined(FIXPAIR_THREADS)", "!defined(FIXPAIR_NO_THREADS)");
        let line = line.replace("defined(FIXPAIR_LINALG)", "!defined(FIXPAIR_NO_LINALG)");
        let negative = line.strip_prefix("#define ").and_then(|rest| rest.split_once(" -"));
        lines.push(negative.map_or(line.clone(), |(name, digits)| format!("#define {name} (-{digits})")));
        if text == "*/" && lines.len() == comment + 3 {
            // A comment of one line.
            let one = lines[comment + 1].trim_start_matches(' ').trim_start_matches("* ").to_owned();
            let indent = lines[comment].len() - 2;
            lines.truncate(comment);
            lines.push(format!("{}/* {one} */", " ".repeat(indent)));
        }
    }
    lines.join("\n") + "\n"
}

#[test]
fn header_is_current() {
    let path = root().join("include/fixpair.h");
    let generated = &*HEADER;
    if std::env::var_os("FIXPAIR_BLESS").is_some() {
        std::fs::write(&path, generated).expect("include/ can be written");
    }
    let committed = std::fs::read_to_string(Path::new(&path)).unwrap_or_default();
    assert!(
        committed == *generated,
        "include/fixpair.h is stale: run FIXPAIR_BLESS=1 cargo test --test ffi header"
    );
}
