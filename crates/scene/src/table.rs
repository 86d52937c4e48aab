//! Tables that a scene writes.

use palpate_tracking::Track;

/// A table with a header, to be written as CSV.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Column names, units appended.
    pub header: Vec<String>,
    /// Rows of as many fields.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of these columns, without rows.
    pub fn new(header: impl IntoIterator<Item = String>) -> Self {
        Self {
            header: header.into_iter().collect(),
            rows: Vec::new(),
        }
    }

    /// A row that begins with whole numbers, followed by numbers in shortest round-trip form.
    pub(crate) fn push(&mut self, index: usize, numbers: impl IntoIterator<Item = f64>) {
        let index = std::iter::once(index.to_string());
        self.rows
            .push(index.chain(numbers.into_iter().map(number)).collect());
    }

    /// A row of numbers, likewise.
    pub(crate) fn push_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.rows.push(numbers.into_iter().map(number).collect());
    }

    /// One row per marker: place and hue at rest (pressed, of one that is new) and how they changed, as far as they did.
    /// What is not seen is empty.
    pub(crate) fn of_tracks<'a>(tracks: impl Iterator<Item = Option<&'a Track>>) -> Self {
        let header = "marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status";
        let mut table = Self::new(header.split(',').map(str::to_owned));
        for (marker, track) in tracks.enumerate() {
            let seen = track.and_then(|track| track.rest.or(track.pressed));
            let change = track.and_then(Track::change);
            let numbers = [
                seen.map(|seen| seen.centroid_px[0]),
                seen.map(|seen| seen.centroid_px[1]),
                seen.map(|seen| seen.hue_turns),
                change.map(|change| change.shift_px[0]),
                change.map(|change| change.shift_px[1]),
                change.map(|change| change.hue_turns),
            ];
            let status = track.map_or("not-seen", |track| track.status.name());
            let mut row = vec![marker.to_string()];
            row.extend(numbers.map(|one| one.map_or_else(String::new, number)));
            row.push(status.to_owned());
            table.rows.push(row);
        }
        table
    }

    /// CSV text of the table (RFC 4180): what holds a comma, a quote or a line's end is quoted.
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        for row in std::iter::once(&self.header).chain(&self.rows) {
            for (place, field) in row.iter().enumerate() {
                if place > 0 {
                    text.push(',');
                }
                push_field(&mut text, field);
            }
            text.push('\n');
        }
        text
    }
}

fn push_field(text: &mut String, field: &str) {
    if field.contains([',', '"', '\n', '\r']) {
        text.push('"');
        text.push_str(&field.replace('"', "\"\""));
        text.push('"');
    } else {
        text.push_str(field);
    }
}

/// A number in the shortest form that reads back the same; zero without a sign.
fn number(value: f64) -> String {
    (value + 0.0).to_string()
}
