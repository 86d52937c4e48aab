//! Assigns contacts to fingers if the file does not name the fingers.

use nalgebra::Point3;
use palpate_statistics::Number;

/// A step longer than this many median steps leads to another finger.
const JUMP: f64 = 3.0;
/// Smallest ratio of the shortest jump to the longest step within a finger.
const APART: f64 = 1.5;

/// Finger of each contact, and a note on how it was found. Blank lines, before the rows `after_gaps`, separate the
/// fingers. Without blank lines, steps that are much longer than all others separate them.
pub(super) fn told_apart(
    places: &[Point3<f64>],
    after_gaps: &[usize],
    unit: &str,
) -> (Vec<usize>, String) {
    if !after_gaps.is_empty() {
        let (fingers, count) = parted(places.len(), after_gaps);
        let note = format!("no column `finger`: blank lines separate {count} fingers");
        return (fingers, note);
    }
    let steps: Vec<f64> = places
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let is_jump = |step: &f64| *step > JUMP * median && step.is_finite();
    let others = sorted.iter().filter(|step| !is_jump(step));
    let longest = others.fold(0.0, |most: f64, &step| most.max(step));
    let shortest = sorted.iter().find(|step| is_jump(step)).copied();
    const REMEDY: &str = "separate the fingers by blank lines or add a column `finger`";
    let one = |why: String| {
        let note =
            format!("no column `finger`: all contacts count as of one finger{why}; {REMEDY}");
        (vec![0; places.len()], note)
    };
    match shortest {
        None => one(String::new()),
        Some(_) if median <= 0.0 => one(String::new()),
        Some(shortest) if shortest < APART * longest => {
            let [shortest, longest] = [shortest, longest].map(Number::rounded);
            one(format!(
                ", for no step is much longer than all others ({shortest} {unit} after {longest} {unit})"
            ))
        }
        Some(shortest) => {
            let jumps = steps.iter().zip(1..);
            let jumps: Vec<usize> = jumps
                .filter_map(|(step, row)| is_jump(step).then_some(row))
                .collect();
            let (fingers, count) = parted(places.len(), &jumps);
            let [shortest, longest] = [shortest, longest].map(Number::rounded);
            let note = format!(
                "no column `finger`: {count} fingers are told by steps of at least {shortest} {unit}, where all others are at \
                 most {longest} {unit}; {REMEDY}"
            );
            (fingers, note)
        }
    }
}

/// Index of the part that each of `rows` rows belongs to, and the number of parts. Parts begin at the rows `starts`.
pub(super) fn parted(rows: usize, starts: &[usize]) -> (Vec<usize>, usize) {
    let mut part = 0;
    let mut starts = starts.iter().filter(|&&start| start > 0).peekable();
    let numbers = (0..rows)
        .map(|row| {
            if starts.next_if(|&&start| start == row).is_some() {
                part += 1;
            }
            part
        })
        .collect();
    (numbers, part + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(finger: f64, contacts: u32, step: f64) -> impl Iterator<Item = Point3<f64>> {
        (0..contacts).map(move |contact| Point3::new(step * f64::from(contact), finger, 0.0))
    }

    fn fingers(places: &[Point3<f64>], gaps: &[usize]) -> (Vec<usize>, String) {
        told_apart(places, gaps, "mm")
    }

    #[test]
    fn jumps_part_fingers() {
        let three: Vec<_> = [0.0, 10.0, 20.0]
            .into_iter()
            .flat_map(|finger| line(finger, 5, 3.0))
            .collect();
        let (found, note) = fingers(&three, &[]);
        assert_eq!(found, [0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2]);
        assert!(
            note.contains("3 fingers are told by steps of at least"),
            "{note}"
        );
        assert!(note.contains("at most 3 mm"), "{note}");
    }

    #[test]
    fn blank_lines_come_first() {
        let one: Vec<_> = line(0.0, 4, 1.0).collect();
        let (found, note) = fingers(&one, &[2]);
        assert_eq!(found, [0, 0, 1, 1]);
        assert_eq!(note, "no column `finger`: blank lines separate 2 fingers");
    }

    #[test]
    fn what_does_not_tell_is_one_finger() {
        let steady: Vec<_> = line(0.0, 6, 1.0).collect();
        assert_eq!(fingers(&steady, &[]).0, [0; 6]);
        // The steps grow gradually: no gap separates long steps from short ones.
        let growing = [0.0, 1.0, 2.0, 3.0, 5.0, 8.0, 12.0].map(|x| Point3::new(x, 0.0, 0.0));
        let (found, note) = fingers(&growing, &[]);
        assert_eq!(found, [0; 7]);
        assert!(note.contains("one finger"), "{note}");
        let same = [Point3::origin(); 4];
        assert_eq!(fingers(&same, &[]).0, [0; 4]);
        assert_eq!(fingers(&[], &[]).0, [0; 0]);
        assert_eq!(fingers(&same[..1], &[]).0, [0]);
        let huge = [0.0, 1.0, 2.0, 1e308, -1e308].map(|x| Point3::new(x, 0.0, 0.0));
        let (_, note) = fingers(&huge, &[]);
        assert!(!note.contains("inf") && !note.contains("NaN"), "{note}");
    }
}
