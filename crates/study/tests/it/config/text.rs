//! Tests config files and texts: encodings, line ends, and excerpts of unusual lines.

use super::{BASE, edited, error, study};
use palpate_study::config::{load, parse};

#[test]
fn a_byte_order_mark_and_crlf_change_nothing() {
    let plain = parse("study.toml", BASE).unwrap();
    let windows = format!("\u{feff}{}", BASE.replace('\n', "\r\n"));
    let same = parse("study.toml", &windows).unwrap();
    assert!(same.cells().eq(plain.cells()));
    assert_eq!(
        error(&windows.replace("5.0", "-5.0")),
        error(&BASE.replace("5.0", "-5.0")),
    );
}

#[test]
fn the_caret_is_under_its_column() {
    let text = edited("object = {", "object\t=\t{");
    let said = error(&text.replace("\"sphere\", radius = 5.0", "\"Größe→∞\"")).to_string();
    let excerpt = "  |\n7 | object\t=\t{ kind = \"Größe→∞\" }\n  |       \t \t         ^^^^^^^^^";
    assert!(
        said.starts_with("study.toml:7:19: ") && said.ends_with(excerpt),
        "{said}"
    );
    let at_the_end = error("name = ").to_string();
    assert!(
        at_the_end.ends_with("\n  |\n1 | name = \n  |        ^"),
        "{at_the_end}"
    );
}

#[test]
fn long_lines_are_cut_around_the_caret() {
    let count =
        |range: std::ops::Range<u32>| range.map(|value| format!("{value}, ")).collect::<String>();
    let list = format!("[{}-1, {}]", count(1..999), count(1000..2000));
    let text = format!("{BASE}[[sweep]]\npath = \"scene.probe.radius\"\nvalues = {list}\n");
    let message = error(&text).to_string();
    let lines: Vec<&str> = message.lines().collect();
    assert!(
        lines.iter().all(|line| line.chars().count() < 140),
        "{message}"
    );
    let caret = lines[3].chars().position(|c| c == '^').unwrap();
    let shown: String = lines[2].chars().skip(caret).take(2).collect();
    assert_eq!(shown, "-1", "{message}");
}

#[test]
fn files_are_named_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, place, words) in [
        ("", &b""[..], ": ", "directory"),
        ("absent.toml", b"", ": ", "no such file"),
        (
            "latin1.toml",
            b"name = \"a\"\ntitle = \"gr\xf6\xdfe\"\n",
            ": ",
            "byte 0xf6 in line 2",
        ),
        (
            "bad.toml",
            b"name = \"A\"\n[scene]\n",
            ":1:8: name: ",
            "is not a name",
        ),
    ] {
        let path = folder.path().join(name);
        if !bytes.is_empty() {
            std::fs::write(&path, bytes).unwrap();
        }
        let said = load(&path).unwrap_err().to_string();
        assert!(
            said.starts_with(&format!("{}{place}", path.display())),
            "{said}"
        );
        assert!(said.contains(words), "{said}");
    }
    std::fs::write(folder.path().join("study.toml"), BASE).unwrap();
    let study = load(&folder.path().join("study.toml")).unwrap();
    assert_eq!(study.config.name, "a-study");
}

#[test]
fn errors_about_values_that_a_program_sets_name_no_line() {
    for value in [-3.0, 0.0, f64::INFINITY] {
        let values = vec![5.0.into(), value.into()];
        let error = study("").varied(&[("scene.object.radius".to_owned(), values)]);
        let error = error.expect_err("out of its limits");
        assert_eq!(error.path, "scene.object.radius");
        let said = error.to_string();
        assert!(
            said.starts_with("study.toml: ") && !said.contains(" | "),
            "{said}"
        );
    }
}
