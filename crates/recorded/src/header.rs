//! Finds the columns that palpate reads, by their names in the header of a table.

use std::collections::BTreeMap;

use palpate_study::readings::{COLUMNS, Column, ColumnUnit, Measure, spelt};

use super::heading::{
    Heading, has_no_need, has_unit, is_quaternion, is_similar, is_value, no_unit, suffix,
    two_units, unknown_unit,
};
use super::table_format::pair;
use super::table_layout::is_of_rostopic;

/// Maximum number of columns that an error lists.
const MAX_NAMES: usize = 50;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) index: usize,
    pub(super) unit: Option<ColumnUnit>,
}

pub(super) struct Header<'a> {
    headings: Vec<Heading<'a>>,
    names: &'a BTreeMap<String, String>,
    /// Whether rotations without a unit are in degrees, because in rad they would exceed half a turn.
    pub(super) is_in_degrees: bool,
    /// Whether lengths without a unit are in metres, because the file is a log of ROS.
    is_in_metres: bool,
}

impl<'a> Header<'a> {
    pub(super) fn new(header: &'a [String], names: &'a BTreeMap<String, String>) -> Self {
        let mut headings: Vec<Heading<'_>> = header.iter().map(|name| Heading::of(name)).collect();
        for index in 0..headings.len() {
            let Some((group, column)) = headings[index].in_group() else {
                continue;
            };
            let is_there = |part: Column| {
                let mut groups = headings.iter().filter_map(Heading::in_group);
                groups.any(|other| other == (group, part))
            };
            if COLUMNS.quaternion.into_iter().all(is_there) {
                headings[index].part = Some(column);
            }
        }
        // MATLAB numbers the columns of a vector from 1.
        let bases: Vec<String> = headings.iter().map(|one| one.base.clone()).collect();
        for heading in &mut headings {
            let Some((start, number)) = heading.base.rsplit_once('_') else {
                continue;
            };
            let has = |number: &i32| {
                let name = format!("{start}_{number}");
                bases.iter().filter(|base| **base == name).count() == 1
            };
            let is_vector = [1, 2, 3].iter().all(has) && ![0, 4].iter().any(has);
            if let Some(axis) = ["1", "2", "3"].iter().position(|one| *one == number)
                && is_vector
            {
                heading.base = format!("{start}_{}", &"xyz"[axis..=axis]);
            }
        }
        // In files of trajectories, tx, ty and tz are positions. In files with columns of forces, they are torques.
        let has = |name| headings.iter().any(|heading| heading.base == name);
        if ["tx", "ty", "tz"].into_iter().all(has) && !["fx", "f_x"].into_iter().any(has) {
            for heading in &mut headings {
                if matches!(heading.base.as_str(), "tx" | "ty" | "tz") {
                    heading.base.replace_range(..1, "p");
                }
            }
        }
        Self {
            headings,
            names,
            is_in_degrees: false,
            is_in_metres: is_of_rostopic(header),
        }
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
        let time = self.headings.iter().find(|heading| heading.is_time())?;
        Some(time.name)
    }

    /// Value for the setting `columns` that assigns the file's columns `columns` to palpate's columns `others`. The
    /// value consists of pairs of names, separated by commas.
    pub(super) fn pairs(&self, columns: &[Column], others: &[Column]) -> String {
        let pairs = columns
            .iter()
            .zip(others)
            .filter_map(|(column, other)| Some(pair(other.stem(), self.own_name(column)?)));
        pairs.collect::<Vec<_>>().join(",")
    }

    /// Indices of the file's columns whose names are similar to the names of the rotation vectors in `columns`.
    pub(super) fn angles(&self, columns: &[Column]) -> Vec<usize> {
        let is_angle =
            |column: &&Column| column.measure == Measure::Angle && column.stem() != "angle";
        let is_similar = |&index: &usize| {
            let mut angles = columns.iter().filter(is_angle);
            angles.any(|column| is_similar(column, &self.headings[index]))
        };
        (0..self.headings.len()).filter(is_similar).collect()
    }

    pub(super) fn is_assigned(&self, columns: &[Column]) -> bool {
        columns.iter().any(|column| self.assigned(column).is_some())
    }

    /// Finds the places of the required columns `columns` in the file. `may` contains optional columns, which only the
    /// error message uses.
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

    pub(super) fn place(&self, column: &Column) -> Result<Option<Place>, String> {
        match self.assigned(column) {
            Some((key, name, unit)) => self.assigned_place(column, key, name, unit).map(Some),
            None => self.own_place(column),
        }
    }

    /// Place of the file's column that has palpate's name of `column`; `None` if the file has no such column.
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
                Err(match () {
                    () if first == second => format!("{twice}; rename one of them"),
                    () if COLUMNS.quaternion.contains(column) => {
                        format!("{twice}, as `{first}` and as `{second}`; {TWO_ORIENTATIONS}")
                    }
                    () => format!(
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
            && COLUMNS.quaternion.into_iter().all(has)
        {
            return Err(format!(
                "{says}, which is part of a quaternion; without this assignment, the quaternion is read"
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
        let more = self.headings.len().saturating_sub(MAX_NAMES);
        let names = self.headings.iter().take(MAX_NAMES);
        let mut names: Vec<String> = names.map(|heading| format!("`{}`", heading.name)).collect();
        names.extend((more > 0).then(|| format!("and {more} more")));
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
        let mut names_in_file = self.headings.iter().map(|heading| heading.name);
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
        let groups = std::iter::from_fn(|| self.proposed(missing, &mut rest));
        let mut groups: Vec<_> = groups.collect();
        let (labels, others): (Vec<Column>, Vec<Column>) =
            (optional.iter()).partition(|column| matches!(column.name, "finger" | "probe"));
        let is_twice = |name: &&str| {
            let groups = groups.iter().flatten();
            groups.filter(|(_, other)| other == name).nth(1).is_some()
        };
        if let Some(name) = names_in_file.clone().find(is_twice) {
            message += &format!(
                "; column `{name}` occurs twice; rename it to `1_{name}`, `2_{name}` and so on"
            );
        } else if let Some(value) = names_in_file.find(|name| is_value(name)) {
            message += &format!(
                "; `{value}` contains a number: the first line must name the columns, and the lines below must consist of numbers"
            );
        } else if let ([label], [_, _, _, ..]) = (&labels[..], &groups[..]) {
            // More than two similar groups of columns are probably those of several fingers.
            for (group, number) in groups.iter_mut().zip(1..) {
                group.extend(self.optional(&others, &mut rest));
                for (key, _) in group {
                    *key = format!("{}{number}_{key}", label.name);
                }
            }
            let setting = setting(&groups.concat());
            message += &format!(
                "; write {setting} if each group of columns is of one {}",
                label.name
            );
        } else if let [pairs, more @ ..] = &mut groups[..] {
            pairs.extend(self.optional(optional, &mut rest));
            message += &format!("; write {}", setting(pairs));
            if let [other, ..] = more
                && missing.contains(&COLUMNS.quaternion[0])
            {
                message += &format!(" or {}; {TWO_ORIENTATIONS}", setting(other));
            } else if let [other, ..] = more {
                message += &format!(" or {}", setting(other));
            }
        } else if let Some(pairs) = only() {
            message += &format!("; write {} if these are the same", setting(&pairs));
        } else {
            message += "; setting `columns` assigns other names";
            if missing.contains(&COLUMNS.presses[2]) {
                message += "; normal_displacement is the displacement into the sensor: on a flat pad, the z at rest minus the z of the pressed marker";
            }
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

    /// Proposed assignments for optional columns, as pairs of names. A quantity may have one column per axis. Its
    /// columns are assigned only together: for each, the file must have an unused column with a similar name.
    fn optional(&self, may: &[Column], free: &mut Vec<usize>) -> Vec<Pair> {
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
    fn proposed(&self, missing: &[Column], free: &mut Vec<usize>) -> Option<Vec<Pair>> {
        let mut pair_of = |column: &Column| {
            let similar = |&index: &usize| is_similar(column, &self.headings[index]);
            let place = free.iter().position(similar)?;
            Some(self.pair_of(column, free.remove(place)))
        };
        missing.iter().map(&mut pair_of).collect()
    }

    /// Pair of names that assigns a column of the file to palpate's `column`. The pair contains a unit only if the
    /// column's name in the file states none.
    fn pair_of(&self, column: &Column, index: usize) -> Pair {
        let heading = &self.headings[index];
        let states = heading.bracket.is_some() || suffix(heading, column).ok().flatten().is_some();
        let key = match column.measure {
            _ if states => column.stem().to_owned(),
            Measure::Angle if self.is_in_degrees => format!("{}_deg", column.stem()),
            Measure::Length if self.is_in_metres => format!("{}_m", column.stem()),
            _ => column.name.to_owned(),
        };
        (key, heading.name.to_owned())
    }

    /// Pairs of names that assign the unused columns of the file to the missing columns, in the order of the file.
    /// `None` if the unit of an unused column does not fit.
    fn only_pairs(&self, missing: &[Column], free: &[usize]) -> Option<Vec<Pair>> {
        let pairs = missing.iter().zip(free).map(|(column, &index)| {
            let heading = &self.headings[index];
            let last = heading.base.rsplit('_').next().unwrap_or_default();
            let stated = heading.bracket.or(has_unit(last).then_some(last));
            let may_be = stated.is_none_or(|unit| column.measure.unit(unit).is_some());
            let is_other = heading.part.is_some() || self.time() == Some(heading.name);
            let mut same = self.headings.iter().filter(|one| one.name == heading.name);
            (may_be && !is_other && same.nth(1).is_none()).then(|| self.pair_of(column, index))
        });
        pairs.collect()
    }

    /// Whether the file has a column with the same or a similar name for each of `columns`.
    pub(super) fn offers(&self, columns: &[Column]) -> bool {
        let place = |column: &Column| self.place(column).ok().flatten();
        let (found, missing): (Vec<Column>, Vec<Column>) =
            columns.iter().partition(|column| place(column).is_some());
        let places: Vec<Place> = found.iter().filter_map(place).collect();
        self.proposed(&missing, &mut self.free(&places)).is_some()
    }
}

/// Remedy for a table with the orientations at the start and at the end of each roll.
const TWO_ORIENTATIONS: &str = "but if each row has two orientations, write the start and the end of each roll as two rows of a time series (columns probe, time_s, an orientation, contact_u and contact_v)";

/// Palpate's name of a column, and its name in the file.
type Pair = (String, String);

/// Text of the setting `columns` with the pairs of names `pairs`, quoted for a shell.
fn setting(pairs: &[Pair]) -> String {
    let pairs: Vec<_> = pairs.iter().map(|(key, name)| pair(key, name)).collect();
    let pairs = pairs.join(",").replace('\'', "'\\''");
    format!("setting `columns` '{pairs}'")
}
