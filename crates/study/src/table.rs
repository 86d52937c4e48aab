//! Tables that results are written as.

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
    pub fn push(&mut self, index: usize, numbers: impl IntoIterator<Item = f64>) {
        let index = std::iter::once(index.to_string());
        self.rows
            .push(index.chain(numbers.into_iter().map(number)).collect());
    }

    /// A row of numbers, likewise.
    pub fn push_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.rows.push(numbers.into_iter().map(number).collect());
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

/// Text of a number in the shortest form that reads back the same; zero without a sign.
pub fn number(value: f64) -> String {
    (value + 0.0).to_string()
}
