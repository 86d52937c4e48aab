//! Interprets the name of a single column (its unit, and the columns of palpate that the name may mean) and the label of a
//! single row.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::HashSet;

use palpate_study::readings::{COLUMNS, Column, ColumnUnit, Measure, quaternion_part, spelt};

use super::table_format::pair;
use super::table_layout::is_one_of;

pub(super) struct Heading<'a> {
    pub(super) name: &'a str,
    /// The column name without the unit in brackets, normalised by [`spelt`].
    pub(super) base: String,
    /// Unit in brackets in the column name; `None` if there is none.
    pub(super) bracket: Option<&'a str>,
    /// Component of a quaternion that this column contains; `None` for other columns. A component is recognised by its
    /// name (`quat_x`), or because the file has all four columns `rx` to `rw`.
    pub(super) part: Option<Column>,
}

impl<'a> Heading<'a> {
    pub(super) fn of(name: &'a str) -> Self {
        let name = name.trim();
        let (base, bracket) = bracketed(name);
        let base = spelt(base);
        Self {
            name,
            bracket,
            part: quaternion_part(&base),
            base,
        }
    }

    /// Whether the column contains times, according to its name.
    pub(super) fn is_time(&self) -> bool {
        let mut words = self.base.split('_').enumerate();
        words.any(|(place, word)| match word {
            "t" => place == 0,
            _ => matches!(word, "time" | "timestamp" | "stamp" | "secs"),
        })
    }

    /// Splits a name such as `rotation.x` into the name of the quaternion (`rotation`) and its component (`x`). Returns
    /// `None` if the name does not end with a component.
    pub(super) fn in_group(&self) -> Option<(&str, Column)> {
        let letters = COLUMNS.quaternion.into_iter().zip(["i", "j", "k", "r"]);
        letters.into_iter().find_map(|(column, letter)| {
            let own = self.base.strip_suffix(&column.name[1..]);
            Some((own.or(self.base.strip_suffix(letter))?, column))
        })
    }
}

pub(super) fn bracketed(name: &str) -> (&str, Option<&str>) {
    let parts = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| {
            let (base, unit) = name.strip_suffix(close)?.rsplit_once(open)?;
            // A number in brackets is an index and not a unit, for example in `position[0]`.
            let is_unit = !base.trim().is_empty() && unit.trim().parse::<u8>().is_err();
            is_unit.then_some((base, unit.trim()))
        });
    match parts {
        Some((base, unit)) => (base, Some(unit)),
        None => (name, None),
    }
}

/// Factor from the numbers of a column or an array to the radius of a fingertip: 1 for a radius, 0.5 for a diameter.
/// `None` if the name denotes neither. A name with any other word, for example for the radius of an object, does not
/// count.
pub(super) fn tip_radius_factor(name: &str) -> Option<f64> {
    let name = spelt(bracketed(name).0).replace("tipradius", "tip_radius");
    let words: Vec<&str> = name
        .split('_')
        .map(|word| word.trim_end_matches(|one: char| one.is_ascii_digit()))
        .collect();
    let has = |names: &str| words.iter().any(|word| is_one_of(names, word));
    let is_tip = has("tip fingertip stylus");
    let is_known = |word: &&str| {
        word.is_empty() || is_one_of(TIP_WORDS, word) || Measure::Length.unit(word).is_some()
    };
    let is_radius = has("radius") || (is_tip && has("r rad"));
    let is_diameter = has("diameter") || (is_tip && has("d dia diam"));
    let factor = if is_radius { 1.0 } else { 0.5 };
    (is_radius != is_diameter && words.iter().all(is_known)).then_some(factor)
}

/// Words in the name of a column with the radius or the diameter of a fingertip. An abbreviation such as `r` counts
/// only beside a word for a tip.
const TIP_WORDS: &str =
    "radius r rad diameter d dia diam tip fingertip stylus finger probe sensor meta";
/// Words in the name of a position that may be a point of a fingertip.
const TIP_POSITIONS: &str = "tip fingertip stylus tcp ee center centre";

/// Whether a position with this name may be a point of a fingertip, instead of a contact.
pub(super) fn may_be_tip(name: &str) -> bool {
    let name = spelt(name);
    name.split('_').any(|word| is_one_of(TIP_POSITIONS, word))
}

/// Whether a word is a unit of length, angle, time, turns, pixels or force.
pub(super) fn has_unit(word: &str) -> bool {
    [
        Measure::Length,
        Measure::Angle,
        Measure::Time,
        Measure::Turn,
        Measure::Pixel,
        Measure::Force,
    ]
    .iter()
    .any(|measure| measure.unit(word).is_some())
}

/// Whether a column of this quantity may lack a unit. Lengths without a unit have the unit of other columns or of a
/// setting. Times need no unit, because they are only compared with each other.
pub(super) const fn has_no_need(measure: Measure) -> bool {
    matches!(measure, Measure::Length | Measure::Time | Measure::Plain)
}

pub(super) fn no_unit(name: &str, column: &Column) -> String {
    let own = pair(column.name, name);
    format!(
        "`{name}` states no unit ({}); write setting `columns` '{own}' if its unit is that of `{}`",
        column.measure.units(),
        column.name
    )
}

pub(super) fn unknown_unit(name: &str, unit: &str, measure: Measure) -> String {
    format!(
        "column `{name}` cannot have the unit `{unit}`; allowed: {}",
        measure.units()
    )
}

pub(super) fn two_units(name: &str, unit: &str) -> String {
    format!("column `{name}` states the unit `{unit}`, but its name ends with another unit")
}

/// Unit at the end of a column's name in the file, such as `mm` in `pos_x_mm`. This function is for names that differ
/// from palpate's names. `None` if the name does not end with a unit.
pub(super) fn suffix(heading: &Heading<'_>, column: &Column) -> Result<Option<ColumnUnit>, String> {
    let Some((_, last)) = heading.base.rsplit_once('_') else {
        return Ok(None);
    };
    match (column.measure, column.measure.unit(last)) {
        (Measure::Plain, _) | (_, None) => Ok(None),
        (_, Some(ColumnUnit::Inch)) if last == "in" => {
            let name = heading.name;
            let stem = column.stem();
            Err(format!(
                "`{name}` may be in inches or not; write setting `columns` '{}' if it is in inches, '{}' if it is in millimetres",
                pair(&format!("{stem}_inch"), name),
                pair(&format!("{stem}_mm"), name)
            ))
        }
        (_, unit) => Ok(unit),
    }
}

/// Whether a name in a header contains a number that has a decimal point, such as `x:1.5`.
pub(super) fn is_value(name: &str) -> bool {
    let mut words = name.split([':', '=', '>', ' ']);
    words.any(|word| word.contains('.') && word.parse::<f64>().is_ok())
}

/// Whether a column's name looks like a component of a quaternion, including numbered components (`q0`).
pub(super) fn is_quaternion(heading: &Heading<'_>) -> bool {
    let number = heading.base.strip_prefix('q').map(str::parse::<u8>);
    heading.part.is_some() || heading.base.contains("quat") || matches!(number, Some(Ok(0..=4)))
}

/// Whether a name in the file may mean the column `column`. The name in the file must have no unit, or a unit of the
/// column's quantity. It must also contain all words of palpate's name, or the quantity and the axis of the column.
pub(super) fn is_similar(column: &Column, heading: &Heading<'_>) -> bool {
    // A component of a quaternion must not be proposed for a column that contains an angle.
    let is_angle =
        is_quaternion(heading) && (column.measure != Measure::Length || heading.part.is_some());
    let is_unit = |unit: &str| column.measure.unit(unit).is_some();
    if is_angle || heading.bracket.is_some_and(|unit| !is_unit(unit)) {
        return false;
    }
    let words: Vec<&str> = heading.base.split('_').collect();
    // A column that contains the axis of a rotation must not be proposed for the rotation vector.
    if words.contains(&"axis") && !column.stem().starts_with("axis") {
        return false;
    }
    if let [_, .., last] = words[..]
        && !is_unit(last)
        && has_unit(last)
    {
        return false;
    }
    // Some log files have a column that counts rolls, under one of these names. It may be used as the column `probe`.
    let is_probe = column.name == "probe"
        && words
            .iter()
            .any(|word| matches!(*word, "trial" | "roll" | "episode"));
    let is_theta = column.name == "angle_rad" && words.contains(&"theta");
    let is_time = column.measure == Measure::Time && heading.is_time();
    let is_displacement = column.stem() == "normal_displacement"
        && matches!(words[0], "dn" | "dz" | "un" | "uz" | "normal")
        && words[1..].iter().all(|word| is_unit(word));
    // A single letter may name the subject of a length with a unit, as in `a:thumb_X [mm]`.
    let is_named = |word: &&&str| heading.bracket.is_none() || word.len() > 1;
    let named: Vec<&str> = words.iter().filter(is_named).copied().collect();
    let has_words = match column.stem() {
        label @ ("finger" | "probe") => is_label(label, &words),
        "x" | "y" | "z" => words.contains(&column.stem()) && may_be_position(&named),
        stem => stem.split('_').all(|word| words.contains(&word)),
    };
    let is_special = is_probe || is_theta || is_time || is_displacement;
    is_special || has_words || is_of_axis(column, &words)
}

/// Whether a column name denotes the label of a finger or probe, such as `finger_id`. Columns with a finger's position
/// may also contain the word `finger`; they are no labels.
fn is_label(label: &str, words: &[&str]) -> bool {
    match words {
        [.., last] if *last == label => true,
        [.., before, last] => {
            *before == label && matches!(*last, "id" | "no" | "nr" | "number" | "index" | "name")
        }
        _ => false,
    }
}

/// Whether a column whose name consists of `words` may contain a position. Units, axes and indices among the words do
/// not matter.
pub(super) fn may_be_position(words: &[&str]) -> bool {
    // The name of a position may contain the letter p, and the name of a contact the letter c. Any other single letter
    // denotes another quantity.
    let is_letter =
        |word: &str| word.len() == 1 && !"cpxyz".contains(word) && word.parse::<u8>().is_err();
    let is_other = |word: &str| OTHERS.split(' ').any(|other| is_start(word, other));
    let mut words = words
        .iter()
        .filter(|word| Measure::Length.unit(word).is_none());
    words.all(|word| !is_letter(word) && !is_other(word))
}

/// Whether `whole` begins with `word`. A final s (plural) of `word` is ignored. The result is false if `word` has fewer
/// than three letters without this s.
fn is_start(word: &str, whole: &str) -> bool {
    let word = word.strip_suffix('s').unwrap_or(word);
    word.len() > 2 && whole.starts_with(word)
}

/// Whether a name in the file, which consists of `words`, means the quantity and the axis of `column`. The axis may be
/// a letter or an index. For example, `px` and `position.0` are an x coordinate, `rx` is a rotation about x, and `du`
/// and `u` are shifts.
fn is_of_axis(column: &Column, words: &[&str]) -> bool {
    let (quantity, axis) = match column.stem().rsplit_once('_') {
        Some((quantity, axis)) => (quantity, axis),
        None => ("", column.stem()),
    };
    // Remove words that are units. A number is kept, because it is an index here, although "1" is also a unit.
    let is_no_unit = |word: &&&str| {
        column.measure.unit(word).is_none() || words.len() == 1 || word.parse::<u8>().is_ok()
    };
    let words: Vec<&str> = words.iter().filter(is_no_unit).copied().collect();
    let Some((last, rest)) = words.split_last().filter(|_| axis.len() == 1) else {
        return false;
    };
    let index = match axis {
        "x" | "u" => "0",
        "y" | "v" => "1",
        _ => "2",
    };
    let says = |quantity: &str| {
        let is_named = |word: &str| match word {
            "cop" => quantity == "contact",
            "rotvec" | "rvec" => quantity == "rotation",
            "n" => quantity == "normal",
            _ => false,
        };
        // A quantity may have a short name or a plural name, such as `rot` or `rotations`. Therefore remove a final s,
        // and accept the beginning of the quantity's name.
        rest.iter()
            .any(|word| is_start(word, quantity) || is_named(word))
    };
    // Some authors write x and y for the axes u and v on the probe.
    let other = match axis {
        "u" if says(quantity) => "x",
        "v" if says(quantity) => "y",
        axis => axis,
    };
    // The position of a marker at rest is often named `x0`.
    let last = last
        .strip_suffix('0')
        .filter(|axis| quantity.is_empty() && !axis.is_empty())
        .unwrap_or(last);
    // `letter` is the letter before the axis in the last word, for example `r` in `rx`. It is empty if the word is only
    // an axis or an index.
    let letter = match last.strip_suffix(axis).or(last.strip_suffix(other)) {
        Some(letter) if letter.len() <= 1 => letter,
        _ if last == index && !rest.is_empty() => "",
        _ => return false,
    };
    let letters: &[&str] = match quantity {
        "" => return may_be_position(rest) && matches!(letter, "" | "p"),
        "rotation" => &["r", "w"],
        "axis" => &["a", "u", "k"],
        "contact" => &["", "c"],
        "shift" => &["", "d", "s"],
        "normal" => &["n"],
        "tangential" => &["d", "u"],
        _ => return false,
    };
    says(quantity) || (rest.is_empty() && letters.contains(&letter))
}

/// Words in column names for quantities that have axes, as positions do, but are not measured positions.
const OTHERS: &str = "normal rotation shift tangential force torque velocity acceleration linear angular twist wrench gyro euler quaternion orientation error std cmd commanded desired target goal setpoint reference";

/// Whether the column `key` contains a component of the vector `name`, as `position.0` does for `position`.
pub(super) fn is_within(key: &str, name: &str) -> bool {
    let part = key.strip_prefix(name);
    part.is_some_and(|part| part.starts_with('.'))
}

/// The first name in `names` that occurred before; `None` if all names differ.
pub(super) fn repeated<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let mut earlier = HashSet::new();
    names.find(|name| !earlier.insert(*name))
}

/// The label of a row: a number (its index or time), or the text of its date and time in the form of ISO 8601. Such texts
/// are ordered like their dates.
pub(super) type RowLabel<'a> = (f64, Cow<'a, str>);

pub(super) fn row_label<'a>(key: &Cow<'a, str>) -> Option<RowLabel<'a>> {
    let number = key.parse().ok().filter(|number: &f64| number.is_finite());
    let is_date =
        key.starts_with(|first: char| first.is_ascii_digit()) && key.split('-').count() > 2;
    match number {
        Some(number) => Some((number, "".into())),
        None => is_date.then(|| (0.0, key.clone())),
    }
}

pub(super) fn in_order(one: &RowLabel<'_>, other: &RowLabel<'_>) -> Ordering {
    one.partial_cmp(other).unwrap_or(Ordering::Equal)
}
