//! Tests that a table that was written as text is read back unchanged.

use palpate_study::{Rows, Table};

#[test]
fn any_text_reads_back_the_same() {
    let fields = [
        "plain",
        "",
        "a, b",
        "say \"x\"",
        "two\nlines",
        "cr\r",
        "\"",
        "µ",
    ];
    let mut table = Table::new(fields.map(str::to_owned));
    table.rows.push(fields.map(str::to_owned).to_vec());
    table.push(3, [-0.0, 1e-300, 0.1, 5.0, 6.0, 7.0, 8.0]);
    let csv = table.to_csv();
    let mut rows = Rows::new(csv.as_bytes(), true);
    assert_eq!(rows.header().unwrap(), fields);
    assert_eq!(rows.next_row().unwrap().unwrap().1, fields.as_slice());
    let (_, row) = rows.next_row().unwrap().unwrap();
    assert_eq!((&row[0], &row[1], &row[3]), ("3", "0", "0.1"));
    assert_eq!(row[2].parse(), Ok(1e-300));
    assert!(rows.next_row().unwrap().is_none());
}
