//! Reads and writes image files: decodes camera frames, reports their lossy compression, and encodes images as PNG.
//!
//! The crate `image` has generic functions that process each pixel. They are compiled here, in the crate `frames`, with
//! optimisation; the other code of `image` is not optimised.

use std::io::Cursor;

use image::codecs::png::PngEncoder;
use image::imageops::thumbnail;
use image::{GenericImageView, ImageError, ImageFormat, RgbImage};
use thiserror::Error;
use tiff::decoder::Decoder;
use tiff::tags::{CompressionMethod, Tag};

/// Largest side of a frame, px.
const LARGEST_SIDE: u32 = 8192;

const FORMATS: [(ImageFormat, &str); 5] = [
    (ImageFormat::Png, "PNG"),
    (ImageFormat::Jpeg, "JPEG"),
    (ImageFormat::Bmp, "BMP"),
    (ImageFormat::Tiff, "TIFF"),
    (ImageFormat::WebP, "WebP"),
];

/// Byte sequences in a JPEG file: the marker at the start of a scan (the compressed pixels) and the marker at the end
/// of the image.
const SCAN: &[u8] = b"\xff\xda";
const END: &[u8] = b"\xff\xd9";

/// Reason why a file cannot be decoded.
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
    /// The colours of the pixels were reduced to those of a palette.
    #[error(
        "has a palette of at most 256 colours, which changes the colours of the markers; save it with all colours"
    )]
    Palette,
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

/// Decodes an image as 8-bit RGB. Images with 16 bits or grey levels are converted. Colours from a palette are an error,
/// because they differ from the colours of the markers. Transparent pixels are an error, because they have no colour. An alpha channel without transparent pixels is allowed.
///
/// # Errors
/// [`FrameError`] if the bytes are no PNG, JPEG, BMP, TIFF or WebP image, if the image is broken or truncated, if a
/// side is longer than 8192 px, or if a pixel is transparent.
pub fn decode(bytes: &[u8]) -> Result<(RgbImage, Option<Compression>), FrameError> {
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
    let is_indexed = match format {
        ImageFormat::Png => bytes.get(25) == Some(&3),
        ImageFormat::Bmp => bytes.get(28).is_some_and(|&bits| bits <= 8),
        _ => false,
    };
    let image = image.into_rgb8();
    let mut pixels = image.pixels();
    if is_indexed && pixels.any(|pixel| pixel.0[0] != pixel.0[1] || pixel.0[1] != pixel.0[2]) {
        return Err(FrameError::Palette);
    }
    Ok((image, Compression::of(format, bytes)))
}

/// Encodes an image as PNG. If `size` is given, the image is first reduced to this width and height; each pixel then has
/// the mean colour of the pixels that it covers.
///
/// # Errors
/// The error of the encoder if the image has no pixels.
pub fn png(image: &RgbImage, size: Option<[u32; 2]>) -> Result<Vec<u8>, ImageError> {
    let reduced = size.map(|[width, height]| thumbnail(image, width, height));
    let image = reduced.as_ref().unwrap_or(image);
    let mut bytes = Cursor::new(Vec::new());
    image.write_with_encoder(PngEncoder::new(&mut bytes))?;
    Ok(bytes.into_inner())
}

/// Lossy compression of a frame. It shifts the edges of markers and changes their colours.
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
    fn of(format: ImageFormat, bytes: &[u8]) -> Option<Self> {
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

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
