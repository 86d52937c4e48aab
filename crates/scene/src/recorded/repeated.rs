//! Warning of rows that are there twice.

use std::collections::HashSet;

use super::origin::Origin;
use super::stated::row;

/// Warning of readings that say the same as one before them to the last digit, each as its numbers, where they are at least this
/// share of all.
pub(super) fn repeated<const N: usize>(
    origin: &Origin,
    what: &str,
    readings: impl Iterator<Item = [f64; N]>,
    share: f64,
) -> Option<String> {
    // Adding 0 makes −0 what it equals.
    let bits = |numbers: [f64; N]| numbers.map(|number| (number + 0.0).to_bits());
    let (mut known, mut again, mut all) = (HashSet::new(), Vec::new(), 0.0);
    for (place, numbers) in readings.enumerate() {
        all += 1.0;
        if !known.insert(bits(numbers)) {
            again.push(place);
        }
    }
    if (again.len() as f64) < share * all {
        return None;
    }
    let first = row(*again.first()?, origin);
    let rows = match again.len() {
        1 => format!("{first} repeats a {what} of a row"),
        count => format!("{count} rows, the first of them {first}, repeat {what}s of rows"),
    };
    Some(format!(
        "{rows} before to the last digit: copies are no new readings, and make the stated uncertainty too small"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_told_and_repeated_measurements_are_not() {
        let origin = Origin::File {
            name: "r.csv".to_owned(),
            lines: vec![2, 3, 5, 6],
        };
        let told = |rows: &[[f64; 2]]| repeated(&origin, "marker", rows.iter().copied(), 0.0);
        assert_eq!(told(&[[0.0, 1.0], [0.0, 1.1], [1.0, 1.0]]), None);
        let one = told(&[[0.0, 1.0], [2.0, 3.0], [-0.0, 1.0]]).unwrap();
        assert!(
            one.starts_with("row 3, line 5 repeats a marker of a row before to the last digit")
        );
        let two = told(&[[0.0; 2], [0.0; 2], [1.0; 2], [0.0; 2]]).unwrap();
        let rows = "2 rows, the first of them row 2, line 3, repeat markers of rows before";
        assert!(two.starts_with(rows), "{two}");
    }
}
