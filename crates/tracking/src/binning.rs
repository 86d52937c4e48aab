//! A frame at lower resolution, in which the finder searches for markers. Each of its points is the sum over a bin,
//! which is a square of pixels.

use image::RgbImage;

/// Largest side of a bin, px. The limit ensures that the sum over a bin fits into 16 bits.
pub(crate) const LARGEST_BIN: usize = 16;

/// Sums of red, green and blue over bins (squares of `bin` by `bin` pixels), row by row. Pixels at the right and bottom
/// edges that do not fill a complete bin are ignored.
#[derive(Clone, Debug, Default)]
pub(crate) struct BinnedFrame {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) bin: usize,
    pub(crate) sums: Vec<[u16; 3]>,
    columns: Vec<u16>,
}

impl BinnedFrame {
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
                // Call a separate function for each size of a bin, because the loop over the pixels of a bin is faster
                // if the size is a compile-time constant.
                1 => add_row::<1>(&self.columns, &mut self.sums),
                2 => add_row::<2>(&self.columns, &mut self.sums),
                3 => add_row::<3>(&self.columns, &mut self.sums),
                4 => add_row::<4>(&self.columns, &mut self.sums),
                _ => {
                    let squares = self.columns.as_chunks::<3>().0.chunks_exact(bin);
                    self.sums.extend(squares.map(colour_sum));
                }
            }
        }
    }

    pub(crate) fn pixels(&self) -> usize {
        self.bin * self.bin
    }
}

fn add_row<const BIN: usize>(columns: &[u16], sums: &mut Vec<[u16; 3]>) {
    let squares = columns.as_chunks::<3>().0.as_chunks::<BIN>().0;
    sums.extend(squares.iter().map(|square| colour_sum(square)));
}

#[inline(always)]
fn colour_sum(square: &[[u16; 3]]) -> [u16; 3] {
    let mut sum = [0; 3];
    for pixel in square {
        for (sum, value) in sum.iter_mut().zip(pixel) {
            *sum += value;
        }
    }
    sum
}
