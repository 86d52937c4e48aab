//! Recognises columns in tables whose headers do not have palpate's names. Such tables are tables without a header,
//! logs of rostopic, and wide tables. In a wide table, the columns of several fingers are side by side.

use palpate_study::readings::{Column, MATRIX, Measure, QUATERNION, quaternion_part, spelt};

use super::header::{Heading, bracketed, is_similar};
use super::table_format::pair;

/// A finger or probe of a wide table: its name, and the indices of its columns.
pub(super) struct Group {
    pub(super) name: String,
    pub(super) places: Vec<usize>,
}

/// Division of the columns of a wide table among the fingers. With it, each row is split into one row per finger.
pub(super) struct Wide {
    pub(super) groups: Vec<Group>,
    /// Indices of the columns that belong to no single finger, such as the time.
    pub(super) shared: Vec<usize>,
    /// Header of the table after splitting: name of the label, names of the columns of a finger, and names of the
    /// shared columns.
    pub(super) header: Vec<String>,
}

/// Names for the `count` columns of a table without a header. The first entry of `orders` contains the required
/// columns, and the others contain further possible lists of columns. Only the required columns are assigned
/// automatically. For any other number of columns, the error proposes names.
pub(super) fn names_by_order(count: usize, orders: &[&[Column]]) -> Result<Vec<String>, String> {
    let names = |order: &[Column]| order.iter().map(|column| column.name.to_owned()).collect();
    if let Some(required) = orders.first().filter(|order| order.len() == count) {
        return Ok(names(required));
    }
    let same = orders.iter().find(|order| order.len() == count);
    let pairs: Vec<String> = match same {
        Some(order) => order
            .iter()
            .zip(0..)
            .map(|(column, place)| format!("{}={place}", column.name))
            .collect(),
        None => orders
            .first()
            .map_or(&[][..], |order| order)
            .iter()
            .map(|column| format!("{}=…", column.name))
            .collect(),
    };
    let more = match same {
        Some(_) => "if these are its columns",
        None => "with the number of each column at …",
    };
    Err(format!(
        "the first line holds numbers, so the {count} columns have no names and are numbered from 0; write setting `columns` '{}' {more}",
        pairs.join(",")
    ))
}

/// Header of a log that `rostopic echo -p` wrote. Fields with the same meaning as a column of palpate get palpate's
/// names. The second result lists the pairs of names. Lengths are in metres, as in all messages of ROS.
pub(super) fn of_rostopic(header: &[String], columns: &[Column]) -> Option<(Vec<String>, String)> {
    let (first, fields) = header.split_first()?;
    if first != "%time" || !fields.iter().all(|name| name.starts_with("field.")) {
        return None;
    }
    let headings: Vec<Heading<'_>> = header.iter().map(|name| Heading::of(name)).collect();
    let mut found: Vec<(usize, &Column)> = Vec::new();
    for column in columns
        .iter()
        .filter(|column| column.measure != Measure::Time)
    {
        let is_free = |index: &usize| found.iter().all(|(taken, _)| taken != index);
        let is_like = |index: &usize| is_similar(column, &headings[*index]);
        found.extend(
            (1..header.len())
                .filter(is_free)
                .find(is_like)
                .map(|index| (index, column)),
        );
    }
    let mut header = header.to_vec();
    let mut pairs = Vec::new();
    for (index, column) in found {
        let unit = if column.measure == Measure::Length {
            "_m"
        } else {
            ""
        };
        let name = format!("{}{unit}", column.name);
        pairs.push(pair(&name, &header[index]));
        header[index] = name;
    }
    (!pairs.is_empty()).then(|| (header, pairs.join(",")))
}

/// Indices of the columns of a quaternion whose components are only numbered, such as `q0` to `q3`, in the order of
/// their numbers.
pub(super) fn numbered_quaternion(header: &[String]) -> Option<[usize; 4]> {
    let component = |name: &String| {
        let (start, numbers) = numbered(name);
        let is_quaternion = quaternion_part(&format!("{}_x", start.join("_"))).is_some();
        let number: usize = numbers.concat().parse().ok()?;
        is_quaternion.then_some((start, number))
    };
    let found: Vec<_> = header.iter().map(component).collect();
    let (start, _) = found.iter().flatten().next()?;
    let places = |first: usize| {
        let place = |number| {
            let mut all = found.iter();
            all.position(|one| one.as_ref() == Some(&(start.clone(), number)))
        };
        let places = [0, 1, 2, 3].map(|number| place(first + number));
        let [Some(a), Some(b), Some(c), Some(d)] = places else {
            return None;
        };
        Some([a, b, c, d])
    };
    places(0).or_else(|| places(1))
}

/// Header in which the elements of a rotation matrix have palpate's names. In the file, they are named for example
/// `R_0_0` to `R_2_2`, or `rot.0` to `rot.8`.
pub(super) fn of_matrix(header: &[String]) -> Option<Vec<String>> {
    let element = |name: &String| {
        let (start, numbers) = numbered(name);
        let digits: Vec<char> = numbers.iter().flat_map(|number| number.chars()).collect();
        let last = start.last()?.as_str();
        let is_matrix = matches!(
            last,
            "r" | "m" | "rot" | "mat" | "rotation" | "matrix" | "orientation"
        );
        is_matrix.then_some((start, digits))
    };
    let found: Vec<_> = header.iter().map(element).collect();
    let (start, _) = found.iter().flatten().next()?;
    let place = |digits: String| {
        let element = (start.clone(), digits.chars().collect());
        let mut all = found.iter();
        all.position(|one| one.as_ref() == Some(&element))
    };
    let elements = |digits: fn(usize) -> String| -> Option<Vec<usize>> {
        (0..9).map(|element| place(digits(element))).collect()
    };
    let places = elements(|element| format!("{}{}", element / 3, element % 3))
        .or_else(|| elements(|element| format!("{}{}", element / 3 + 1, element % 3 + 1)))
        .or_else(|| elements(|element| element.to_string()))?;
    let mut header = header.to_vec();
    for (place, column) in places.into_iter().zip(MATRIX) {
        header[place] = column.name.to_owned();
    }
    Some(header)
}

/// Splits a column name into its words and the numbers at its end.
fn numbered(name: &str) -> (Vec<String>, Vec<String>) {
    let mut start = words(&spelt(name));
    let is_word = |word: &String| word.parse::<usize>().is_err();
    let end = start.iter().rposition(is_word).map_or(0, |last| last + 1);
    let numbers = start.split_off(end);
    (start, numbers)
}

/// Words that may stand beside the number of a finger or probe in a column name.
const FINGER_WORDS: [&str; 13] = [
    "finger",
    "fingertip",
    "f",
    "tip",
    "digit",
    "probe",
    "roll",
    "trial",
    "contact",
    "position",
    "pos",
    "point",
    "sensor",
];
/// Names of fingers in column names.
const FINGERS: [&str; 6] = ["thumb", "index", "middle", "ring", "little", "pinky"];

/// Recognises a wide table: its header has the same columns for several fingers. The first of `columns` is the column
/// for the number or name of a finger. `None` for other tables.
pub(super) fn wide(header: &[String], columns: &[Column]) -> Option<Wide> {
    let (label, columns) = columns.split_first()?;
    let is_part =
        |column: &&Column| column.measure != Measure::Time && !QUATERNION.contains(column);
    let columns: Vec<&Column> = columns.iter().filter(is_part).collect();
    let mut groups: Vec<(String, Vec<Option<usize>>)> = Vec::new();
    let mut units: Vec<Option<String>> = vec![None; columns.len()];
    let mut shared = Vec::new();
    for (index, name) in header.iter().enumerate() {
        let base = spelt(bracketed(name).0);
        if label.is_named(&base).is_some()
            || columns
                .iter()
                .any(|column| column.is_named(&base).is_some())
        {
            return None;
        }
        let Some((column, unit, group)) = of_finger(name, &columns) else {
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
    let places = |(name, places): (String, Vec<Option<usize>>)| {
        let places: Option<Vec<usize>> = used.iter().map(|&column| places[column]).collect();
        places.map(|places| Group { name, places })
    };
    let groups: Vec<Group> = groups.into_iter().map(places).collect::<Option<_>>()?;
    let named = used.iter().map(|&column| {
        let unit = units[column].as_deref().unwrap_or_default();
        match unit.is_empty() {
            true => columns[column].stem().to_owned(),
            false => format!("{} [{unit}]", columns[column].stem()),
        }
    });
    let others = shared.iter().map(|&index| header[index].clone());
    let header = [label.name.to_owned()]
        .into_iter()
        .chain(named)
        .chain(others)
        .collect();
    (used.len() > 1 && groups.len() > 1).then_some(Wide {
        groups,
        shared,
        header,
    })
}

/// Splits a column name of a wide table, such as `finger1_x_mm`, `x_1 [mm]` or `thumb.nx`. Returns the index of the
/// column in `columns`, the unit and the name of the finger.
fn of_finger(name: &str, columns: &[&Column]) -> Option<(usize, String, String)> {
    let (base, bracket) = bracketed(name);
    let mut words = words(&spelt(base));
    let stems = columns
        .iter()
        .enumerate()
        .map(|(place, column)| (place, self::words(column.stem())));
    // Use the longest column name that fits: `finger_1_normal_x` is the x component of a normal, not the position x.
    let found = stems.filter_map(|(place, stem)| {
        let at = words.windows(stem.len()).rposition(|part| part == stem)?;
        Some((stem.len(), place, at))
    });
    let (length, column, at) = found.max_by_key(|(length, ..)| *length)?;
    words.drain(at..at + length);
    let unit = match (bracket, words.get(at)) {
        (Some(unit), _) => unit.to_owned(),
        (None, Some(word))
            if word.parse::<u32>().is_err() && columns[column].measure.unit(word).is_some() =>
        {
            words.remove(at)
        }
        (None, _) => String::new(),
    };
    let numbers = words
        .iter()
        .filter(|word| word.parse::<u32>().is_ok())
        .count();
    let names = words
        .iter()
        .filter(|word| FINGERS.contains(&word.as_str()))
        .count();
    let others = words
        .iter()
        .filter(|word| FINGER_WORDS.contains(&word.as_str()))
        .count();
    let is_finger = numbers + names == 1 && others + 1 == words.len();
    words.retain(|word| !matches!(word.as_str(), "position" | "pos" | "point" | "contact"));
    is_finger.then(|| (column, unit, words.join("_")))
}

/// Splits a name into words. A number is a word of its own, and `nx` becomes the words `normal` and `x`.
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
