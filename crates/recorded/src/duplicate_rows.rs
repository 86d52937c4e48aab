//! Warning of repeated rows.

use std::collections::HashSet;

use super::consistency::row;
use super::source::ReadingSource;

/// Warning of readings that repeat all numbers of an earlier one, if they are at least `share` of all readings.
pub(super) fn repeated<const N: usize>(
    origin: &ReadingSource,
    what: &str,
    readings: impl Iterator<Item = [f64; N]>,
    share: f64,
) -> Option<String> {
    // Adding 0 turns −0 into 0.
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
        1 => format!("{first} repeats the {what} of an earlier row"),
        count => format!("{count} rows, the first of them {first}, repeat {what}s of earlier rows"),
    };
    Some(format!(
        "{rows} to the last digit: copies are not new readings, and make the stated uncertainty too small"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_told_and_repeated_measurements_are_not() {
        let origin = ReadingSource::File {
            name: "r.csv".to_owned(),
            lines: vec![2, 3, 5, 6],
        };
        let told = |rows: &[[f64; 2]]| repeated(&origin, "marker", rows.iter().copied(), 0.0);
        assert_eq!(told(&[[0.0, 1.0], [0.0, 1.1], [1.0, 1.0]]), None);
        let one = told(&[[0.0, 1.0], [2.0, 3.0], [-0.0, 1.0]]).unwrap();
        assert!(
            one.starts_with("row 3, line 5 repeats the marker of an earlier row to the last digit")
        );
        let two = told(&[[0.0; 2], [0.0; 2], [1.0; 2], [0.0; 2]]).unwrap();
        let rows = "2 rows, the first of them row 2, line 3, repeat markers of earlier rows";
        assert!(two.starts_with(rows), "{two}");
    }
}
