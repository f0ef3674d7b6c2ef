//! Runs the programs. Each prints what does not hold and fails, and the test shows it.

use std::process::Command;

use crate::abi::declared;
use crate::freestanding::undefined;
use crate::native::{Language, compiler, folder, program, root, run, shared_library, shared_program, tool};
use crate::vectors::VECTORS;

#[test]
fn c_gets_the_bits_of_rust() {
    run(Command::new(program(Language::C, "conformance.c", "conformance", &["-pthread"])).arg(&*VECTORS));
}

#[test]
fn c_is_refused_with_memory_untouched() {
    run(&mut Command::new(program(Language::C, "refusals.c", "refusals", &["-pthread"])));
}

#[test]
fn cpp_gets_the_bits_of_rust() {
    // A machine need not have a C++ compiler; one that is asked to be complete must.
    let required = std::env::var_os("FIXPAIR_REQUIRE_CXX").is_some();
    if !required && tool("CXX", "c++").arg("--version").output().is_err() {
        println!("skipped: no C++ compiler (c++ or CXX)");
        return;
    }
    run(Command::new(shared_program(Language::Cpp, "host.cpp", "host")).arg(&*VECTORS));
}

#[test]
fn python_gets_the_bits_of_rust() {
    let mut python = tool("PYTHON", "python3");
    python.arg("-B").arg(root().join("ffi-tests/test_ctypes.py")).arg(shared_library());
    run(python.arg(&*VECTORS).arg(root().join("include/fixpair.h")));
}

#[test]
fn threads_of_a_host_share_the_library() {
    run(&mut Command::new(program(Language::C, "concurrent.c", "concurrent", &["-pthread"])));
}

#[test]
fn no_parameter_reaches_a_panic() {
    run(&mut Command::new(program(Language::C, "fuzz.c", "fuzz", &[])));
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "it reserves address space as Linux does")]
fn sizes_beyond_all_memory_are_served_or_refused() {
    run(&mut Command::new(program(Language::C, "sparse.c", "sparse", &[])));
}

#[test]
fn the_c_of_the_readme_compiles() {
    let readme = std::fs::read_to_string(root().join("README.md")).expect("README.md");
    let blocks: Vec<_> = readme.split("```c\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    // What the reader of each block has at hand.
    let hosts = [
        "void *my_particles, size_t n, uint64_t seed, const double *k, const double *power, size_t rows, fixpair_fft_f32 fft",
        "fixpair_components_f32 x, fixpair_components_f32 v, double L, fixpair_fft_f32 fft, float *mesh, void *scratch, size_t bytes, \
         void *me, int32_t (*save_and_show)(void *, const fixpair_progress *), uint64_t *labels, fixpair_halo *halos, size_t count",
        "struct particle *p, size_t count, double L, fixpair_fft_f32 fft, float *mesh, void *scratch, size_t bytes, \
         int64_t *sums, size_t words, fixpair_bin *bins, double *P",
        "double *P, const double *original, const double *inverted, double *sigma, fixpair_suppression left, const double *k, const double *model, \
         const double *modes, size_t bins, double n, const double *linear, const double *alpha, void *scratch, size_t bytes, double *f100, \
         const double *f0, size_t seed, size_t seeds, double worth, double sigma_normal",
    ];
    assert_eq!(blocks.len(), hosts.len(), "every block of C has its host");
    let mut source =
        String::from("#include <math.h>\n#include <stdio.h>\n#include <stdlib.h>\n#include <fixpair.h>\n");
    source.push_str("struct particle { float pos[3], vel[3]; uint32_t id; };\n");
    for (i, (code, host)) in blocks.iter().zip(hosts).enumerate() {
        source.push_str(&format!("void host{i}({host});\nvoid host{i}({host})\n{{\n{code}}}\n"));
    }
    let file = folder().join("readme.c");
    std::fs::write(&file, source).expect("the target folder can be written");
    let mut compile = tool("CC", "cc");
    compile.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I"]);
    run(compile.arg(root().join("include")).arg(file));
}

#[test]
fn noise_of_ngenic_is_drawn_as_with_gsl() {
    // A machine need not have GSL; one that is asked to be complete must.
    let required = std::env::var_os("FIXPAIR_REQUIRE_GSL").is_some();
    let found = tool("PKG_CONFIG", "pkg-config").args(["--cflags", "--libs", "gsl"]).output();
    let Some(found) = found.ok().filter(|found| found.status.success()) else {
        assert!(!required, "GSL is missing, or pkg-config");
        println!("skipped: no GSL (libgsl-dev)");
        return;
    };
    let options = String::from_utf8_lossy(&found.stdout).into_owned();
    let options: Vec<_> = options.split_whitespace().collect();
    run(&mut Command::new(program(Language::C, "gsl_noise.c", "gsl_noise", &options)));
}

#[test]
fn the_c_programs_call_every_function() {
    let declared = declared();
    // These refuse nothing: any argument will do.
    let never = [
        "status_message",
        "version",
        "threads_destroy",
        "fft_padding_f32",
        "fft_padding_f64",
        "fft_next_side",
    ];
    for (source, excepted) in [("conformance.c", &[][..]), ("refusals.c", &never)] {
        let object = folder().join(source).with_extension("o");
        run(compiler(Language::C, source).arg("-c").arg("-o").arg(&object));
        let called = undefined(&object);
        let missing = declared.iter().filter(|name| !called.contains(*name));
        let missing: Vec<_> = missing.filter(|name| !excepted.contains(&&name["fixpair_".len()..])).collect();
        assert!(missing.is_empty(), "{source} does not call {missing:?}");
    }
}
