//! An image of the difference between two frames.

use std::num::NonZeroU8;

use image::{Rgb, RgbImage};

/// Image of the signed difference between the green channels of two frames, as in Fig. 7b of the 2020 paper. A pixel
/// without a difference is white. A pixel with more green light in the pressed frame is green. A pixel with less green
/// light is magenta, the complementary colour of green. A difference of `full_levels` levels (of 255) or more has the
/// full colour. `None` if the frames have different sizes.
///
/// ```
/// use std::num::NonZeroU8;
///
/// use image::{Rgb, RgbImage};
/// use palpate_tracking::difference;
///
/// let rest = RgbImage::from_pixel(2, 1, Rgb([90, 100, 90]));
/// let mut pressed = rest.clone();
/// pressed.put_pixel(1, 0, Rgb([90, 50, 90]));
/// let picture = difference(&rest, &pressed, NonZeroU8::MAX).unwrap();
/// // White where nothing changed. A loss of 50 levels of green lowers the green of the white by 50 levels.
/// assert_eq!(picture.get_pixel(0, 0).0, [255, 255, 255]);
/// assert_eq!(picture.get_pixel(1, 0).0, [255, 205, 255]);
/// ```
pub fn difference(rest: &RgbImage, pressed: &RgbImage, full_levels: NonZeroU8) -> Option<RgbImage> {
    if rest.dimensions() != pressed.dimensions() {
        return None;
    }
    let full = i32::from(full_levels.get());
    let mut picture = rest.clone();
    for (pixel, after) in picture.pixels_mut().zip(pressed.pixels()) {
        let more = i32::from(after.0[1]) - i32::from(pixel.0[1]);
        let share = (more.abs() * 255 / full).min(255);
        let left = 255 - u8::try_from(share).unwrap_or(u8::MAX);
        *pixel = if more > 0 {
            Rgb([left, 255, left])
        } else {
            Rgb([255, left, 255])
        };
    }
    Some(picture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_green_and_less_is_magenta() {
        let frame =
            |greens: [u8; 4]| RgbImage::from_fn(4, 1, |x, _| Rgb([x as u8, greens[x as usize], 9]));
        let full = NonZeroU8::new(100).expect("is 100");
        let picture = difference(&frame([50, 50, 50, 0]), &frame([50, 100, 30, 200]), full);
        let colours: Vec<[u8; 3]> = picture
            .expect("same size")
            .pixels()
            .map(|one| one.0)
            .collect();
        let expected = [
            [255, 255, 255],
            [128, 255, 128],
            [255, 204, 255],
            [0, 255, 0],
        ];
        assert_eq!(colours, expected);
    }

    #[test]
    fn frames_of_different_sizes_are_refused() {
        let [one, other] = [RgbImage::new(0, 0), RgbImage::new(2, 1)];
        assert_eq!(difference(&one, &other, NonZeroU8::MAX), None);
        assert!(difference(&one, &one, NonZeroU8::MAX).is_some());
    }
}
