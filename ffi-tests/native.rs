//! Builds what the programs need: the static, the shared and the freestanding library, once each, and the programs themselves.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Where everything that the tests build lies: a folder `ffi` in the target folder.
pub(crate) fn folder() -> PathBuf {
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let folder = tmp.parent().unwrap_or(tmp).join("ffi");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    folder
}

/// The folder with the static and the shared library, features as by default.
pub(crate) static LIBRARIES: LazyLock<PathBuf> =
    LazyLock::new(|| library(&["--crate-type", "staticlib,cdylib"], &folder()));

/// The folder with a static library without std.
pub(crate) static FREESTANDING: LazyLock<PathBuf> = LazyLock::new(|| {
    let options = ["--no-default-features", "--features", "freestanding", "--crate-type", "staticlib"];
    library(&options, &folder().join("freestanding"))
});

fn library(options: &[&str], target: &Path) -> PathBuf {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root()).args(["rustc", "--release", "--lib", "--quiet"]).args(options);
    run(cargo.arg("--target-dir").arg(target));
    target.join("release")
}

/// The name of the shared library on this platform.
pub(crate) fn shared_library() -> PathBuf {
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    LIBRARIES.join(format!("{prefix}fixpair{suffix}"))
}

/// A program that the environment may name, with options: CC, CXX, PYTHON.
pub(crate) fn tool(variable: &str, default: &str) -> Command {
    let named = std::env::var(variable).unwrap_or_default();
    let mut words = named.split_whitespace();
    let mut command = Command::new(words.next().unwrap_or(default));
    command.args(words);
    command
}

/// Runs a command; its output is the message if it fails.
pub(crate) fn run(command: &mut Command) -> Output {
    let output = attempt(command);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{command:?} failed with {}:\n{}{}",
        output.status,
        text(&output.stdout),
        text(&output.stderr)
    );
    output
}

/// Runs a command that may fail, but not be missing.
fn attempt(command: &mut Command) -> Output {
    command.output().unwrap_or_else(|error| {
        panic!(
            "cannot run {command:?}: {error}. The tests need a C compiler (cc or CC), a C++ compiler (c++ or CXX), \
             Python 3 (python3 or PYTHON) and nm"
        )
    })
}

#[derive(Clone, Copy)]
pub(crate) enum Language {
    C,
    Cpp,
}

/// A command that compiles one file of this folder, with every warning an error.
pub(crate) fn compiler(language: Language, source: &str) -> Command {
    let (variable, default, standard) = match language {
        Language::C => ("CC", "cc", "-std=c99"),
        Language::Cpp => ("CXX", "c++", "-std=c++11"),
    };
    let mut command = tool(variable, default);
    // Products and sums of the programs are rounded as Rust rounds them.
    command.args([standard, "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-g", "-ffp-contract=off"]);
    command.arg("-I").arg(root().join("include")).arg(root().join("ffi-tests").join(source));
    command
}

/// What the static library asks of the system.
pub(crate) const SYSTEM: &[&str] = if cfg!(target_os = "linux") {
    &["-lpthread", "-ldl", "-lm"]
} else if cfg!(target_os = "macos") {
    &["-framework", "CoreFoundation", "-lm"]
} else {
    &["-lm"]
};

/// Compiles and links with the static library; returns the program.
pub(crate) fn program(language: Language, source: &str, name: &str, options: &[&str]) -> PathBuf {
    let program = folder().join(name);
    let mut command = compiler(language, source);
    command.args(options).arg("-o").arg(&program).arg(LIBRARIES.join("libfixpair.a")).args(SYSTEM);
    run(&mut command);
    program
}

/// Compiles and links with the shared library; returns the program.
pub(crate) fn shared_program(language: Language, source: &str, name: &str) -> PathBuf {
    let program = folder().join(name);
    let mut rpath = std::ffi::OsString::from("-Wl,-rpath,");
    rpath.push(LIBRARIES.as_os_str());
    let mut command = compiler(language, source);
    command.args(["-pthread", "-o"]).arg(&program).arg(rpath);
    command.arg("-L").arg(LIBRARIES.as_os_str()).arg(shared_library());
    run(&mut command);
    program
}

/// The functions that the header declares.
pub(crate) fn declared() -> BTreeSet<String> {
    let header = std::fs::read_to_string(root().join("include/fixpair.h")).expect("the header");
    let code = header.lines().filter(|line| !line.trim_start().starts_with(['*', '/', '#']));
    let names = code.filter_map(|line| {
        let (before, _) = line.split_once('(')?;
        let name = before.rsplit([' ', '*']).next()?;
        name.starts_with("fixpair_").then(|| name.to_owned())
    });
    names.collect()
}
