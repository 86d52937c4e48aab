//! Makes readings and camera frames from numbers in memory instead of files.

use image::RgbImage;
use palpate_recorded::{Frame, RecordedFile};
use palpate_study::{Column, Table};

/// Makes a table of readings from the column names in `header` and from rows of numbers, in the form that the functions
/// of [`recorded`](crate::recorded) accept. Error messages use `file` as the file's name.
///
/// ```
/// use palpate::recorded::PressRecording;
///
/// // Three markers of a sensor that is pressed by 1 mm.
/// let header = ["x_mm", "y_mm", "normal_displacement_mm"];
/// let markers = [[0.0, 0.0, 1.0], [2.0, 0.0, 0.8], [0.0, 2.0, 0.8]];
/// let readings = PressRecording::try_from(palpate::readings("a press", header, &markers))?;
/// assert!(!readings.has_tangential());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn readings<const N: usize>(file: &str, header: [&str; N], rows: &[[f64; N]]) -> RecordedFile {
    let mut table = Table::new(Column::pure(header));
    for row in rows {
        table.push_numbers(*row);
    }
    RecordedFile::new(file, table.to_csv().into_bytes())
}

/// Makes a camera frame from pixels. `rgb` has three bytes (red, green, blue) for each pixel, row by row from the top
/// left. Error messages use `file` as the frame's name. `None` if the number of pixels is not `width` times `height`.
///
/// ```
/// use palpate::{frame, recorded};
///
/// // Two frames without a marker.
/// let [rest, pressed] = ["rest", "pressed"].map(|name| frame(name, 64, 48, vec![90; 3 * 64 * 48]));
/// let [rest, pressed] = [rest, pressed].map(|frame| frame.ok_or("too few pixels"));
/// let error = recorded::track_frames(&rest?, &pressed?).expect_err("nothing to track");
/// assert!(error.to_string().starts_with("rest: "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn frame(file: &str, width: u32, height: u32, rgb: Vec<u8>) -> Option<Frame> {
    let pixels = u64::from(width) * u64::from(height);
    let image = RgbImage::from_raw(width, height, rgb)?;
    (image.as_raw().len() as u64 == 3 * pixels).then(|| Frame {
        file: file.to_owned(),
        image,
        compression: None,
    })
}
