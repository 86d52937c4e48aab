//! Measures markers by sums over windows of pixels. The sums are linear in the pixels, so blur, noise, partly covered
//! pixels and uneven light cause no bias.

use image::RgbImage;
use palpate_statistics::saturated_hue;

use crate::Ground;
use crate::lighting::{Lighting, Local};
use crate::shapes::{Shape, Window};

/// Width (px) of the ring around a marker's window. The background around the marker is measured in this ring.
const RING_PX: i32 = 4;
/// Share of light that defines the edge of a marker. The edge lies outside of the connected shape that was recognised
/// as the marker. At the edge, the mean light of the pixels, averaged over several markers, falls below this share of
/// the light in the shape.
const END_SIGNAL: f64 = 0.004;
/// A pixel with a saturated colour counts for a marker's mean hue if its distance (px) from the marker's shape is at
/// most this number.
const HUE_REACH_PX: i32 = 2;
/// Number of markers from which [`Scene::reach`] is measured.
const SAMPLE_SIZE: usize = 12;
/// Smallest divisor if a number is divided by the brightness of the background, in levels (0 to 255). If the background
/// is darker, this value is the divisor.
const MIN_BRIGHTNESS: f32 = 8.0;
/// A background pixel is used only if its difference from the fitted light is at most this number plus 4 standard
/// deviations of the noise. The number is a share of the fitted light (bright background) or of full scale (dark
/// background).
const MAX_DIFFERENCE: f64 = 0.15;

/// Sums over the pixels of a window. The light of a pixel is the share of light that a marker absorbs from a bright
/// background or adds to a dark background.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) count: f64,
    /// Sum, over the pixels of the window, of a pixel's offset (px) from `middle`, the origin of all sums.
    pub(crate) place: [f64; 2],
    /// Sum over the pixels of the light of each colour. On a bright background, this light is the absorbed share of the
    /// background's light. On a dark background, it is the added light as a share of full scale.
    pub(crate) light: [f64; 3],
    /// First moment of the light of each colour about the origin `middle`, px: the sum, over all pixels, of a pixel's
    /// light multiplied by its offset.
    pub(crate) moment: [[f64; 2]; 3],
    /// Sums of red, green and blue over the pixels that determine the hue. On a bright background, these are all pixels
    /// of the window. On a dark background, they are the pixels of the shape, because the other pixels only add noise.
    pub(crate) hue_light: [f64; 3],
    /// Mean hue of the pixels with saturated colours in and around the shape, turns; `None` if there are no such
    /// pixels.
    pub(crate) mean_hue: Option<f64>,
    pub(crate) middle: [f64; 2],
    pub(crate) errors: PixelErrors,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelErrors {
    /// Sums of 1, x, y, x², xy and y² over the pixels of the window. Here x and y are the offsets of a pixel from
    /// `middle`.
    pub(crate) window: [f64; 6],
    /// Variance (squared share of light) of the noise of a pixel, for each colour.
    pub(crate) pixel: [f64; 3],
    /// Variance (squared share of light) of the error that all pixels of the window have in common, for each colour.
    pub(crate) common: [f64; 3],
    pub(crate) radius_px: f64,
}

pub(crate) struct Scene<'a> {
    pub(crate) frame: &'a RgbImage,
    pub(crate) ground: Ground,
    /// For each row of the frame, the first and the last column that belong to the sensor's image.
    pub(crate) rows: &'a [(i32, i32)],
    pub(crate) lighting: &'a Lighting,
    pub(crate) bin: usize,
    pub(crate) diameter_px: f64,
}

struct Patch {
    middle: [f64; 2],
    radius: f64,
    hull: Window,
    window: Window,
    surroundings: Window,
    neighbours: Vec<usize>,
    local: [Local; 3],
}

#[derive(Clone, Copy, PartialEq)]
enum Contested {
    Nearest,
    Nobody,
}

/// Difference between the background around a marker and the fitted light, as a share of the fitted light (bright
/// background) or of full scale (dark background).
#[derive(Clone, Copy, Default)]
struct Offset {
    share: [f64; 3],
    variance: [f64; 3],
    /// Variance of the error that remains in `share` after [`shrink`] has reduced `share`.
    left: [f64; 3],
}

impl Scene<'_> {
    /// For each shape: sums over the window of pixels around it, corrected for the difference between the fitted light
    /// and the actual background around the shape.
    pub(crate) fn measure(&self, shapes: &[Shape]) -> Vec<Sums> {
        let mut patches: Vec<Patch> = shapes.iter().map(|shape| self.patch(shape)).collect();
        let reach = self.reach(&mut patches);
        self.grow(&mut patches, reach);
        let mut sums: Vec<Sums> = (0..patches.len())
            .map(|at| self.sum(&patches, at))
            .collect();
        let mut offsets: Vec<Offset> = (0..patches.len())
            .map(|at| self.offset(&patches, at))
            .collect();
        shrink(&mut offsets);
        for (at, (sums, offset)) in sums.iter_mut().zip(&offsets).enumerate() {
            sums.errors = self.errors(&patches[at], offset);
            sums.mean_hue = self.mean_hue(&patches[at]);
            self.correct(sums, offset);
            sums.hue_light = match self.ground {
                Ground::Bright => sums.light,
                Ground::Dark => {
                    let (light, count) = self.core(&patches, at);
                    [0, 1, 2].map(|colour| light[colour] - offset.share[colour] * count)
                }
            };
        }
        sums
    }

    fn patch(&self, shape: &Shape) -> Patch {
        let bin = self.bin as f64;
        let middle = shape.form().middle.map(|at| at * bin + 0.5 * (bin - 1.0));
        let hull = Window::hull(shape, self.bin);
        Patch {
            middle,
            radius: (shape.area() as f64 / std::f64::consts::PI).sqrt() * bin,
            window: hull.clone(),
            surroundings: hull.clone(),
            hull,
            neighbours: Vec::new(),
            local: [0, 1, 2].map(|colour| self.lighting.about(middle, colour)),
        }
    }

    fn grow(&self, patches: &mut [Patch], reach: i32) {
        for patch in patches.iter_mut() {
            patch.window = patch.hull.grown(reach, self.rows);
            patch.surroundings = patch.hull.grown(reach + RING_PX, self.rows);
        }
        let mut order: Vec<usize> = (0..patches.len()).collect();
        order.sort_by_key(|&at| patches[at].surroundings.top);
        let mut near = vec![Vec::new(); patches.len()];
        for (place, &a) in order.iter().enumerate() {
            let bottom = patches[a].surroundings.top + patches[a].surroundings.rows.len() as i32;
            for &b in order[place + 1..]
                .iter()
                .take_while(|&&b| patches[b].surroundings.top < bottom)
            {
                if patches[a].surroundings.near(&patches[b].surroundings) {
                    near[a].push(b);
                    near[b].push(a);
                }
            }
        }
        for (patch, near) in patches.iter_mut().zip(near) {
            patch.neighbours = near;
        }
    }

    /// Distance (px) by which markers extend beyond the connected shapes that were recognised as markers. At this
    /// distance, the mean light of the pixels, averaged over several markers, falls below the share [`END_SIGNAL`] of
    /// the light in the shapes.
    fn reach(&self, patches: &mut [Patch]) -> i32 {
        let most = (0.4 * self.diameter_px).clamp(4.0, 16.0) as i32;
        self.grow(patches, most);
        let mut rings = vec![[0.0; 2]; (most + 1) as usize];
        let step = patches.len().div_ceil(SAMPLE_SIZE).max(1);
        for at in (0..patches.len()).step_by(step) {
            let patch = &patches[at];
            let mut inner: Option<Window> = None;
            for (reach, ring) in (0..).zip(&mut rings) {
                let outer = patch.hull.grown(reach, self.rows);
                self.for_each_pixel(
                    patches,
                    at,
                    &outer,
                    inner.as_ref(),
                    Contested::Nearest,
                    |_, _, light| {
                        let signal: f32 = light.iter().sum();
                        ring[0] += 1.0;
                        ring[1] += f64::from(signal);
                    },
                );
                inner = Some(outer);
            }
        }
        let mean = |ring: &[f64; 2]| {
            if ring[0] > 0.0 {
                ring[1] / ring[0]
            } else {
                0.0
            }
        };
        let last = rings.len() - 1;
        let rest = 0.5 * (mean(&rings[last]) + mean(&rings[last - 1]));
        let full = mean(&rings[0]) - rest;
        (1..last)
            .find(|&reach| mean(&rings[reach + 1]) - rest < END_SIGNAL * full)
            .map_or(most, |reach| reach as i32)
            .max(2)
    }

    /// Calls `pixel` for each pixel of the window `outer` that is not in the window `inner` and does not belong to a
    /// neighbouring marker. The arguments of `pixel` are the pixel's offset from the marker's middle (two numbers) and
    /// its shares of light.
    fn for_each_pixel(
        &self,
        patches: &[Patch],
        at: usize,
        outer: &Window,
        inner: Option<&Window>,
        contested: Contested,
        mut pixel: impl FnMut(f32, f32, [f32; 3]),
    ) {
        let patch = &patches[at];
        let width = self.frame.width() as usize;
        let mut rivals: Vec<(i32, i32, &Patch)> = Vec::new();
        for (row, &(first, last)) in (outer.top..).zip(&outer.rows) {
            if first > last {
                continue;
            }
            rivals.clear();
            rivals.extend(patch.neighbours.iter().filter_map(|&other| {
                let rival = &patches[other];
                let (left, right) = rival.window.row(row);
                (left <= last && right >= first).then_some((left, right, rival))
            }));
            let line = &self.frame.as_raw()[row as usize * width * 3..][..width * 3];
            let dy = f64::from(row) - patch.middle[1];
            let light = patch.local.map(|local| local.row(dy));
            let mut stretch = |first: i32, last: i32| {
                if first > last {
                    return;
                }
                let bytes = &line[first as usize * 3..(last + 1) as usize * 3];
                for (x, value) in (first..).zip(bytes.as_chunks::<3>().0) {
                    if rivals.iter().any(|&(left, right, rival)| {
                        (left..=right).contains(&x)
                            && (contested == Contested::Nobody || rival.is_nearer(patch, [x, row]))
                    }) {
                        continue;
                    }
                    let dx = (f64::from(x) - patch.middle[0]) as f32;
                    pixel(dx, dy as f32, self.shares(*value, &light, dx));
                }
            };
            let (left, right) = inner.map_or((i32::MAX, i32::MIN), |inner| inner.row(row));
            if left <= right {
                stretch(first, last.min(left - 1));
                stretch(first.max(right + 1), last);
            } else {
                stretch(first, last);
            }
        }
    }

    /// Red, green and blue light of a pixel. On a bright background: the share of the background's light that the pixel
    /// absorbs. On a dark background: the light that the pixel adds, as a share of full scale.
    fn shares(&self, value: [u8; 3], light: &[[f32; 3]; 3], dx: f32) -> [f32; 3] {
        let ground = light.map(|[constant, linear, square]| constant + dx * (linear + dx * square));
        match self.ground {
            Ground::Bright => {
                [0, 1, 2].map(|at| 1.0 - f32::from(value[at]) / ground[at].max(MIN_BRIGHTNESS))
            }
            Ground::Dark => [0, 1, 2].map(|at| (f32::from(value[at]) - ground[at]) * (1.0 / 255.0)),
        }
    }

    fn sum(&self, patches: &[Patch], at: usize) -> Sums {
        let mut sums = [0.0f32; 12];
        self.for_each_pixel(
            patches,
            at,
            &patches[at].window,
            None,
            Contested::Nearest,
            |dx, dy, light| {
                let terms = [
                    1.0,
                    dx,
                    dy,
                    light[0],
                    light[1],
                    light[2],
                    light[0] * dx,
                    light[1] * dx,
                    light[2] * dx,
                    light[0] * dy,
                    light[1] * dy,
                    light[2] * dy,
                ];
                for (sum, term) in sums.iter_mut().zip(terms) {
                    *sum += term;
                }
            },
        );
        let sums = sums.map(f64::from);
        Sums {
            count: sums[0],
            place: [sums[1], sums[2]],
            light: [sums[3], sums[4], sums[5]],
            moment: [0, 1, 2].map(|colour| [sums[6 + colour], sums[9 + colour]]),
            hue_light: [0.0; 3],
            mean_hue: None,
            middle: patches[at].middle,
            errors: PixelErrors::default(),
        }
    }

    /// Mean hue, in turns, of the pixels with saturated colours in and around a shape; `None` if there are no such
    /// pixels. The mean is arithmetic, not cyclic.
    fn mean_hue(&self, patch: &Patch) -> Option<f64> {
        let width = self.frame.width() as usize;
        let window = patch.hull.grown(HUE_REACH_PX, self.rows);
        let (mut sum, mut count) = (0.0, 0.0);
        for (row, &(first, last)) in (window.top..).zip(&window.rows) {
            if first > last {
                continue;
            }
            let line = &self.frame.as_raw()[row as usize * width * 3..][..width * 3];
            let pixels = &line[first as usize * 3..(last + 1) as usize * 3];
            for pixel in pixels.as_chunks::<3>().0 {
                if let Some(hue) = saturated_hue(pixel.map(f64::from)) {
                    sum += hue;
                    count += 1.0;
                }
            }
        }
        (count > 0.0).then(|| sum / count)
    }

    fn core(&self, patches: &[Patch], at: usize) -> ([f64; 3], f64) {
        let mut sums = [0.0f32; 4];
        self.for_each_pixel(
            patches,
            at,
            &patches[at].hull,
            None,
            Contested::Nearest,
            |_, _, light| {
                for (sum, term) in sums.iter_mut().zip([light[0], light[1], light[2], 1.0]) {
                    *sum += term;
                }
            },
        );
        let [red, green, blue, count] = sums.map(f64::from);
        ([red, green, blue], count)
    }

    /// Difference between the background in the ring around a window and the fitted light. The difference is computed
    /// twice: first without pixels that differ too much from the fitted light (see [`MAX_DIFFERENCE`]), then without
    /// pixels that differ too much from the first result.
    fn offset(&self, patches: &[Patch], at: usize) -> Offset {
        let patch = &patches[at];
        let mut ring: Vec<[f32; 3]> = Vec::new();
        self.for_each_pixel(
            patches,
            at,
            &patch.surroundings,
            Some(&patch.window),
            Contested::Nobody,
            |_, _, light| {
                ring.push(light);
            },
        );
        let noise = patch.local.map(|local| match self.ground {
            Ground::Bright => {
                self.lighting.noise / f64::from(local.row(0.0)[0].max(MIN_BRIGHTNESS))
            }
            Ground::Dark => self.lighting.noise / 255.0,
        });
        let (mut share, mut count) = ([0.0; 3], 0.0);
        for within in [MAX_DIFFERENCE, 0.01] {
            let mut sums = [0.0; 3];
            let mut used = 0.0;
            for light in &ring {
                let light = light.map(f64::from);
                if (0..3).all(|at| (light[at] - share[at]).abs() < within + 4.0 * noise[at]) {
                    used += 1.0;
                    for (sum, light) in sums.iter_mut().zip(light) {
                        *sum += light;
                    }
                }
            }
            if used > 0.0 {
                share = sums.map(|sum| sum / used);
                count = used;
            }
        }
        Offset {
            share,
            left: [0.0; 3],
            variance: noise.map(|noise| {
                if count > 0.0 {
                    (noise * noise).max(1e-12) / count
                } else {
                    f64::MAX
                }
            }),
        }
    }

    fn errors(&self, patch: &Patch, offset: &Offset) -> PixelErrors {
        // Pixel values are whole levels, so their noise is at least the rounding error, which has a variance of 1/12
        // levels².
        let noise = self.lighting.noise.max(1.0 / 12.0_f64.sqrt());
        PixelErrors {
            window: patch.window.moments(patch.middle),
            pixel: patch.local.map(|local| {
                let level = match self.ground {
                    Ground::Bright => f64::from(local.row(0.0)[0].max(MIN_BRIGHTNESS)),
                    Ground::Dark => 255.0,
                };
                (noise / level).powi(2)
            }),
            common: offset.left,
            radius_px: patch.radius,
        }
    }

    /// Corrects the sums for `offset`, the difference between the background around the marker and the fitted light.
    fn correct(&self, sums: &mut Sums, offset: &Offset) {
        for (colour, &share) in offset.share.iter().enumerate() {
            let scale = match self.ground {
                Ground::Bright => 1.0 / (1.0 - share),
                Ground::Dark => 1.0,
            };
            sums.light[colour] = scale * (sums.light[colour] - share * sums.count);
            for axis in [0, 1] {
                sums.moment[colour][axis] =
                    scale * (sums.moment[colour][axis] - share * sums.place[axis]);
            }
        }
    }
}

impl Patch {
    /// Whether the pixel `[x, y]` is nearer to this marker than to the marker `other`. The distance from each marker's
    /// middle is divided by the marker's radius.
    fn is_nearer(&self, other: &Self, [x, y]: [i32; 2]) -> bool {
        let [mine, theirs] = [self, other].map(|patch| {
            let [dx, dy] = [
                f64::from(x) - patch.middle[0],
                f64::from(y) - patch.middle[1],
            ];
            (dx * dx + dy * dy) / (patch.radius * patch.radius)
        });
        mine < theirs
    }
}

/// Reduces the noise of `offsets` (empirical Bayes shrinkage): multiplies each difference by the variance of the true
/// differences, divided by the total variance including noise. In an evenly lit frame, this factor is small. The
/// differences are then mostly noise, because the fitted light is more accurate than the mean of the few pixels around
/// a marker.
fn shrink(offsets: &mut [Offset]) {
    for colour in 0..3 {
        let (mut square, mut noise, mut count) = (0.0, 0.0, 0.0);
        for offset in offsets
            .iter()
            .filter(|offset| offset.variance[colour] < f64::MAX)
        {
            square += offset.share[colour].powi(2);
            noise += offset.variance[colour];
            count += 1.0;
        }
        let spread = if count > 0.0 {
            ((square - noise) / count).max(0.0)
        } else {
            0.0
        };
        for offset in offsets.iter_mut() {
            let factor = spread / (spread + offset.variance[colour]);
            offset.share[colour] *= factor;
            if factor > 0.0 {
                offset.left[colour] = factor * offset.variance[colour];
            }
        }
    }
}
