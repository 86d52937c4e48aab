//! Frames from PNG files.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, ImageError};

use super::{Frame, RecordedError, RecordedFile};

/// Largest side of a frame, px. Larger frames are rejected before they are decoded.
const LARGEST_SIDE: u32 = 8192;

/// Signature that every PNG file begins with.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Reads a frame from a file, as [`parse_frame`].
///
/// # Errors
/// Errors of [`parse_frame`], and of a file that cannot be read.
pub fn read_frame(path: &Path) -> Result<Frame, RecordedError> {
    parse_frame(&RecordedFile::read(path)?)
}

/// Decodes a frame as 8-bit RGB. Images with 16 bits, grey levels or a palette are converted. An alpha channel is
/// allowed if no pixel is transparent, because transparent pixels have no colour.
///
/// # Errors
/// [`RecordedError::File`] if the file is no PNG image, or is broken, larger than 8192 px to a side, or transparent.
pub fn parse_frame(file: &RecordedFile) -> Result<Frame, RecordedError> {
    if file.bytes.is_empty() {
        return Err(file.error("is empty; a PNG image is needed"));
    }
    if !file.bytes.starts_with(&SIGNATURE) {
        return Err(file.error("is not a PNG image"));
    }
    let broken =
        |error: ImageError| file.error(format!("is a broken or truncated PNG image: {error}"));
    let decoder = PngDecoder::new(Cursor::new(&file.bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(file.error(format!(
            "has {width} x {height} px; at most {LARGEST_SIDE} x {LARGEST_SIDE} are read"
        )));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(broken)?;
    if image.color().has_alpha()
        && image
            .to_rgba16()
            .pixels()
            .any(|pixel| pixel.0[3] != u16::MAX)
    {
        return Err(file.error(
            "has transparent pixels, which have no colour; flatten it or drop its alpha channel",
        ));
    }
    Ok(Frame {
        file: file.name.clone(),
        image: image.into_rgb8(),
    })
}
