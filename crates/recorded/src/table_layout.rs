//! Recognises columns in tables whose headers do not have palpate's names. Such tables are tables without a header,
//! logs of rostopic, and wide tables. In a wide table, the columns of several fingers are side by side.

use std::collections::BTreeMap;

use palpate_study::readings::{COLUMNS, Column, Measure, quaternion_part, spelt};

use super::heading::{Heading, bracketed, is_similar, may_be_position};
use super::table_format::pair;

/// A finger or probe of a wide table: its name, and the indices of its columns.
pub(super) struct Group {
    pub(super) name: String,
    pub(super) places: Vec<usize>,
}

/// Columns of a wide table, divided among the fingers. Each row of the table is split into one row per finger.
pub(super) struct Wide {
    pub(super) groups: Vec<Group>,
    /// Indices of the columns that belong to no single finger, such as the time.
    pub(super) shared: Vec<usize>,
    /// Header of the table after the split of its rows: name of the column with the finger's label, names of the
    /// columns of one finger, and names of the shared columns.
    pub(super) header: Vec<String>,
}

/// Names for the `count` columns of a table without a header: the first list of `orders`, if it has `count` columns.
/// Otherwise, the result is an error that proposes names. It proposes another list of `orders` with `count` columns; a
/// list that begins with a label is proposed only if `is_label` is true. If there is no such list, it proposes the first
/// list of `orders` for the columns from `start` on.
pub(super) fn names_by_order(
    count: usize,
    orders: &[&[Column]],
    (is_label, start): (bool, usize),
) -> Result<Vec<String>, String> {
    let names = |order: &[Column]| order.iter().map(|column| column.name.to_owned()).collect();
    if let Some(required) = orders.first().filter(|order| order.len() == count) {
        return Ok(names(required));
    }
    let has_label = |order: &&&[Column]| order[0].measure == Measure::Plain;
    let same = orders
        .iter()
        .find(|order| order.len() == count && (is_label || (start == 0 && !has_label(order))));
    let names = |order: &&[Column]| order.iter().map(|column| column.name).collect::<Vec<_>>();
    let required = orders.first().filter(|order| start + order.len() <= count);
    let later = required.filter(|_| orders.last().is_some_and(|order| has_label(&order)));
    // Rows of twelve numbers are probably 3 x 4 matrices, as in poses of the KITTI data set.
    let poses = ["", "", "", "x", "", "", "", "y", "", "", "", "z"];
    let later = later.map(|order| match count {
        12 => poses.to_vec(),
        _ => [vec![""; start], names(order)].concat(),
    });
    Err(without_names(count, same.map(names).or(later).as_slice()))
}

/// Message that the `count` columns of a table have no names. It proposes the `layouts`, which are possible names of
/// the columns.
pub(super) fn without_names(count: usize, layouts: &[Vec<&str>]) -> String {
    let setting = |names: &Vec<&str>| {
        let pairs = names
            .iter()
            .zip(0..)
            .filter(|(name, _)| !name.is_empty())
            .map(|(name, place)| format!("{name}={place}"));
        format!("'{}'", pairs.collect::<Vec<_>>().join(","))
    };
    let settings: Vec<String> = layouts.iter().map(setting).collect();
    let more = match settings.is_empty() {
        true => "setting `columns` assigns names to the numbers".to_owned(),
        false => {
            let settings = settings.join(" or ");
            format!("write setting `columns` {settings} if the table has these columns")
        }
    };
    format!(
        "the first line holds numbers, so the {count} columns have no names and are numbered from 0; {more}"
    )
}

/// Whether `rostopic echo -p` wrote a log with this header.
pub(super) fn is_of_rostopic(header: &[String]) -> bool {
    let fields = header.split_first().filter(|(first, _)| *first == "%time");
    fields.is_some_and(|(_, fields)| fields.iter().all(|name| name.starts_with("field.")))
}

/// Header of a log that `rostopic echo -p` wrote. Fields with the same meaning as a column of palpate get palpate's
/// names. The second result lists the renamed fields as pairs: name in the file, palpate's name. Lengths are in metres,
/// as in all messages of ROS. `None` for other headers.
pub(super) fn of_rostopic(header: &[String], columns: &[Column]) -> Option<(Vec<String>, String)> {
    let headings: Vec<Heading<'_>> = header.iter().map(|name| Heading::of(name)).collect();
    let mut free: Vec<usize> = (1..header.len()).collect();
    let (mut pairs, mut named) = (Vec::new(), header.to_vec());
    for column in columns {
        let is_like = |&index: &usize| is_similar(column, &headings[index]);
        let found = free.iter().position(is_like);
        if let Some(at) = found.filter(|_| column.measure != Measure::Time) {
            let unit = if column.measure == Measure::Length {
                "_m"
            } else {
                ""
            };
            let name = format!("{}{unit}", column.name);
            let index = free.remove(at);
            pairs.push(pair(&name, &header[index]));
            named[index] = name;
        }
    }
    (!pairs.is_empty()).then(|| (named, pairs.join(",")))
}

/// Indices of the columns of a quaternion whose components have only numbers as names, such as `q0` to `q3`, in the
/// order of their numbers. `None` if there is no such quaternion.
pub(super) fn numbered_quaternion(header: &[String]) -> Option<[usize; 4]> {
    let is_quaternion =
        |start: &[String]| quaternion_part(&format!("{}_x", start.join("_"))).is_some();
    list(header, is_quaternion, [1, 4])?.try_into().ok()
}

/// Header of a table with a rotation matrix. The names of the matrix's elements in the file (for example `R_0_0` to
/// `R_2_2`, or `rot.0` to `rot.8`) are replaced by palpate's names. `None` if there is no such matrix.
pub(super) fn of_matrix(header: &[String]) -> Option<Vec<String>> {
    const NAMES: &str = "r m t rot mat rotm rotmat dcm rotation rotations matrix orientation";
    let is_matrix = |start: &[String]| start.last().is_some_and(|last| is_one_of(NAMES, last));
    // In the names `rxx` to `rzz`, the letters x, y, z stand for the indices 1, 2, 3.
    let numbered = |name: &String| {
        let (start, is_axis) = (name.len().saturating_sub(2), |one| "xyzXYZ".contains(one));
        let Some(axes) = name.get(start..).filter(|axes| axes.chars().all(is_axis)) else {
            return name.clone();
        };
        let axes = axes.to_lowercase().replace('x', "1").replace('y', "2");
        name[..start].to_owned() + &axes.replace('z', "3")
    };
    let named: Vec<String> = header.iter().map(numbered).collect();
    let mut header = header.to_vec();
    for (place, column) in list(&named, is_matrix, [3, 3])?
        .into_iter()
        .zip(COLUMNS.matrix)
    {
        header[place] = column.name.to_owned();
    }
    Some(header)
}

/// Indices of the columns of a 4 x 4 matrix, in the order of the numbers in their names. `None` if there is no such
/// matrix.
pub(super) fn transform(header: &[String]) -> Option<Vec<usize>> {
    list(header, |_| true, [4, 4])
}

/// Header of a table in which the user assigned names such as `finger1_x` to columns. The names get the units of the
/// columns in the file.
pub(super) fn assigned(header: &[String], names: &BTreeMap<String, String>) -> Vec<String> {
    let name = |own: &String| {
        let Some((key, _)) = names.iter().find(|(_, name)| name.trim() == own.trim()) else {
            return own.clone();
        };
        let heading = Heading::of(own);
        let last = heading.base.rsplit('_').next();
        let unit = heading.bracket.or(last);
        match unit.filter(|unit| Measure::Length.unit(unit).is_some()) {
            Some(unit) => format!("{key} [{unit}]"),
            None => key.clone(),
        }
    };
    header.iter().map(name).collect()
}

/// Indices of the columns that contain the elements of one matrix with the given numbers of rows and columns. Their
/// names begin with the same words. They end with the numbers of the element's row and column, or with the number of the
/// element. All numbers are counted from 0 or from 1.
fn list(
    header: &[String],
    is_start: impl Fn(&[String]) -> bool,
    [rows, columns]: [usize; 2],
) -> Option<Vec<usize>> {
    let names = header.iter().map(|name| numbered(name));
    let names: Vec<(Vec<String>, String)> = names
        .map(|(start, numbers)| (start, numbers.concat()))
        .collect();
    let place = |start: &Vec<String>, number: String| {
        names
            .iter()
            .position(|name| name.1 == number && name.0 == *start)
    };
    let mut starts = names
        .iter()
        .filter(|(start, numbers)| is_start(start) && !numbers.is_empty());
    starts.find_map(|(start, _)| {
        let of = |(has_row, first): (bool, usize)| {
            let number = |element: usize| match has_row {
                true => format!("{}{}", element / columns + first, element % columns + first),
                false => (element + first).to_string(),
            };
            let elements = 0..rows * columns;
            elements
                .map(|element| place(start, number(element)))
                .collect()
        };
        let mut forms = [(true, 0), (true, 1), (false, 0), (false, 1)].into_iter();
        forms.find_map(of)
    })
}

/// Splits a column name into its words and the numbers after the words.
fn numbered(name: &str) -> (Vec<String>, Vec<String>) {
    let mut start = words(&spelt(name));
    let is_word = |word: &String| word.parse::<usize>().is_err();
    let end = start.iter().rposition(is_word).map_or(0, |last| last + 1);
    let numbers = start.split_off(end);
    (start, numbers)
}

/// Words that may accompany the number of a finger or probe in a column name.
const FINGER_WORDS: &str = "finger link fingertip f tip digit probe roll trial contact position pos p point sensor field pose translation transform hand arm robot gripper";
/// Words that name a finger in a column name.
const FINGERS: &str = "thumb index middle ring little pinky th ff mf rf lf left right center centre mid first second third fourth fifth top bottom upper lower front back";
/// Words that name the middle finger, unless the column name already has a name or number of a finger. In
/// `left_center_x`, the word `center` denotes a point on the finger `left`.
const CENTERS: &str = "center centre mid";
/// Letters that name the fingers of a table if the table has columns for all letters of one entry. Otherwise, such a
/// letter denotes a quantity, such as the moment `m_x`.
const LETTERS: [&str; 6] = ["a b c d e", "a b c d", "a b c", "l m r", "l c r", "l r"];

/// Recognises a wide table: its header has the same columns for several fingers. Lengths without a unit get the unit
/// `length`. `None` in three cases: the table is not wide; the first of `columns` is not the label of a finger; other
/// columns of the table may belong to a further finger, which must not be left out.
///
/// # Errors
/// A message if a finger lacks a column that another finger has.
pub(super) fn wide(
    header: &[String],
    columns: &[Column],
    length: &str,
) -> Result<Option<Wide>, String> {
    let of_letters = |names: &&str| {
        let table = wide_of(header, columns, length, names)?.ok()??;
        (table.groups.len() == names.split(' ').count()).then_some(table)
    };
    let by_letters = || LETTERS.iter().find_map(of_letters);
    let by_names = wide_of(header, columns, length, FINGERS).transpose()?;
    Ok(by_names.flatten().or_else(by_letters))
}

/// A wide table whose fingers have numbers or the names `names`.
fn wide_of(
    header: &[String],
    columns: &[Column],
    length: &str,
    names: &str,
) -> Option<Result<Option<Wide>, String>> {
    let (label, columns) = columns.split_first()?;
    if label.measure != Measure::Plain {
        return None;
    }
    let is_time = |column: &&Column| column.measure == Measure::Time;
    let columns: Vec<&Column> = columns.iter().filter(|column| !is_time(column)).collect();
    let mut groups: Vec<(String, Vec<Option<usize>>)> = Vec::new();
    let mut units: Vec<Option<String>> = vec![None; columns.len()];
    let (mut shared, mut others) = (Vec::new(), Vec::new());
    for (index, name) in header.iter().enumerate() {
        let base = spelt(bracketed(name).0);
        let found = of_finger(name, &columns, names);
        let Some((column, unit, group, _)) = found.clone().filter(|(.., is_finger)| *is_finger)
        else {
            others.extend(found.map(|(_, _, group, _)| group));
            let mut all = columns.iter().copied().chain([label]);
            if all.any(|column| column.is_named(&base).is_some()) {
                return None;
            }
            shared.push(index);
            continue;
        };
        if units[column].get_or_insert_with(|| unit.clone()) != &unit {
            return None;
        }
        let known = groups.iter().position(|(name, _)| *name == group);
        let at = known.unwrap_or_else(|| {
            groups.push((group, vec![None; columns.len()]));
            groups.len() - 1
        });
        if groups[at].1[column].replace(index).is_some() {
            return None;
        }
    }
    let used: Vec<usize> = (0..columns.len())
        .filter(|&column| units[column].is_some())
        .collect();
    let is_whole = |group| others.iter().filter(|other| *other == group).count() >= used.len();
    if others.iter().any(is_whole) {
        return None;
    }
    // In `x,x_2,x_3` or in `x,x.1,x.2` of pandas, the name of the first finger has no number.
    if let Some(first) = groups.iter().position(|(name, _)| name.is_empty()) {
        let others = groups.iter().filter(|(name, _)| !name.is_empty());
        let numbers: Option<Vec<u32>> = others.map(|(name, _)| name.parse().ok()).collect();
        let number = numbers?.into_iter().min()?.checked_sub(1)?;
        groups[first].0 = number.to_string();
    }
    let places = |(name, places): (String, Vec<Option<usize>>)| {
        let places: Option<Vec<usize>> = used.iter().map(|&column| places[column]).collect();
        places.map(|places| Group { name, places })
    };
    let lacking = groups.iter().find_map(|(name, places)| {
        let column = used.iter().find(|&&column| places[column].is_none())?;
        Some((name.clone(), columns[*column].stem()))
    });
    let whole: Vec<Group> = groups.into_iter().filter_map(places).collect();
    if let (Some((name, column)), [group, ..]) = (lacking, &whole[..]) {
        let stems = used.iter().map(|&column| columns[column].stem());
        let pairs = stems
            .zip(&group.places)
            .map(|(stem, &place)| pair(stem, &header[place]));
        let (pairs, label) = (pairs.collect::<Vec<_>>().join(","), label.name);
        return Some(Err(format!(
            "{label} `{name}` has no column `{column}`, but {label} `{}` has one; setting `columns` '{pairs}' reads only this {label}",
            group.name
        )));
    }
    let groups = whole;
    let named = used.iter().map(|&column| {
        let unit = units[column].as_deref().unwrap_or_default();
        let is_bare = unit.is_empty() && columns[column].measure == Measure::Length;
        let unit = if is_bare { length } else { unit };
        match unit.is_empty() {
            true => columns[column].stem().to_owned(),
            false => format!("{} [{unit}]", columns[column].stem()),
        }
    });
    let others = shared.iter().map(|&index| header[index].clone());
    let header = [label.name.to_owned()].into_iter().chain(named);
    let header = header.chain(others).collect();
    let is_wide = used.len() > 1 && groups.len() > 1;
    Some(Ok(is_wide.then_some(Wide {
        groups,
        shared,
        header,
    })))
}

/// Splits a column name of a wide table, such as `finger1_x_mm`, `x_1 [mm]` or `thumb.nx`. Returns the index of the
/// column in `columns`, the unit, the name of the finger, and whether this name consists of the words `fingers` and
/// numbers. Otherwise, the column may belong to another finger. `None` if the name has no such form.
fn of_finger(
    name: &str,
    columns: &[&Column],
    fingers: &str,
) -> Option<(usize, String, String, bool)> {
    let (base, bracket) = bracketed(name);
    let mut words = words(&spelt(base));
    // If the last word of the name is the number of an axis, as in `thumb.0` or `finger1.position.2`, replace it by x,
    // y or z.
    if let Some(axis) = (words.last()).and_then(|last| "012".find(last.as_str()))
        && (words.iter().rev().skip(1)).any(|word| is_identifier(word))
        && !words.iter().any(|word| is_one_of("x y z", word))
    {
        words.pop();
        words.push("xyz"[axis..=axis].to_owned());
    }
    let stems = columns
        .iter()
        .enumerate()
        .map(|(place, column)| (place, self::words(column.stem())));
    // In `normal_1_x`, the number of the finger is between the words of the column `normal_x`. Move the number to the
    // front.
    for at in 2..words.len() {
        let is_split = |stem: &&Column| *stem.stem() == format!("{}_{}", words[at - 2], words[at]);
        if is_identifier(&words[at - 1]) && columns.iter().any(is_split) {
            words.swap(at - 2, at - 1);
        }
    }
    // Use the longest column name that fits: `finger_1_normal_x` is the column `normal_x`, not the column `x`.
    let found = stems.filter_map(|(place, stem)| {
        let at = words.windows(stem.len()).rposition(|part| part == stem)?;
        Some((stem.len(), place, at))
    });
    let (length, column, at) = found.max_by_key(|(length, ..)| *length)?;
    words.drain(at..at + length);
    // The unit follows the name of the column, or it is the last word, as in `x_1_mm`.
    let is_unit = |&place: &usize| {
        let word = words.get(place).filter(|word| word.parse::<u32>().is_err());
        word.is_some_and(|word| columns[column].measure.unit(word).is_some())
    };
    let unit = match (
        bracket,
        [at, words.len().saturating_sub(1)]
            .iter()
            .find(|place| **place >= at && is_unit(place)),
    ) {
        (Some(unit), _) => unit.to_owned(),
        (None, Some(&place)) => words.remove(place),
        (None, None) => String::new(),
    };
    let is_number = |word: &&String| word.parse::<u32>().is_ok();
    let numbers = words.iter().filter(is_number).count();
    let names = words.iter().filter(|word| is_one_of(fingers, word));
    let names = names.count();
    // The name of an array may be a plural, such as `positions`.
    let is_other = |word: &&String| {
        let one = word.strip_suffix('s').unwrap_or(word);
        [word.as_str(), one]
            .iter()
            .any(|word| is_one_of(FINGER_WORDS, word))
    };
    let others = words.iter().filter(is_other).count();
    // A finger may have several names and a number, such as `left_index_tip_1`.
    let identifiers = numbers + names;
    let is_center = words.iter().any(|word| is_one_of(CENTERS, word));
    let is_named = identifiers > 0 && (identifiers == 1 || !is_center);
    let is_finger =
        (words.is_empty() || is_named) && numbers <= 1 && others + identifiers == words.len();
    let other = words.iter().filter(|word| !is_other(word));
    let other: Vec<&str> = other.map(String::as_str).collect();
    let may_be_finger =
        identifiers == 0 && !other.is_empty() && (fingers != FINGERS || may_be_position(&other));
    words.retain(|word| !is_one_of("position pos point contact field", word));
    (is_finger || may_be_finger).then(|| (column, unit, words.join("_"), is_finger))
}

/// Whether a word is the name or the number of a finger.
fn is_identifier(word: &str) -> bool {
    is_one_of(FINGERS, word) || word.parse::<u32>().is_ok()
}

pub(super) fn is_one_of(words: &str, word: &str) -> bool {
    words.split(' ').any(|one| one == word)
}

/// Words of a column name. Digits are separate words, and `nx` counts as the two words `normal` and `x`.
fn words(name: &str) -> Vec<String> {
    let mut words = Vec::new();
    for word in name.split('_') {
        let digits = |letter: char| letter.is_ascii_digit();
        let (start, number) = word.split_at(word.find(digits).unwrap_or(word.len()));
        let (number, rest) = number.split_at(
            number
                .find(|letter| !digits(letter))
                .unwrap_or(number.len()),
        );
        for part in [start, number, rest] {
            match part {
                "" => {}
                "nx" | "ny" | "nz" => words.extend(["normal", &part[1..]].map(str::to_owned)),
                "px" | "py" | "pz" => words.push(part[1..].to_owned()),
                part => words.push(part.to_owned()),
            }
        }
    }
    words
}
