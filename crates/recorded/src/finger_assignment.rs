//! Assigns contacts to fingers if the file does not contain finger numbers.

use nalgebra::Point3;
use palpate_statistics::Number;

/// Smallest length of a step (from one contact to the next) that can separate two fingers, relative to the median
/// length of all steps.
const MIN_JUMP: f64 = 3.0;
/// Smallest accepted ratio of the shortest step between two fingers to the longest step within a finger. The noise of
/// dense contacts makes some steps within a finger longer than [`MIN_JUMP`]. So the shortest step between two fingers is
/// the first step that is longer than the next shorter one by this ratio.
const MIN_JUMP_RATIO: f64 = 1.5;
/// Advice to the user if the assignment of contacts to fingers is wrong. It ends every note about the assignment.
const REMEDY: &str = "separate the fingers by blank lines or add a column `finger`";

/// Returns the index of the finger of each contact, and a note on how the fingers were determined. If the file has
/// blank lines, these separate the fingers; `after_gaps` contains the rows that follow a blank line. Otherwise, the
/// fingers are separated by steps that are much longer than all other steps.
pub(super) fn assign_fingers(
    places: &[Point3<f64>],
    after_gaps: &[usize],
    unit: &str,
) -> (Vec<usize>, String) {
    if !after_gaps.is_empty() {
        let (fingers, count) = parted(places.len(), after_gaps);
        let note = format!(
            "no column `finger`, so the fingers are separated by blank lines: {count} fingers"
        );
        return (fingers, note);
    }
    let steps = places.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    let steps: Vec<f64> = steps.collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let first = sorted.partition_point(|step| *step <= MIN_JUMP * median);
    let candidates = first..sorted.partition_point(|step| step.is_finite());
    let is_long = |&step: &usize| sorted[step] >= MIN_JUMP_RATIO * sorted[step - 1];
    let one = |why: String| {
        let note =
            format!("no column `finger`: all contacts are treated as one finger{why}; {REMEDY}");
        (vec![0; places.len()], note)
    };
    let rounded = |step: usize| [step, step - 1].map(|step| Number::rounded(sorted[step]));
    match candidates.clone().find(is_long) {
        _ if median <= 0.0 || candidates.is_empty() => one(String::new()),
        None => {
            let [shortest, longest] = rounded(first);
            one(format!(
                ", because no step is much longer than all others (the shortest candidate is {shortest} {unit}, the longest other step {longest} {unit})"
            ))
        }
        Some(jump) => {
            let long = sorted[jump]..f64::INFINITY;
            let is_jump = |row: &usize| long.contains(&steps[row - 1]);
            let jumps: Vec<usize> = (1..places.len()).filter(is_jump).collect();
            let (fingers, count) = parted(places.len(), &jumps);
            let [shortest, longest] = rounded(jump);
            let note = format!(
                "no column `finger`, so the fingers are separated by steps of at least {shortest} {unit}: {count} fingers; all other steps are at most {longest} {unit}; {REMEDY}"
            );
            (fingers, note)
        }
    }
}

/// Divides `rows` rows into parts. `starts` contains the first row of every part except the first. Returns the index of
/// each row's part, and the number of parts.
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
