//! `packaging/abi/fixpair-SERIES.abi` is what programs compiled against one series of versions, that of the soname, rely on: here it is
//! compared with the header, with the compiler's layout in C and in C++, with Rust's, and with the symbols of the libraries.
//!
//! FIXPAIR_BLESS=1 records what is new; and what is gone or changed too, as long as CHANGELOG.md knows no release of the series.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use crate::abi_header::{Declaration, Item, Named, read};
use crate::abi_structs::layouts;
use crate::header::HEADER;
use crate::native::{FREESTANDING, folder, root, run, shared_library, tool};

/// As the Makefile has it: before 1.0 a minor version may break what was, later only a major one may.
fn series() -> String {
    match (env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR")) {
        ("0", minor) => format!("0.{minor}"),
        (major, _) => major.to_owned(),
    }
}

fn recorded_path() -> PathBuf {
    root().join(format!("packaging/abi/fixpair-{}.abi", series()))
}

static DECLARATIONS: LazyLock<Vec<Declaration>> = LazyLock::new(|| read(&HEADER));

/// The functions that the header declares, with the macro that hides each, if any.
pub(crate) fn functions() -> impl Iterator<Item = (&'static Named, Option<&'static str>)> {
    DECLARATIONS.iter().filter_map(|declaration| match &declaration.item {
        Item::Function(function) => Some((function, declaration.hidden_by.as_deref())),
        _ => None,
    })
}

/// Their names.
pub(crate) fn declared() -> BTreeSet<String> {
    functions().map(|(function, _)| function.name.clone()).collect()
}

/// Those of a library without threads and matrices.
pub(crate) fn kernels() -> BTreeSet<String> {
    functions()
        .filter(|(_, hidden_by)| hidden_by.is_none())
        .map(|(function, _)| function.name.clone())
        .collect()
}

/// A program in C and C++ that prints what the compiler makes of constants and structs.
fn program() -> String {
    let mut includes = "#include <stddef.h>\n#include <stdio.h>\n#include \"fixpair.h\"\n".to_owned();
    let mut body = String::new();
    for Declaration { item, .. } in DECLARATIONS.iter() {
        match item {
            Item::Constant { name, real } => {
                let (format, cast) = if *real { ("%.17g", "double") } else { ("%lld", "long long") };
                body.push_str(&format!("printf(\"constant {name} = {format}\\n\", ({cast}){name});\n"));
            }
            Item::Struct { name, members } => {
                includes.push_str(&format!("struct aligned_{name} {{ char before; {name} it; }};\n"));
                body.push_str(&format!(
                    "printf(\"struct {name} = %lu bytes, aligned to %lu\\n\", (unsigned long)sizeof({name}), \
                     (unsigned long)offsetof(struct aligned_{name}, it));\n"
                ));
                for Named { name: member, kind } in members {
                    body.push_str(&format!(
                        "printf(\"member {name}.{member} = {kind}, %lu bytes at %lu\\n\", \
                         (unsigned long)sizeof((({name} *)0)->{member}), (unsigned long)offsetof({name}, {member}));\n"
                    ));
                }
            }
            _ => {}
        }
    }
    format!("{includes}int main(void) {{\n{body}return 0;\n}}\n")
}

/// A folder with the header and this program in both languages.
static SOURCES: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = folder().join("abi");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    for (name, text) in [("fixpair.h", &*HEADER), ("layout.c", &program()), ("layout.cpp", &program())] {
        std::fs::write(folder.join(name), text).expect("the target folder can be written");
    }
    folder
});

/// What such a program prints.
fn layout_by(variable: &str, default: &str, standard: &str, source: &str) -> String {
    let program = SOURCES.join(format!("{source}.program"));
    run(tool(variable, default).args([standard, "-o"]).arg(&program).arg(SOURCES.join(source)));
    String::from_utf8(run(&mut Command::new(program)).stdout).expect("text")
}

static LAYOUT: LazyLock<String> = LazyLock::new(|| layout_by("CC", "cc", "-std=c99", "layout.c"));

fn description() -> String {
    let mut text = format!(
        "# What programs compiled against fixpair {} rely on, where a pointer has 8 bytes. Generated from include/fixpair.h and a C compiler:\n\
         # FIXPAIR_BLESS=1 cargo test --test ffi abi\n",
        series()
    );
    text.push_str(&LAYOUT);
    for Declaration { item, .. } in DECLARATIONS.iter() {
        match item {
            Item::Alias { name, of } => text.push_str(&format!("type {name} = {of}\n")),
            Item::Opaque { name } => text.push_str(&format!("type {name} = opaque\n")),
            _ => {}
        }
    }
    for (Named { name, kind }, hidden_by) in functions() {
        let unless = hidden_by.map_or_else(String::new, |by| format!(" unless {by}"));
        text.push_str(&format!("function {name} = {kind}{unless}\n"));
    }
    text
}

/// Lines `what name = meaning`.
fn facts(description: &str) -> BTreeMap<&str, &str> {
    let lines = description.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split_once(" = ").unwrap_or_else(|| panic!("no fact: {line}"))).collect()
}

/// How a description differs from an earlier one.
#[derive(Default)]
struct Difference {
    added: Vec<String>,
    broken: Vec<String>,
}

fn compare(earlier: &str, later: &str) -> Difference {
    let (earlier, later) = (facts(earlier), facts(later));
    let mut difference = Difference::default();
    for (name, was) in &earlier {
        match later.get(name) {
            None => difference.broken.push(format!("{name} is gone: it was {was}")),
            Some(is) if is != was => difference.broken.push(format!("{name} was {was}, is {is}")),
            Some(_) => {}
        }
    }
    let new = later.iter().filter(|(name, _)| !earlier.contains_key(*name));
    difference.added.extend(new.map(|(name, is)| format!("{name} = {is}")));
    difference
}

fn is_released() -> bool {
    let changes = std::fs::read_to_string(root().join("CHANGELOG.md")).expect("CHANGELOG.md");
    changes.contains(&format!("\n## [{}.", series()))
}

#[test]
#[cfg_attr(not(target_pointer_width = "64"), ignore = "the description is that of 8-byte pointers")]
fn the_interface_is_as_recorded() {
    let path = recorded_path();
    let now = description();
    let recorded = std::fs::read_to_string(&path).unwrap_or_default();
    let Difference { added, broken } = compare(&recorded, &now);
    let must_hold = !broken.is_empty() && is_released();
    if std::env::var_os("FIXPAIR_BLESS").is_some() && !must_hold {
        std::fs::write(&path, &now).expect("packaging/abi can be written");
        return;
    }
    assert!(
        broken.is_empty(),
        "programs compiled against fixpair {series} would break:\n  {}\n{}",
        broken.join("\n  "),
        if must_hold {
            "Restore it and add a function or struct beside it; or raise the version in Cargo.toml to the next series, say so under ABI in \
             CHANGELOG.md, and record that series with FIXPAIR_BLESS=1 cargo test --test ffi abi"
        } else {
            "No version of this series is released, so it may: say so in CHANGELOG.md and record it with FIXPAIR_BLESS=1 cargo test --test ffi abi"
        },
        series = series(),
    );
    assert!(
        added.is_empty(),
        "new, and harmless to programs that exist:\n  {}\nRecord it: FIXPAIR_BLESS=1 cargo test --test ffi abi",
        added.join("\n  ")
    );
    assert!(
        recorded == now,
        "{} has the same facts in another order: FIXPAIR_BLESS=1 cargo test --test ffi abi",
        path.display()
    );
}

#[test]
fn additions_are_told_from_what_breaks_programs() {
    let earlier =
        "# a comment\nstruct s = 8 bytes\nmember s.a = double, 8 bytes at 0\nfunction f = void(void)\n";
    let later = "member s.a = float, 4 bytes at 0\nstruct s = 8 bytes\nfunction g = void(size_t)\n";
    let Difference { added, broken } = compare(earlier, later);
    assert_eq!(added, ["function g = void(size_t)"]);
    let expected = [
        "function f is gone: it was void(void)",
        "member s.a was double, 8 bytes at 0, is float, 4 bytes at 0",
    ];
    assert_eq!(broken, expected);
    let Difference { added, broken } = compare(earlier, earlier);
    assert!(added.is_empty() && broken.is_empty());
}

#[test]
fn rust_and_c_lay_out_every_struct_alike() {
    // Types of members are C's alone.
    let without_type = |line: &str| match line.split_once(" = ") {
        Some((member, rest)) if member.starts_with("member ") => {
            format!("{member} = {}", rest.rsplit_once(", ").expect("a type, then bytes").1)
        }
        _ => line.to_owned(),
    };
    let c: Vec<_> = LAYOUT.lines().filter(|line| !line.starts_with("constant ")).map(without_type).collect();
    assert!(c.len() > 200, "the header was read");
    assert_eq!(layouts(), c);
}

#[test]
fn cpp_and_c_lay_out_every_struct_alike() {
    let required = std::env::var_os("FIXPAIR_REQUIRE_CXX").is_some();
    if !required && tool("CXX", "c++").arg("--version").output().is_err() {
        println!("skipped: no C++ compiler (c++ or CXX)");
        return;
    }
    assert_eq!(*LAYOUT, layout_by("CXX", "c++", "-std=c++11", "layout.cpp"));
}

/// Symbols that a library defines, in its dynamic table or, of a static one, in any.
fn defined(library: &Path, options: &[&str]) -> BTreeSet<String> {
    let output = run(Command::new("nm").args(options).arg(library));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    // "address letter name"; capital letters are global symbols, but for absolute ones.
    let symbols = text.lines().filter_map(|line| {
        let words: Vec<_> = line.split_whitespace().collect();
        (words.len() == 3 && words[1] != "A").then(|| words[2].to_owned())
    });
    symbols.collect()
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "other systems have other tables and prefixes of symbols")]
fn the_shared_library_exports_what_the_header_declares_and_nothing_else() {
    let exported = defined(&shared_library(), &["-D", "--defined-only", "--extern-only"]);
    assert_eq!(exported, declared());
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "other systems have other prefixes of symbols")]
fn a_library_without_features_lacks_what_the_macros_of_the_header_hide() {
    let symbols = defined(&FREESTANDING.join("libfixpair.a"), &["--defined-only", "--extern-only"]);
    let symbols: BTreeSet<_> = symbols.into_iter().filter(|symbol| symbol.starts_with("fixpair_")).collect();
    let hidden: BTreeSet<_> = functions().filter_map(|(_, hidden_by)| hidden_by).collect();
    assert_eq!(hidden, BTreeSet::from(["FIXPAIR_NO_LINALG", "FIXPAIR_NO_THREADS"]));
    assert_eq!(symbols, kernels());
}
