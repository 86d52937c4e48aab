//! Answers keep their word: the part that takes seconds. `cargo xtask answers` asks all.

use palpate_assay::answers::{Options, check, scores};

#[test]
fn answers_of_rolls_on_cylinders_are_right() {
    let options = Options {
        seeds: 5,
        pairs: 100_000,
        only: "cylinder",
        is_quick: true,
    };
    let scores = scores(options, |_| ()).unwrap();
    assert!(check(&scores).is_ok(), "{scores:?}");
    let cases = |command: &str| {
        let of = scores.iter().filter(|score| score.command == command);
        of.map(|score| score.cases).sum::<u64>()
    };
    assert_eq!((cases("design"), cases("distinguish")), (5, 5));
}
