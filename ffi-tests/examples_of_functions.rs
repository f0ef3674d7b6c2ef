//! Every public function of the Rust interface has an example that runs.

use std::collections::BTreeSet;
use std::path::Path;

use crate::native::root;

/// What a public function begins with.
const PUBLIC: [&str; 4] = ["pub fn ", "pub const fn ", "pub unsafe fn ", "pub const unsafe fn "];

fn name(line: &str) -> Option<&str> {
    let rest = PUBLIC.iter().find_map(|start| line.strip_prefix(start))?;
    rest.split(['(', '<']).next()
}

/// Adds the functions of a file, with and without an example in their documentation, the latter as `room/file.rs name`.
fn read(file: &Path, room: &str, with: &mut usize, without: &mut BTreeSet<String>) {
    let text = std::fs::read_to_string(file).expect("a source");
    let mut example = false;
    for line in text.lines().map(str::trim_start) {
        if line.starts_with("///") {
            example |= line.contains("```");
        } else if let Some(name) = name(line) {
            if example {
                *with += 1;
            } else {
                without.insert(format!("{room} {name}"));
            }
            example = false;
        } else if !line.starts_with("#[") {
            example = false;
        }
    }
}

/// Walks the rooms that a Rust program calls: not the C interface, the references, nor tests.
fn walk(folder: &Path, room: &str, with: &mut usize, without: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).expect("src").map(|entry| entry.expect("an entry").path()) {
        let own = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let path = if room.is_empty() { own.clone() } else { format!("{room}/{own}") };
        if own.starts_with("tests") || path == "capi" || path == "reference" {
            continue;
        }
        if entry.is_dir() {
            walk(&entry, &path, with, without);
        } else {
            read(&entry, &path, with, without);
        }
    }
}

#[test]
fn every_public_function_has_an_example() {
    let (mut with, mut without) = (0, BTreeSet::new());
    walk(&root().join("src"), "", &mut with, &mut without);
    assert!(without.is_empty(), "an example is missing, as a code block in the documentation: {without:#?}");
    assert!(with > 300, "only {with} public functions were found");
}
