//! Image files: decodes frames with their lossy compression, and encodes images as PNG.
//!
//! The code of `image` that runs for each pixel is compiled with full optimisation only in this crate.

mod compression;
mod decode;

pub use compression::Compression;
pub use decode::{Decoded, FrameError, decode, png, reduced};
