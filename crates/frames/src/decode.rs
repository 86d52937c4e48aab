//! Image files to pixels, and pixels to PNG files.

use std::io::Cursor;

use image::codecs::png::PngEncoder;
use image::imageops::thumbnail;
use image::{GenericImageView, ImageError, ImageFormat, RgbImage};
use thiserror::Error;

use crate::Compression;

/// Largest side of a frame, px.
const LARGEST_SIDE: u32 = 8192;

const FORMATS: [(ImageFormat, &str); 5] = [
    (ImageFormat::Png, "PNG"),
    (ImageFormat::Jpeg, "JPEG"),
    (ImageFormat::Bmp, "BMP"),
    (ImageFormat::Tiff, "TIFF"),
    (ImageFormat::WebP, "WebP"),
];

/// Byte sequences in a JPEG file: the marker of a scan and the marker of the image's end.
const SCAN: &[u8] = b"\xff\xda";
const END: &[u8] = b"\xff\xd9";

/// The contents of an image file.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// Pixels of the image.
    pub image: RgbImage,
    /// Lossy compression of the file; `None` if the file's format stores all pixels exactly.
    pub compression: Option<Compression>,
}

/// Reason why the bytes of a file are no frame.
#[derive(Debug, Error)]
pub enum FrameError {
    /// The file has no bytes.
    #[error("is empty; an image is needed")]
    Empty,
    /// The file has none of the formats that can be decoded.
    #[error("is not a PNG, JPEG, BMP, TIFF or WebP image")]
    Format,
    /// The image is too large to be decoded.
    #[error("has too many pixels; at most {LARGEST_SIDE} px per side are accepted")]
    Pixels,
    /// A side of the image is too long.
    #[error("has {width} x {height} px; at most {LARGEST_SIDE} px per side are accepted")]
    Side {
        /// Number of columns.
        width: u32,
        /// Number of rows.
        height: u32,
    },
    /// The end of a JPEG file is missing.
    #[error("is a truncated JPEG image: the marker of its end is missing")]
    Truncated,
    /// The decoder cannot decode the file.
    #[error("is a broken or truncated {format} image: {source}")]
    Broken {
        /// Name of the format.
        format: &'static str,
        /// The error of the decoder.
        source: ImageError,
    },
    /// At least one pixel is transparent.
    #[error("has transparent pixels, which have no colour; flatten it or drop its alpha channel")]
    Transparent,
}

/// Decodes an image as 8-bit RGB. Images with 16 bits, grey levels or a palette are converted. Transparent pixels are an
/// error, because they have no colour. An alpha channel without transparent pixels is allowed.
///
/// # Errors
/// [`FrameError`] if the bytes are no PNG, JPEG, BMP, TIFF or WebP image, if the image is broken or truncated, if a side
/// is longer than 8192 px, or if a pixel is transparent.
pub fn decode(bytes: &[u8]) -> Result<Decoded, FrameError> {
    if bytes.is_empty() {
        return Err(FrameError::Empty);
    }
    let format = image::guess_format(bytes).ok();
    let format = FORMATS.into_iter().find(|(one, _)| Some(*one) == format);
    let (format, name) = format.ok_or(FrameError::Format)?;
    let scan = bytes.windows(2).rposition(|bytes| bytes == SCAN);
    let scan = &bytes[scan.unwrap_or_default()..];
    // Check for the byte sequence that ends a JPEG image. If the image is truncated, the decoder returns no error but
    // fills the missing part with grey.
    if format == ImageFormat::Jpeg && !scan.windows(2).any(|bytes| bytes == END) {
        return Err(FrameError::Truncated);
    }
    let image = image::load_from_memory_with_format(bytes, format);
    let image = image.map_err(|error| match error {
        ImageError::Limits(_) => FrameError::Pixels,
        source => FrameError::Broken {
            format: name,
            source,
        },
    })?;
    let (width, height) = image.dimensions();
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(FrameError::Side { width, height });
    }
    if image.color().has_alpha()
        && image
            .to_rgba16()
            .pixels()
            .any(|pixel| pixel.0[3] != u16::MAX)
    {
        return Err(FrameError::Transparent);
    }
    Ok(Decoded {
        image: image.into_rgb8(),
        compression: Compression::of(format, bytes),
    })
}

/// Encodes an image as PNG.
///
/// # Errors
/// The error of the encoder, for an image without pixels.
pub fn png(image: &RgbImage) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_with_encoder(PngEncoder::new(&mut bytes))?;
    Ok(bytes.into_inner())
}

/// Reduces an image to another size, px. A reduced pixel has the mean colour of the pixels that it covers.
pub fn reduced(image: &RgbImage, [width, height]: [u32; 2]) -> RgbImage {
    thumbnail(image, width, height)
}
