//! Tables that a scene writes.

/// A table with a header, to be written as CSV.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Column names, units appended.
    pub header: Vec<String>,
    /// Rows of as many fields.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(header: impl IntoIterator<Item = String>) -> Self {
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

    /// A row that begins with a whole number and ends with a word; what is not known is empty.
    pub(crate) fn push_sight(
        &mut self,
        index: usize,
        numbers: impl IntoIterator<Item = Option<f64>>,
        word: &str,
    ) {
        let numbers = numbers
            .into_iter()
            .map(|one| one.map_or_else(String::new, number));
        let index = std::iter::once(index.to_string());
        let word = std::iter::once(word.to_owned());
        self.rows.push(index.chain(numbers).chain(word).collect());
    }

    /// The table as CSV text.
    pub fn to_csv(&self) -> String {
        let mut text = self.header.join(",");
        text.push('\n');
        for row in &self.rows {
            text.push_str(&row.join(","));
            text.push('\n');
        }
        text
    }
}

/// A number in the shortest form that reads back the same; zero without a sign.
fn number(value: f64) -> String {
    (value + 0.0).to_string()
}
