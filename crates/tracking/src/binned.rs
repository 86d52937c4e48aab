//! A frame made coarser: sums over squares of pixels, in which markers are looked for.

use image::RgbImage;

/// The largest side of a square: the sum of 16² bytes still fits into 16 bits.
pub(crate) const LARGEST_BIN: usize = 16;

/// Sums of red, green and blue over squares of `bin` by `bin` pixels, row by row. What is left over at the right and at
/// the bottom is not covered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Binned {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) bin: usize,
    pub(crate) sums: Vec<[u16; 3]>,
    columns: Vec<u16>,
}

impl Binned {
    /// Reads a frame of at least one square.
    pub(crate) fn read(&mut self, frame: &RgbImage, bin: usize) {
        let row = frame.width() as usize * 3;
        self.bin = bin;
        self.width = frame.width() as usize / bin;
        self.height = frame.height() as usize / bin;
        self.sums.clear();
        self.sums.reserve(self.width * self.height);
        for rows in frame.as_raw().chunks_exact(row * bin).take(self.height) {
            self.columns.clear();
            self.columns.resize(row, 0);
            for line in rows.chunks_exact(row) {
                for (sum, &byte) in self.columns.iter_mut().zip(line) {
                    *sum += u16::from(byte);
                }
            }
            match bin {
                1 => across::<1>(&self.columns, &mut self.sums),
                2 => across::<2>(&self.columns, &mut self.sums),
                3 => across::<3>(&self.columns, &mut self.sums),
                4 => across::<4>(&self.columns, &mut self.sums),
                _ => self
                    .sums
                    .extend(self.columns.chunks_exact(3 * bin).map(colours)),
            }
        }
    }

    /// Pixels in a square.
    pub(crate) fn pixels(&self) -> usize {
        self.bin * self.bin
    }
}

fn across<const BIN: usize>(columns: &[u16], sums: &mut Vec<[u16; 3]>) {
    let pixels = columns.as_chunks::<3>().0;
    sums.extend(pixels.as_chunks::<BIN>().0.iter().map(|square| {
        let mut sum = [0; 3];
        for pixel in square {
            for (sum, value) in sum.iter_mut().zip(pixel) {
                *sum += value;
            }
        }
        sum
    }));
}

fn colours(square: &[u16]) -> [u16; 3] {
    let mut sum = [0; 3];
    for pixel in square.chunks_exact(3) {
        for (sum, value) in sum.iter_mut().zip(pixel) {
            *sum += value;
        }
    }
    sum
}
