//! The lossy compression of an image file, read from the file's headers.

use std::io::Cursor;

use image::ImageFormat;
use tiff::decoder::Decoder;
use tiff::tags::{CompressionMethod, Tag};

/// Lossy compression of a frame, which moves and colours the edges of markers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compression {
    /// Name of the format, such as JPEG.
    pub format: &'static str,
    /// Quality of a JPEG file, from 1 to 100; `None` for other formats, and if the file does not contain the luminance
    /// quantisation table.
    pub quality: Option<f64>,
    /// Whether the file stores the colours with a lower resolution than the brightness, as in JPEG 4:2:0.
    pub subsamples_colours: bool,
}

impl Compression {
    /// The lossy compression of a file in this format; `None` if the file stores all pixels exactly.
    pub(crate) fn of(format: ImageFormat, bytes: &[u8]) -> Option<Self> {
        let unknown = |format| Self {
            format,
            quality: None,
            subsamples_colours: true,
        };
        match format {
            ImageFormat::Jpeg => Some(jpeg(bytes)),
            ImageFormat::WebP if bytes.get(12..16) == Some(b"VP8 ") => Some(unknown("lossy WebP")),
            ImageFormat::Tiff if holds_jpeg(bytes) => Some(unknown("JPEG in TIFF")),
            _ => None,
        }
    }
}

/// Whether the pixels of a TIFF file are compressed as JPEG.
fn holds_jpeg(bytes: &[u8]) -> bool {
    let jpeg = [CompressionMethod::JPEG, CompressionMethod::ModernJPEG].map(|one| one.to_u16());
    let method = Decoder::new(Cursor::new(bytes))
        .and_then(|mut file| file.find_tag_unsigned(Tag::Compression));
    method.is_ok_and(|method| method.is_some_and(|one: u16| jpeg.contains(&one)))
}

/// Sum of the entries of the standard luminance quantisation table, which belongs to quality 50 (ITU-T T.81, table
/// K.1).
const LUMINANCE_AT_50: f64 = 3688.0;

/// Compression of a JPEG file. Its quality (as in libjpeg) is computed from the luminance quantisation table.
fn jpeg(bytes: &[u8]) -> Compression {
    let mut found = Compression {
        format: "JPEG",
        quality: None,
        subsamples_colours: false,
    };
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let [_, marker, high, low, ref data @ ..] = *rest {
        match (marker, data) {
            (0xdb, [0, steps @ ..]) if steps.len() >= 64 => {
                let sum: f64 = steps[..64].iter().map(|&step| f64::from(step)).sum();
                let share = sum / LUMINANCE_AT_50;
                let quality = if share <= 1.0 {
                    100.0 - 50.0 * share
                } else {
                    50.0 / share
                };
                found.quality = Some(libm::round(quality));
            }
            // The frame header of a JPEG file states the sampling factors of the brightness and of the two colours.
            (0xc0..=0xc2, [_, _, _, _, _, 3, _, light, _, _, blue, _, _, red, ..]) => {
                found.subsamples_colours = light != blue || light != red;
            }
            (0xda, _) => break,
            _ => {}
        }
        let length = usize::from(u16::from_be_bytes([high, low]));
        rest = rest.get(2 + length..).unwrap_or_default();
    }
    found
}
