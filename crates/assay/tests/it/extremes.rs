use palpate_assay::extremes::{Case, cases};

#[test]
fn no_extreme_breaks_a_promise() {
    let broken: Vec<String> = cases()
        .into_iter()
        .map(Case::judge)
        .filter(|row| row.verdict.is_broken())
        .map(|row| {
            format!(
                "{} at {}: {:?} {:?}",
                row.entry, row.input, row.verdict, row.outcome
            )
        })
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
