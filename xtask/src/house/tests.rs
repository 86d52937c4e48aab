use std::collections::BTreeSet;
use std::fs;

use tempfile::TempDir;

use super::circles::{Circle, circles};
use super::crates;
use super::packages::Package;
use super::tree::Tree;

/// A directory with the files, and the circles of the library that begins in `lib.rs`.
fn found(files: &[(&str, &str)]) -> (TempDir, Vec<Circle>) {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = directory.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let mut tree = Tree::default();
    let root = directory.path().join("lib.rs");
    tree.add_root(&root, Some("house")).unwrap();
    if files.iter().any(|(name, _)| *name == "main.rs") {
        let root = directory.path().join("main.rs");
        tree.add_root(&root, None).unwrap();
    }
    let circles = circles(&tree);
    (directory, circles)
}

/// Lines such as `a.rs -> b.rs by Name` of all circles.
fn imports(files: &[(&str, &str)]) -> Vec<String> {
    let (directory, circles) = found(files);
    let texts = circles.iter().map(|circle| circle.text(directory.path()));
    let lines: Vec<String> = texts
        .flat_map(|text| text.lines().map(str::to_string).collect::<Vec<_>>())
        .collect();
    let imports = lines.iter().filter(|line| line.contains("->"));
    imports.map(|line| line.trim().to_string()).collect()
}

/// Imports of `a.rs` from `b.rs`, made a circle by `b.rs` that names `crate::a::A`.
fn imports_of_a(lib: &str, a: &str, more: &[(&str, &str)]) -> Vec<String> {
    let a = format!("pub struct A;\n{a}");
    let mut files = vec![
        ("lib.rs", lib),
        ("a.rs", &a),
        (
            "b.rs",
            "pub struct B; pub enum E { One } pub fn b(_: crate::a::A) {}",
        ),
    ];
    files.extend(more);
    let mut imports = imports(&files);
    imports.retain(|import| import.starts_with("a.rs"));
    imports
}

const BOTH: &str = "mod a; mod b;";

#[test]
fn two_files_that_import_each_other_are_a_circle() {
    let (directory, circles) = found(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "use crate::a::A; pub struct B;"),
        ("c.rs", "use crate::a::A; use crate::b::B;"),
    ]);
    assert_eq!(circles.len(), 1);
    assert_eq!(
        circles[0].text(directory.path()),
        "  a.rs\n  b.rs\n    a.rs -> b.rs by B\n    b.rs -> a.rs by A"
    );
}

#[test]
fn three_files_in_a_row_are_none_and_in_a_ring_one() {
    let lib = ("lib.rs", "mod a; mod b; mod c;");
    let a = ("a.rs", "use crate::b::B; pub struct A;");
    let b = ("b.rs", "use crate::c::C; pub struct B;");
    let row = [lib, a, b, ("c.rs", "pub struct C;")];
    assert!(found(&row).1.is_empty());
    let ring = [lib, a, b, ("c.rs", "pub struct C(crate::a::A);")];
    let circles = found(&ring).1;
    assert_eq!(circles.len(), 1);
    assert_eq!(circles[0].files.len(), 3);
}

#[test]
fn reexports_lead_to_the_file_that_defines() {
    let through = [
        ("mod a; mod b; pub use b::B;", "use crate::B;"),
        ("mod a; mod b; pub use self::b::B;", "use super::B;"),
        ("mod a; mod b; pub use b::*;", "use crate::B;"),
        ("mod a; mod b; use b as house;", "use crate::house::B;"),
        ("mod a; mod b; use b::B as C;", "use crate::C as D;"),
        (
            "mod a; mod b; pub mod c { pub use super::b::B; }",
            "use crate::c::B;",
        ),
    ];
    for (lib, a) in through {
        assert_eq!(imports_of_a(lib, a, &[]), ["a.rs -> b.rs by B"], "{lib}");
    }
}

#[test]
fn a_parent_does_not_import_what_it_hands_on() {
    let files = [
        (
            "lib.rs",
            "mod a; pub use a::A; pub use self::a::a; pub struct L;",
        ),
        (
            "a.rs",
            "use crate::L; pub struct A(L); pub fn a(_: super::L) {}",
        ),
    ];
    assert!(imports(&files).is_empty());
    let named = ("lib.rs", "mod a; pub use a::A; pub struct L(A);");
    assert_eq!(
        imports(&[named, files[1]]),
        ["a.rs -> lib.rs by L", "lib.rs -> a.rs by A"]
    );
}

#[test]
fn a_function_may_be_named_as_its_module() {
    let files = [
        ("lib.rs", "mod a; mod path; pub(crate) use path::path;"),
        ("a.rs", "pub struct A; fn f() { super::path() }"),
        ("path.rs", "pub fn path() -> crate::a::A { crate::a::A }"),
    ];
    assert_eq!(
        imports(&files),
        ["a.rs -> path.rs by path", "path.rs -> a.rs by A"]
    );
}

#[test]
fn self_and_super_are_followed() {
    let below = [
        (
            "a/c.rs",
            "use super::super::b::B; use super::A; pub struct C;",
        ),
        ("a/d.rs", "pub struct D;"),
    ];
    let files = |a: &'static str| {
        let mut files = vec![
            ("lib.rs", BOTH),
            ("a.rs", a),
            ("b.rs", "use crate::a::A; pub struct B;"),
        ];
        files.extend(below);
        imports(&files)
    };
    let a = "mod c; mod d; use self::c::C; use self::d::D; pub struct A;";
    assert_eq!(
        files(a),
        [
            "a/c.rs -> a.rs by A",
            "a/c.rs -> b.rs by B",
            "a.rs -> a/c.rs by C",
            "b.rs -> a.rs by A"
        ]
    );
}

#[test]
fn inline_paths_are_imports() {
    let inline = [
        "fn f() { let _ = crate::b::B; }",
        "fn f(_: &[super::b::B]) {}",
        "fn f(x: A) { if let crate::b::B { .. } = x {} }",
        "impl From<crate::b::B> for A {}",
        "fn f() { assert_eq!(crate::b::B, 1); }",
        "fn f() { let _ = vec![crate::b::B; 3]; }",
        "#[arg(value_parser = crate::b::B)] struct S;",
        "#[serde(with = \"crate::b::B\")] struct S;",
        "fn f() { use crate::b; let _ = b::B; }",
        "fn f(b: u8) { crate::b::B(b) }",
        "macro_rules! m { () => { $crate::b::B } }",
        "mod inner { fn f(_: super::super::b::B) {} }",
    ];
    for a in inline {
        assert_eq!(imports_of_a(BOTH, a, &[]), ["a.rs -> b.rs by B"], "{a}");
    }
}

#[test]
fn variants_are_imports_of_their_type() {
    for a in ["use crate::b::E::One;", "use crate::b::E::*;"] {
        assert_eq!(imports_of_a(BOTH, a, &[]), ["a.rs -> b.rs by E"], "{a}");
    }
}

#[test]
fn a_glob_imports_what_is_named_of_it() {
    let named = "use crate::b::*; fn f(_: B) {}";
    assert_eq!(imports_of_a(BOTH, named, &[]), ["a.rs -> b.rs by B"]);
    let unnamed = "use crate::b::*; fn f(b: u8) -> u8 { let c = |b: u8| b; c(b) }";
    assert!(imports_of_a(BOTH, unnamed, &[]).is_empty());
}

#[test]
fn what_only_tests_import_is_left_out() {
    let only = [
        "#[cfg(test)] use crate::b::B;",
        "#[cfg(test)] mod tests { use crate::b::B; }",
        "#[cfg(test)] mod tests;",
        "#[cfg(all(test, feature = \"x\"))] fn f(_: crate::b::B) {}",
        "impl A { #[cfg(test)] fn f(_: crate::b::B) {} }",
    ];
    let tests = [("a/tests.rs", "use crate::b::B;")];
    for a in only {
        assert!(imports_of_a(BOTH, a, &tests).is_empty(), "{a}");
    }
    let not = "#[cfg(not(test))] use crate::b::B;";
    assert_eq!(imports_of_a(BOTH, not, &[]), ["a.rs -> b.rs by B"]);
}

#[test]
fn another_crates_names_are_no_imports() {
    let other = "use ::b::B; use std::b; pub use rand::b::E; fn f(_: rand::B) { b::B }";
    assert!(imports_of_a(BOTH, other, &[]).is_empty());
    let lib = "mod a; mod b; pub use rand::B;";
    assert!(imports_of_a(lib, "use crate::B;", &[]).is_empty());
}

#[test]
fn a_program_imports_its_library() {
    let files = [
        ("lib.rs", "mod a; pub use a::A;"),
        ("a.rs", "pub struct A; use crate::B;"),
        ("main.rs", "mod b; use house::A;"),
        ("b.rs", "use crate::A;"),
    ];
    // A name that its module does not show is taken to be made there by a macro.
    assert!(imports(&files).is_empty());
    let back = ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;");
    let b = ("b.rs", "use house::A; pub struct B;");
    assert_eq!(
        imports(&[back, files[1], b]),
        ["a.rs -> b.rs by B", "b.rs -> a.rs by A"]
    );
}

#[test]
fn a_forbidden_import_of_a_crate_is_named() {
    let package = |name: &str, imports: &[&str]| Package {
        name: name.to_string(),
        roots: Vec::new(),
        imports: imports
            .iter()
            .map(|import| import.to_string())
            .collect::<BTreeSet<_>>(),
    };
    let packages = [
        package("palpate-ep1", &["palpate-geometry", "palpate-tally"]),
        package("palpate-press", &["palpate-sensing"]),
        package("palpate", &["palpate-scene", "palpate-assay"]),
        package("palpate-fuzz", &["palpate-scene", "palpate-geometry"]),
        package("xtask", &["palpate-tally"]),
        package("palpate-new", &[]),
    ];
    assert_eq!(
        crates::faults(&packages),
        [
            "crate press imports sensing; it may import tally, number, chance",
            "crate palpate imports assay; it may import study, scene, sweep, report, tally, number, chance",
            "crate xtask imports tally; it may import nothing",
            "crate new is not in the table of crates",
        ]
    );
}
