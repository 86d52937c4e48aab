//! Frames from PNG files.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Error, anyhow};
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, RgbImage};
use palpate_scene::recorded::Frame;

use crate::failure::Failure;

/// Frames with more pixels to a side are refused by their header.
const LARGEST_SIDE: u32 = 8192;

/// What every PNG file begins with.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Reads a frame as 8-bit RGB. Of 16 bits the upper 8 count, grey and palettes become RGB; an alpha channel is allowed if
/// nothing is transparent, for what is has no colour.
pub(super) fn read_frame(path: &Path) -> Result<Frame, Failure> {
    let file = path.display().to_string();
    let read = || -> Result<RgbImage, Error> {
        let bytes = std::fs::read(path)?;
        if bytes.is_empty() {
            return Err(anyhow!("is empty; a PNG image is needed"));
        }
        if !bytes.starts_with(&SIGNATURE) {
            return Err(anyhow!("is not a PNG image"));
        }
        decode(&bytes)
    };
    let image = read().with_context(|| file.clone());
    let image = image.map_err(Failure::work)?;
    Ok(Frame { file, image })
}

fn decode(bytes: &[u8]) -> Result<RgbImage, Error> {
    let broken = "is a broken or truncated PNG image";
    let decoder = PngDecoder::new(Cursor::new(bytes)).context(broken)?;
    let (width, height) = decoder.dimensions();
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(anyhow!(
            "has {width} x {height} px; at most {LARGEST_SIDE} x {LARGEST_SIDE} are read"
        ));
    }
    let image = DynamicImage::from_decoder(decoder).context(broken)?;
    if image.color().has_alpha()
        && image
            .to_rgba16()
            .pixels()
            .any(|pixel| pixel.0[3] != u16::MAX)
    {
        return Err(anyhow!(
            "has transparent pixels, which have no colour; flatten it or drop its alpha channel"
        ));
    }
    Ok(image.into_rgb8())
}
