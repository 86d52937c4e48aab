//! Tests the glossary and the names of quantities.

use std::collections::BTreeSet;

use palpate_study::glossary::{SUBJECTS, meaning, similar};

#[test]
fn every_word_has_one_meaning_in_sentences() {
    let mut known = BTreeSet::new();
    for term in SUBJECTS.iter().flat_map(|subject| subject.terms) {
        assert!(
            known.insert(term.name.replace('_', "-")),
            "{} occurs twice",
            term.name
        );
    }
    for term in SUBJECTS.iter().flat_map(|subject| subject.terms) {
        assert!(meaning(term.name).is_some(), "{}", term.name);
        assert!(
            term.meaning.ends_with('.'),
            "{}: {}",
            term.name,
            term.meaning
        );
        assert!(
            !term.meaning.contains("  "),
            "{}: {}",
            term.name,
            term.meaning
        );
    }
}

#[test]
fn words_in_any_writing() {
    for word in ["not-rolling", "Not Rolling", "not_rolling", " NOT-ROLLING "] {
        assert_eq!(meaning(word).map(|term| term.name), Some("not-rolling"));
    }
    assert_eq!(meaning(""), None);
    assert_eq!(similar("not-roling").first(), Some(&"not-rolling"));
    assert!(similar("rung?").contains(&"rung"));
    assert!(similar("knots").contains(&"knots-exhausted"));
    assert!(similar("").len() <= 5);
    assert!(similar("zzzzzz").is_empty());
}
