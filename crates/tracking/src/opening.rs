//! Morphological opening of a grey image by a square (minimum filter, then maximum filter). The top-hat transform is
//! the image minus its opening.
//!
//! The minimum over `n` pixels is the smaller of the minima over two windows of `n/2` pixels. So the window is doubled
//! until two overlapping windows cover `n` pixels. For rows and for columns, the image is compared with a shifted copy
//! of itself. This needs no transposed image, and the compiler can use vector instructions.

#[derive(Clone, Debug, Default)]
pub(crate) struct Opening {
    here: Vec<u8>,
    there: Vec<u8>,
    padded: Vec<u8>,
}

impl Opening {
    /// The opening of a grey image by a square of `2 half + 1` pixels a side. The rows of the image `plane` have
    /// `width` bytes. The square is moved over the image, but its middle is placed only at pixels for which `middles`
    /// is true. Pixels for which `inside` is false are ignored, and their results must not be used.
    pub(crate) fn open(
        &mut self,
        plane: &[u8],
        width: usize,
        inside: &[bool],
        middles: &[bool],
        half: usize,
    ) -> &[u8] {
        self.here.clear();
        self.here.extend(
            plane
                .iter()
                .zip(inside)
                .map(|(&value, &inside)| if inside { value } else { u8::MAX }),
        );
        self.pass::<Least>(width, half);
        for (value, &middle) in self.here.iter_mut().zip(middles) {
            *value = if middle { *value } else { 0 };
        }
        self.pass::<Greatest>(width, half);
        &self.here
    }

    fn pass<E: Extreme>(&mut self, width: usize, half: usize) {
        let pitch = width + 2 * half;
        self.padded.clear();
        self.padded.resize(half * pitch + half, E::NEUTRAL);
        for row in self.here.chunks_exact(width) {
            self.padded.extend_from_slice(row);
            self.padded.resize(self.padded.len() + 2 * half, E::NEUTRAL);
        }
        self.padded
            .resize(self.padded.len() + half * pitch, E::NEUTRAL);
        slide::<E>(&mut self.padded, &mut self.there, pitch, 2 * half + 1);
        slide::<E>(&mut self.padded, &mut self.there, 1, 2 * half + 1);
        for (row, padded) in self
            .here
            .chunks_exact_mut(width)
            .zip(self.padded.chunks(pitch))
        {
            row.copy_from_slice(&padded[..width]);
        }
    }
}

/// Replaces every element of `line` by the minimum or maximum of `window` elements: the element itself, and the
/// elements that follow at the distances `stride`, `2 stride` and so on. Then removes the last `stride (window - 1)`
/// elements, which have too few elements after them.
fn slide<E: Extreme>(line: &mut Vec<u8>, spare: &mut Vec<u8>, stride: usize, window: usize) {
    let mut have = 1;
    while have < window {
        let step = have.min(window - have);
        let left = line.len() - step * stride;
        spare.clear();
        spare.extend(
            line[..left]
                .iter()
                .zip(&line[step * stride..])
                .map(|(&a, &b)| E::of(a, b)),
        );
        std::mem::swap(line, spare);
        have += step;
    }
}

trait Extreme {
    const NEUTRAL: u8;
    fn of(a: u8, b: u8) -> u8;
}

struct Least;
struct Greatest;

impl Extreme for Least {
    const NEUTRAL: u8 = u8::MAX;
    fn of(a: u8, b: u8) -> u8 {
        a.min(b)
    }
}

impl Extreme for Greatest {
    const NEUTRAL: u8 = 0;
    fn of(a: u8, b: u8) -> u8 {
        a.max(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The opening, computed directly from its definition. The value of a square is the smallest brightness in the
    /// square. The opening at a pixel is the largest value of all squares that contain the pixel and have their middle
    /// at a pixel marked in `middles`.
    fn by_definition(
        plane: &[u8],
        width: usize,
        inside: &[bool],
        middles: &[bool],
        half: usize,
    ) -> Vec<u8> {
        let height = plane.len() / width;
        let square = |at: usize| {
            let (x, y) = (at % width, at / width);
            (y.saturating_sub(half)..(y + half + 1).min(height)).flat_map(move |row| {
                (x.saturating_sub(half)..(x + half + 1).min(width))
                    .map(move |column| row * width + column)
            })
        };
        let least = |at| {
            let values = square(at).filter(|&at| inside[at]).map(|at| plane[at]);
            values.min().unwrap_or(255)
        };
        let eroded: Vec<u8> = (0..plane.len()).map(least).collect();
        let greatest = |at| {
            let values = square(at).filter(|&at| middles[at]).map(|at| eroded[at]);
            values.max().unwrap_or(0)
        };
        (0..plane.len()).map(greatest).collect()
    }

    #[test]
    fn doubling_is_the_definition() {
        let (width, height) = (37, 23);
        let plane: Vec<u8> = (0..width * height)
            .map(|at| ((at * 7919 + at * at * 31) % 251) as u8)
            .collect();
        let disc = |square: usize| -> Vec<bool> {
            (0..width * height)
                .map(|at: usize| {
                    (at % width).abs_diff(18).pow(2) + (at / width).abs_diff(11).pow(2) < square
                })
                .collect()
        };
        let (inside, middles) = (disc(140), disc(180));
        for half in [0, 1, 2, 3, 6, 11, 40] {
            let mut opening = Opening::default();
            let opened = opening.open(&plane, width, &inside, &middles, half);
            let expected = by_definition(&plane, width, &inside, &middles, half);
            for at in (0..plane.len()).filter(|&at| inside[at]) {
                assert_eq!(opened[at], expected[at], "half {half} at {at}");
            }
        }
    }
}
