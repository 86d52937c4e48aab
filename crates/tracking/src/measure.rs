//! Measurement of a marker in light: sums over its window, linear in the pixels, so that blur, noise, partly covered
//! pixels and uneven light leave them unbiased.

use image::RgbImage;

use crate::Ground;
use crate::lighting::{Lighting, Local};
use crate::shapes::Shape;
use crate::window::Window;

/// Width of the ring about a window in which the ground is looked at, px.
const RING_PX: i32 = 4;
/// Share of the markers' mean signal below which nothing is left of them.
const SPENT: f64 = 0.004;
/// Markers the reach is measured on.
const SAMPLE: usize = 12;
/// The darkest ground that light is compared with, 0 to 255.
const DARKEST: f32 = 8.0;
/// Share of light by which a pixel of the ground may differ from the fitted light.
const STRANGE: f64 = 0.15;

/// Sums over a window, of shares of light that a marker takes from a bright ground or adds to a dark one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Number of pixels.
    pub(crate) count: f64,
    /// Sum of the offsets of the pixels from `middle`, px.
    pub(crate) place: [f64; 2],
    /// Sums of the pixels' shares of red, green and blue: of the ground's light that they take, or of full scale that
    /// they add.
    pub(crate) light: [f64; 3],
    /// First moment of each colour channel about `middle`, px: the sum of shares times offsets.
    pub(crate) moment: [[f64; 2]; 3],
    /// Sums of red, green and blue over the pixels that tell the hue: on a bright ground all; on a dark one, where the
    /// ground adds nothing but noise to the chroma, the shape's own.
    pub(crate) hue_light: [f64; 3],
    /// Place that offsets are counted from, px.
    pub(crate) middle: [f64; 2],
    /// Errors of the pixels that they are sums of.
    pub(crate) errors: PixelErrors,
}

/// Errors of the pixels of a window.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelErrors {
    /// Sums over the window's pixels of 1, x, y, x², xy and y², counted from the sums' `middle`.
    pub(crate) window: [f64; 6],
    /// Variance of each colour of a pixel, squared shares.
    pub(crate) pixel: [f64; 3],
    /// Variance of what all pixels of the window err by alike, squared shares.
    pub(crate) common: [f64; 3],
    /// Radius of a circle of the marker's area, px.
    pub(crate) radius_px: f64,
}

/// A frame and all that is known of its ground.
pub(crate) struct Scene<'a> {
    pub(crate) frame: &'a RgbImage,
    pub(crate) ground: Ground,
    /// First and last column of each row that show the sensor.
    pub(crate) rows: &'a [(i32, i32)],
    pub(crate) lighting: &'a Lighting,
    pub(crate) bin: usize,
    /// A marker's diameter, px.
    pub(crate) diameter_px: f64,
}

/// A shape with its place among the others.
struct Patch {
    middle: [f64; 2],
    radius: f64,
    hull: Window,
    window: Window,
    surroundings: Window,
    neighbours: Vec<usize>,
    local: [Local; 3],
}

/// Owner of the pixels that lie in a neighbour's window too.
#[derive(Clone, Copy, PartialEq)]
enum Contested {
    /// Pixels in two windows belong to the nearer marker.
    Nearest,
    /// Pixels in two windows count for neither marker.
    Nobody,
}

/// How far the ground about a marker lies from the fitted light, in shares.
#[derive(Clone, Copy, Default)]
struct Offset {
    share: [f64; 3],
    variance: [f64; 3],
    /// Variance that is left of it once it is believed as far as it deserves.
    left: [f64; 3],
}

impl Scene<'_> {
    /// Sums of each shape, the ground about it taken into account.
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
        trust(&mut offsets);
        for (at, (sums, offset)) in sums.iter_mut().zip(&offsets).enumerate() {
            sums.errors = self.errors(&patches[at], offset);
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

    /// Grows the windows and finds who is near whom.
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

    /// How far beyond its shape a marker is seen, px: where the mean over many markers of what is left of them has fallen
    /// to nothing.
    fn reach(&self, patches: &mut [Patch]) -> i32 {
        let most = (0.4 * self.diameter_px).clamp(4.0, 16.0) as i32;
        self.grow(patches, most);
        let mut rings = vec![[0.0; 2]; (most + 1) as usize];
        let step = patches.len().div_ceil(SAMPLE).max(1);
        for at in (0..patches.len()).step_by(step) {
            let patch = &patches[at];
            let mut inner: Option<Window> = None;
            for (reach, ring) in (0..).zip(&mut rings) {
                let outer = patch.hull.grown(reach, self.rows);
                self.each(
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
            .find(|&reach| mean(&rings[reach + 1]) - rest < SPENT * full)
            .map_or(most, |reach| reach as i32)
            .max(2)
    }

    /// Calls with the offset from the middle and the shares of light of each pixel of `outer` that is not in `inner` and
    /// does not go to a neighbour.
    fn each(
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
                            && (contested == Contested::Nobody || rival.takes(patch, [x, row]))
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

    /// Shares of the ground's red, green and blue light that a pixel takes, or shares of full scale that it adds to it.
    fn shares(&self, value: [u8; 3], light: &[[f32; 3]; 3], dx: f32) -> [f32; 3] {
        let ground = light.map(|[constant, linear, square]| constant + dx * (linear + dx * square));
        match self.ground {
            Ground::Bright => {
                [0, 1, 2].map(|at| 1.0 - f32::from(value[at]) / ground[at].max(DARKEST))
            }
            Ground::Dark => [0, 1, 2].map(|at| (f32::from(value[at]) - ground[at]) * (1.0 / 255.0)),
        }
    }

    fn sum(&self, patches: &[Patch], at: usize) -> Sums {
        let mut sums = [0.0f32; 12];
        self.each(
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
            middle: patches[at].middle,
            errors: PixelErrors::default(),
        }
    }

    /// The sums of colours over the shape alone, and its pixels.
    fn core(&self, patches: &[Patch], at: usize) -> ([f64; 3], f64) {
        let mut sums = [0.0f32; 4];
        self.each(
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

    /// The ground in the ring about a window, twice: what is strange is left out.
    fn offset(&self, patches: &[Patch], at: usize) -> Offset {
        let patch = &patches[at];
        let mut ring: Vec<[f32; 3]> = Vec::new();
        self.each(
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
            Ground::Bright => self.lighting.noise / f64::from(local.row(0.0)[0].max(DARKEST)),
            Ground::Dark => self.lighting.noise / 255.0,
        });
        let (mut share, mut count) = ([0.0; 3], 0.0);
        for within in [STRANGE, 0.01] {
            let mut sums = [0.0; 3];
            let mut held = 0.0;
            for light in &ring {
                let light = light.map(f64::from);
                if (0..3).all(|at| (light[at] - share[at]).abs() < within + 4.0 * noise[at]) {
                    held += 1.0;
                    for (sum, light) in sums.iter_mut().zip(light) {
                        *sum += light;
                    }
                }
            }
            if held > 0.0 {
                share = sums.map(|sum| sum / held);
                count = held;
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
        // Whole levels err by the root of a twelfth where noise does not spread them.
        let noise = self.lighting.noise.max(1.0 / 12.0_f64.sqrt());
        PixelErrors {
            window: patch.window.moments(patch.middle),
            pixel: patch.local.map(|local| {
                let level = match self.ground {
                    Ground::Bright => f64::from(local.row(0.0)[0].max(DARKEST)),
                    Ground::Dark => 255.0,
                };
                (noise / level).powi(2)
            }),
            common: offset.left,
            radius_px: patch.radius,
        }
    }

    /// Takes the ground's offset out of the sums.
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
    /// Whether a pixel in both windows is nearer, in radii, to this one than to another.
    fn takes(&self, other: &Self, [x, y]: [i32; 2]) -> bool {
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

/// Believes each offset as far as the offsets of all markers differ by more than noise lets them (empirical Bayes): in an
/// evenly lit frame the fitted light is far better known than a few pixels tell.
fn trust(offsets: &mut [Offset]) {
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
            let belief = spread / (spread + offset.variance[colour]);
            offset.share[colour] *= belief;
            if belief > 0.0 {
                offset.left[colour] = belief * offset.variance[colour];
            }
        }
    }
}
