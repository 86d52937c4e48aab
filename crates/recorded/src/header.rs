//! Finds the columns that palpate reads by their names in the header of a table.

use palpate_study::readings::{
    Column, ColumnNames, ColumnUnit, Measure, QUATERNION, quaternion_part, spelt,
};

use super::table_format::pair;

pub(super) struct Heading<'a> {
    name: &'a str,
    /// The column name without the unit in brackets, normalised by [`spelt`].
    base: String,
    /// Unit in brackets, if the column name has one.
    bracket: Option<&'a str>,
    /// Component of a quaternion that this column contains. It is recognised by its name (`quat_x`), or because the
    /// file has all four columns `rx` to `rw`.
    part: Option<Column>,
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

    /// Whether the name is that of a time.
    fn is_time(&self) -> bool {
        let mut words = self.base.split('_').enumerate();
        words.any(|(place, word)| match word {
            "t" => place == 0,
            _ => matches!(word, "time" | "timestamp" | "stamp" | "secs"),
        })
    }

    /// Splits a name such as `rotation.x` into the name of the quaternion (`rotation`) and its component (`x`).
    fn in_group(&self) -> Option<(&str, Column)> {
        QUATERNION.into_iter().find_map(|column| {
            let group = self.base.strip_suffix(&column.name[1..])?;
            Some((group, column))
        })
    }
}

pub(super) fn bracketed(name: &str) -> (&str, Option<&str>) {
    let parts = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| {
            let (base, unit) = name.strip_suffix(close)?.rsplit_once(open)?;
            // A number in brackets is an index: `position[0]`.
            let is_unit = !base.trim().is_empty() && unit.trim().parse::<u8>().is_err();
            is_unit.then_some((base, unit.trim()))
        });
    match parts {
        Some((base, unit)) => (base, Some(unit)),
        None => (name, None),
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) index: usize,
    pub(super) unit: Option<ColumnUnit>,
}

pub(super) struct Header<'a> {
    headings: Vec<Heading<'a>>,
    names: &'a ColumnNames,
}

impl<'a> Header<'a> {
    pub(super) fn new(header: &'a [String], names: &'a ColumnNames) -> Self {
        let mut headings: Vec<Heading<'_>> = header.iter().map(|name| Heading::of(name)).collect();
        for index in 0..headings.len() {
            let Some((group, column)) = headings[index].in_group() else {
                continue;
            };
            let is_there = |part: Column| {
                let mut groups = headings.iter().filter_map(Heading::in_group);
                groups.any(|other| other == (group, part))
            };
            if QUATERNION.into_iter().all(is_there) {
                headings[index].part = Some(column);
            }
        }
        // Trajectories have the positions tx, ty and tz. Beside forces, these are torques.
        let has = |name| headings.iter().any(|heading| heading.base == name);
        if ["tx", "ty", "tz"].into_iter().all(has) && !["fx", "f_x"].into_iter().any(has) {
            for heading in &mut headings {
                if matches!(heading.base.as_str(), "tx" | "ty" | "tz") {
                    heading.base.replace_range(..1, "p");
                }
            }
        }
        Self { headings, names }
    }

    pub(super) fn name(&self, index: usize) -> &'a str {
        self.headings[index].name
    }

    /// Whether the file has the column `column`, under palpate's name or under a name that the user assigned. Its unit
    /// is not checked.
    pub(super) fn has(&self, column: &Column) -> bool {
        !matches!(self.place(column), Ok(None))
    }

    /// Name that `column` has in the file; `None` if the file does not have this column.
    pub(super) fn own_name(&self, column: &Column) -> Option<&'a str> {
        let place = self.place(column).ok().flatten()?;
        Some(self.name(place.index))
    }

    /// Name of the file's first column of times; `None` if the file has no column of times.
    pub(super) fn time(&self) -> Option<&'a str> {
        let mut headings = self.headings.iter();
        headings
            .find(|heading| heading.is_time())
            .map(|heading| heading.name)
    }

    /// Value for the setting `columns`, as pairs of names separated by commas. It assigns the names that `columns` have
    /// in the file to the columns `others`.
    pub(super) fn pairs(&self, columns: &[Column], others: &[Column]) -> String {
        let pairs = columns
            .iter()
            .zip(others)
            .filter_map(|(column, other)| Some(pair(other.stem(), self.own_name(column)?)));
        pairs.collect::<Vec<_>>().join(",")
    }

    pub(super) fn is_assigned(&self, columns: &[Column]) -> bool {
        columns.iter().any(|column| self.assigned(column).is_some())
    }

    /// Places of the columns in the file.
    ///
    /// If columns are missing, the message lists the missing columns and the columns of the file. It proposes a value
    /// of the setting `columns`, which assigns names in the file to missing columns.
    pub(super) fn places(&self, columns: &[Column], may: &[Column]) -> Result<Vec<Place>, String> {
        let found: Result<Vec<Option<Place>>, String> =
            columns.iter().map(|column| self.place(column)).collect();
        let found = found?;
        let missing: Vec<Column> = columns
            .iter()
            .zip(&found)
            .filter_map(|(column, place)| place.is_none().then_some(*column))
            .collect();
        match missing.is_empty() {
            true => Ok(found.into_iter().flatten().collect()),
            false => Err(self.lacks([columns, may], &missing, &found)),
        }
    }

    /// The user's assignment for a column: the key in the setting `columns`, the assigned name in the file, and the
    /// unit in the key. `None` if the user assigned no name.
    fn assigned(&self, column: &Column) -> Option<(&'a str, &'a str, Option<ColumnUnit>)> {
        self.names.iter().find_map(|(key, name)| {
            let unit = column.is_named(&spelt(key))?;
            Some((key.as_str(), name.as_str(), unit))
        })
    }

    fn place(&self, column: &Column) -> Result<Option<Place>, String> {
        match self.assigned(column) {
            Some((key, name, unit)) => self.assigned_place(column, key, name, unit).map(Some),
            None => self.own_place(column),
        }
    }

    /// Place of a column whose name in the file is palpate's own name; `None` if the file has no such column.
    fn own_place(&self, column: &Column) -> Result<Option<Place>, String> {
        let is_assigned = |heading: &Heading<'_>| {
            let mut names = self.names.values();
            names.any(|name| name.trim() == heading.name)
        };
        let mut places = Vec::new();
        let mut unknown = None;
        for (index, heading) in self.headings.iter().enumerate() {
            if is_assigned(heading) {
                continue;
            }
            let is_part = heading.part.as_ref() == Some(column);
            let Some(in_name) = column.is_named(&heading.base).or(is_part.then_some(None)) else {
                continue;
            };
            let unit = match heading.bracket {
                None => in_name,
                Some(text) => match column.measure.unit(text) {
                    Some(unit) if in_name.is_none_or(|in_name| in_name == unit) => Some(unit),
                    Some(_) => {
                        unknown = unknown.or(Some(two_units(heading.name, text)));
                        continue;
                    }
                    None => {
                        unknown =
                            unknown.or(Some(unknown_unit(heading.name, text, column.measure)));
                        continue;
                    }
                },
            };
            if unit.is_some() || has_no_need(column.measure) {
                places.push(Place { index, unit });
            }
        }
        match (places.as_slice(), unknown) {
            ([], Some(unknown)) => Err(unknown),
            ([], None) => Ok(None),
            ([place], _) => Ok(Some(*place)),
            ([first, second, ..], _) => {
                let [first, second] = [first, second].map(|place| self.name(place.index));
                let twice = format!("column `{}` occurs twice", column.stem());
                let pair = pair(column.stem(), first);
                Err(match first == second {
                    true => format!("{twice}; rename one of them"),
                    false => format!(
                        "{twice}, as `{first}` and as `{second}`; state which by setting `columns` '{pair}'"
                    ),
                })
            }
        }
    }

    fn assigned_place(
        &self,
        column: &Column,
        key: &str,
        name: &str,
        of_key: Option<ColumnUnit>,
    ) -> Result<Place, String> {
        let says = format!("setting `columns` assigns `{name}` to `{key}`");
        let exact = |heading: &Heading<'_>| heading.name == name.trim();
        let alike = |heading: &Heading<'_>| spelt(heading.name) == spelt(name);
        let without_unit = |heading: &Heading<'_>| heading.base == spelt(name);
        let places = |fits: &dyn Fn(&Heading<'_>) -> bool| -> Vec<usize> {
            let all = 0..self.headings.len();
            all.filter(|&index| fits(&self.headings[index])).collect()
        };
        let ways: [&dyn Fn(&Heading<'_>) -> bool; 3] = [&exact, &alike, &without_unit];
        let mut found = ways.into_iter().map(places);
        let found = found.find(|found| !found.is_empty()).unwrap_or_default();
        let &[index] = found.as_slice() else {
            return Err(match found.len() {
                0 => format!("{says}, which is no column; {}", self.listed()),
                many => format!("{says}, but {many} columns have this name"),
            });
        };
        let heading = &self.headings[index];
        let has = |part: Column| self.headings.iter().any(|other| other.part == Some(part));
        if column.measure == Measure::Angle
            && heading.part.is_some()
            && QUATERNION.into_iter().all(has)
        {
            return Err(format!(
                "{says}, which is part of a quaternion; without it the quaternion is read"
            ));
        }
        let in_file = match heading.bracket {
            Some(text) => Some(
                column
                    .measure
                    .unit(text)
                    .ok_or_else(|| unknown_unit(heading.name, text, column.measure))?,
            ),
            None => suffix(heading, column)?,
        };
        let unit = match (of_key, in_file) {
            (Some(of_key), Some(in_file)) if of_key != in_file => {
                return Err(format!("{says}, but its header states another unit"));
            }
            (of_key, in_file) => of_key.or(in_file),
        };
        if unit.is_none() && !has_no_need(column.measure) {
            return Err(no_unit(heading.name, column));
        }
        Ok(Place { index, unit })
    }

    fn listed(&self) -> String {
        let names = self.headings.iter();
        let names: Vec<String> = names.map(|heading| format!("`{}`", heading.name)).collect();
        format!("the file has {}", names.join(", "))
    }

    /// Message of the error that the file lacks the columns `missing`. It lists the columns of the file, and proposes
    /// pairs of names for the setting `columns`.
    fn lacks(
        &self,
        columns: [&[Column]; 2],
        missing: &[Column],
        found: &[Option<Place>],
    ) -> String {
        let optional = columns[1];
        let [wanted, may] = columns.map(|columns| {
            let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
            names.join(",")
        });
        let names: Vec<String> = missing
            .iter()
            .map(|column| format!("`{}`", column.name))
            .collect();
        let plural = if missing.len() > 1 { "s" } else { "" };
        let mut message = format!(
            "no column{plural} {}; {}; the columns must be {wanted}",
            names.join(", "),
            self.listed()
        );
        if !may.is_empty() {
            message += &format!(", and may be {may} too");
        }
        let of_angle = missing
            .iter()
            .any(|column| column.measure == Measure::Angle);
        if of_angle && self.headings.iter().any(is_quaternion) {
            message += "; a quaternion is read from qx,qy,qz,qw, where qw is its scalar part";
        }
        let is_euler = |heading: &Heading<'_>| {
            let mut words = heading.base.split('_');
            words.any(|word| matches!(word, "yaw" | "euler" | "rpy"))
        };
        if of_angle && self.headings.iter().any(is_euler) {
            message += "; Euler angles are not read: convert them to a quaternion or a matrix";
        }
        let places: Vec<Place> = found.iter().flatten().copied().collect();
        let free = self.free(&places);
        let mut rest = free.clone();
        let only = || {
            let is_only = free.len() == missing.len();
            is_only.then(|| self.only_pairs(missing, &free)).flatten()
        };
        if let Some(mut pairs) = self.proposed(missing, &mut rest) {
            let other = self.proposed(missing, &mut rest.clone());
            pairs.extend(self.optional(optional, &mut rest));
            message += &format!("; write {}", setting(&pairs));
            if let Some(other) = other {
                message += &format!(" or {}", setting(&other));
            }
        } else if let Some(pairs) = only() {
            message += &format!("; write {} if these are the same", setting(&pairs));
        } else {
            message += "; setting `columns` assigns other names";
        }
        message
    }

    fn free(&self, places: &[Place]) -> Vec<usize> {
        let is_free = |index: &usize| {
            let mut taken = places.iter();
            !self.headings[*index].name.is_empty() && taken.all(|place| place.index != *index)
        };
        (0..self.headings.len()).filter(is_free).collect()
    }

    /// Note about unread columns whose names resemble optional columns. The note states the value of the setting
    /// `columns` with which palpate reads these columns. `None` if there are no such columns.
    pub(super) fn unread(&self, may: &[Column], places: &[Place]) -> Option<String> {
        let pairs = self.optional(may, &mut self.free(places));
        (!pairs.is_empty()).then(|| {
            let setting = setting(&pairs);
            format!("optional columns are not read; {setting} reads them")
        })
    }

    /// Assignments for optional columns, as pairs of names. The columns of a quantity are assigned only if the file has
    /// an unused, similar name for each of them.
    fn optional(&self, may: &[Column], free: &mut Vec<usize>) -> Vec<String> {
        let quantity = |column: &Column| match column.stem().rsplit_once('_') {
            Some((quantity, axis)) if axis.len() == 1 => quantity,
            _ => column.stem(),
        };
        let parts = may.chunk_by(|one, other| quantity(one) == quantity(other));
        let pairs = parts.flat_map(|part| {
            let mut rest = free.clone();
            let pairs = self.proposed(part, &mut rest);
            if pairs.is_some() {
                *free = rest;
            }
            pairs.unwrap_or_default()
        });
        pairs.collect()
    }

    /// Proposed assignments for the missing columns; `None` if no unused name in the file is similar to the name of a
    /// missing column.
    fn proposed(&self, missing: &[Column], free: &mut Vec<usize>) -> Option<Vec<String>> {
        let mut pair_of = |column: &Column| {
            let similar = |&index: &usize| is_similar(column, &self.headings[index]);
            let place = free.iter().position(similar)?;
            Some(self.pair_of(column, free.remove(place)))
        };
        missing.iter().map(&mut pair_of).collect()
    }

    /// Pair of names that assigns a column of the file to palpate's `column`. It contains a unit only if the file's
    /// name states none.
    fn pair_of(&self, column: &Column, index: usize) -> String {
        let heading = &self.headings[index];
        let states = heading.bracket.is_some() || suffix(heading, column).ok().flatten().is_some();
        let key = if states { column.stem() } else { column.name };
        pair(key, heading.name)
    }

    /// Assigns the unused columns of the file to the missing columns, one by one in the order of the file. `None` if
    /// the unit of an unused column does not fit.
    fn only_pairs(&self, missing: &[Column], free: &[usize]) -> Option<Vec<String>> {
        let pairs = missing.iter().zip(free).map(|(column, &index)| {
            let heading = &self.headings[index];
            let last = heading.base.rsplit('_').next().unwrap_or_default();
            let stated = heading.bracket.or(has_unit(last).then_some(last));
            let may_be = stated.is_none_or(|unit| column.measure.unit(unit).is_some());
            let is_other = heading.part.is_some() || self.time() == Some(heading.name);
            (may_be && !is_other).then(|| self.pair_of(column, index))
        });
        pairs.collect()
    }

    /// Whether the file has a column with the same or a similar name for each of `columns`.
    pub(super) fn offers(&self, columns: &[Column]) -> bool {
        let places = columns
            .iter()
            .map(|column| self.place(column).ok().flatten());
        let places: Vec<Option<Place>> = places.collect();
        let missing = columns
            .iter()
            .zip(&places)
            .filter(|(_, place)| place.is_none());
        let missing: Vec<Column> = missing.map(|(column, _)| *column).collect();
        let places: Vec<Place> = places.into_iter().flatten().collect();
        self.proposed(&missing, &mut self.free(&places)).is_some()
    }
}

/// The setting `columns` with these pairs of names, quoted for a shell.
fn setting(pairs: &[String]) -> String {
    let pairs = pairs.join(",").replace('\'', "'\\''");
    format!("setting `columns` '{pairs}'")
}

/// Whether a word is the unit of a quantity other than a plain number.
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

/// Whether a column of this measure may have no unit. Lengths then have the unit of other columns or of a setting.
/// Times need no unit, because they are only compared with each other.
const fn has_no_need(measure: Measure) -> bool {
    matches!(measure, Measure::Length | Measure::Time | Measure::Plain)
}

fn no_unit(name: &str, column: &Column) -> String {
    let own = pair(column.name, name);
    format!(
        "`{name}` states no unit ({}); write setting `columns` '{own}' if its unit is that of `{}`",
        column.measure.units(),
        column.name
    )
}

fn unknown_unit(name: &str, unit: &str, measure: Measure) -> String {
    format!(
        "column `{name}` cannot have the unit `{unit}`; allowed: {}",
        measure.units()
    )
}

fn two_units(name: &str, unit: &str) -> String {
    format!("column `{name}` states the unit `{unit}`, but its name ends with another unit")
}

/// Unit at the end of a column name, such as `mm` in `pos_x_mm`. The name is not one of palpate's names.
fn suffix(heading: &Heading<'_>, column: &Column) -> Result<Option<ColumnUnit>, String> {
    let Some((_, last)) = heading.base.rsplit_once('_') else {
        return Ok(None);
    };
    match (column.measure, column.measure.unit(last)) {
        (Measure::Plain, _) | (_, None) => Ok(None),
        (_, Some(ColumnUnit::Inch)) if last == "in" => {
            let name = heading.name;
            let stem = column.stem();
            Err(format!(
                "`{name}` may be in inches or not; write setting `columns` '{}' if it is in inches, '{}' if it is in \
                 millimetres",
                pair(&format!("{stem}_inch"), name),
                pair(&format!("{stem}_mm"), name)
            ))
        }
        (_, unit) => Ok(unit),
    }
}

/// Whether a column's name looks like a component of a quaternion, including numbered components (`q0`).
fn is_quaternion(heading: &Heading<'_>) -> bool {
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
    // A column with the axis of a rotation is not a column of the rotation vector.
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
    let is_displacement =
        column.stem() == "normal_displacement" && matches!(words[..], ["dn" | "dz" | "normal"]);
    let has_words = match column.stem() {
        label @ ("finger" | "probe") => is_label(label, &words),
        "x" | "y" | "z" => words.contains(&column.stem()) && may_be_position(&words),
        stem => stem.split('_').all(|word| words.contains(&word)),
    };
    let is_special = is_probe || is_theta || is_time || is_displacement;
    is_special || has_words || is_of_axis(column, &words)
}

/// Whether a name is that of the label of a finger or probe, such as `finger_id`. The columns of a finger's
/// position also have the word `finger`.
fn is_label(label: &str, words: &[&str]) -> bool {
    match words {
        [.., last] if *last == label => true,
        [.., before, last] => {
            *before == label && matches!(*last, "id" | "no" | "nr" | "number" | "index" | "name")
        }
        _ => false,
    }
}

/// Whether a name with these words may be that of a position. Words that are units, axes or indices do not matter.
fn may_be_position(words: &[&str]) -> bool {
    // A position may have the prefix p, and that of a contact c. Another single letter denotes another quantity.
    let is_letter =
        |word: &str| word.len() == 1 && !"cpxyz".contains(word) && word.parse::<u8>().is_err();
    let is_other = |word: &str| OTHERS.split(' ').any(|other| is_start(word, other));
    let mut words = words
        .iter()
        .filter(|word| Measure::Length.unit(word).is_none());
    words.all(|word| !is_letter(word) && !is_other(word))
}

/// Whether a word of at least three letters, without the s of a plural, is the start of `whole`.
fn is_start(word: &str, whole: &str) -> bool {
    let word = word.strip_suffix('s').unwrap_or(word);
    word.len() > 2 && whole.starts_with(word)
}

/// Whether a name in the file means the quantity and the axis of the column `column`. The axis may be a letter or an
/// index. For example, `px` and `position.0` are an x coordinate, `rx` is a rotation about x, and `du` and `u` are
/// shifts.
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
    // Some authors call the axes u and v on the probe x and y.
    let other = match axis {
        "u" if says(quantity) => "x",
        "v" if says(quantity) => "y",
        axis => axis,
    };
    // `letter` is what precedes the axis in the last word, for example `r` in `rx`. The text is empty if the word is
    // only an axis or an index.
    let letter = match last.strip_suffix(axis).or(last.strip_suffix(other)) {
        Some(letter) if letter.len() <= 1 => letter,
        _ if *last == index && !rest.is_empty() => "",
        _ => return false,
    };
    let letters: &[&str] = match quantity {
        "" => return may_be_position(rest) && matches!(letter, "" | "p"),
        "rotation" => &["r", "w"],
        "axis" => &["a", "u", "k"],
        "contact" => &["", "c"],
        "shift" => &["", "d", "s"],
        "normal" => &["n"],
        "tangential" => &["d"],
        _ => return false,
    };
    says(quantity) || (rest.is_empty() && letters.contains(&letter))
}

/// Words for quantities that have axes but are not measured positions.
const OTHERS: &str = "normal rotation shift tangential force torque velocity acceleration linear angular twist \
    wrench gyro euler quaternion orientation error std cmd commanded desired target goal setpoint reference";
