//! Tables of the markers that were tracked from rest to press.

use palpate_study::{Column, Table, number};
use palpate_tracking::Track;

/// Table with one row per marker. The row contains the marker's position and hues at rest. For a marker that is new in
/// the press, it contains them in the press. If the marker was tracked, the row also contains the changes from rest to
/// press. Columns for values that were not measured stay empty.
pub fn tracks_table<'a>(tracks: impl Iterator<Item = Option<&'a Track>>) -> Table {
    let mut table = Table::new([
        Column::count("marker"),
        Column::number("x_px", "px"),
        Column::number("y_px", "px"),
        Column::number("hue_turns", "turn"),
        Column::number("dx_px", "px"),
        Column::number("dy_px", "px"),
        Column::number("dhue_turns", "turn"),
        Column::text("status"),
        Column::number("mean_hue_turns", "turn"),
        Column::number("dmean_hue_turns", "turn"),
    ]);
    for (marker, track) in tracks.enumerate() {
        let image = track.and_then(|track| track.rest.or(track.pressed));
        let change = track.and_then(Track::change);
        let text = |one: Option<f64>| one.map_or_else(String::new, number);
        let numbers = [
            image.map(|image| image.centroid_px[0]),
            image.map(|image| image.centroid_px[1]),
            image.map(|image| image.hue_turns),
            change.map(|change| change.shift_px[0]),
            change.map(|change| change.shift_px[1]),
            change.map(|change| change.hue_turns),
        ];
        let status = track.map_or("not-seen", |track| track.status.name());
        let mut row = vec![marker.to_string()];
        row.extend(numbers.map(text));
        row.push(status.to_owned());
        row.push(text(image.map(|image| image.mean_hue_turns)));
        row.push(text(change.and_then(|_| track?.mean_hue_change())));
        table.rows.push(row);
    }
    table
}
