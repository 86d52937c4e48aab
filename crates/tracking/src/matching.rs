//! Matches the markers of a frame at rest with the markers of a pressed frame.
//!
//! The method is based on the fact that neighbouring markers move similarly. The first step matches a marker A at rest
//! with a marker B of the pressed frame under three conditions: B is the nearest pressed marker to A, A is the nearest
//! marker at rest to B, and the distance between A and B is less than half the distance between neighbouring markers.
//! The second step removes matches whose displacement differs from the displacements of the neighbours. It then
//! searches each marker again at the place that the displacements of its matched neighbours predict. The second step is
//! repeated until nothing changes.

use crate::{Marker, Status, Track};

/// In the first step of the method, the distance between a marker at rest and its match in the pressed frame must be
/// below this value times the distance between neighbouring markers.
const FIRST_GATE: f64 = 0.5;
/// Largest accepted distance of a pressed marker from the place that its neighbours predict, relative to the distance
/// between neighbouring markers.
const GATE: f64 = 0.3;
/// Maximum number of matched neighbours from which the place of a marker is predicted.
const PREDICTORS: usize = 6;
/// Maximum number of iterations of the second step, which matches markers at the places that their neighbours predict.
const MAX_ITERATIONS: usize = 8;
/// Largest accepted relative difference between the size of a merged marker and the sum of the sizes of the two markers
/// that merged.
const SIZE_GATE: f64 = 0.3;
/// Largest distance between two markers that merge, or between the pieces of a split marker, relative to the distance
/// between neighbouring markers.
const REACH: f64 = 1.5;

/// Matches the markers of a frame at rest with the markers of a pressed frame. Returns one track for each marker at
/// rest, in the order of these markers, followed by one track for each new marker, in the order of the pressed markers.
///
/// A marker is matched if it moves by less than about a third of the distance between neighbouring markers. A marker
/// may move farther if all markers around it move in the same way. If two markers merged, the tracks of both contain
/// the merged marker. If a marker was split, its track contains one marker with the common centroid and the total size
/// of the pieces. Markers with numbers that are not finite are not matched. The computing time is proportional to the
/// number of markers at rest multiplied by the number of pressed markers.
///
/// ```
/// use palpate_tracking::{Marker, Status, match_markers};
///
/// let marker = |x: f64| Marker { centroid_px: [x, 50.0], hue_turns: 0.05, mean_hue_turns: 0.1, size_px2: 300.0, pixels: 300 };
/// let rest = [20.0, 60.0, 100.0].map(marker);
/// // Two markers move by 3 px; the third is lost.
/// let pressed = [23.0, 63.0].map(marker);
/// let tracks = match_markers(&rest, &pressed);
/// let fates: Vec<Status> = tracks.iter().map(|track| track.status).collect();
/// assert_eq!(fates, [Status::Tracked, Status::Tracked, Status::Lost]);
/// assert_eq!(tracks[1].change().map(|change| change.shift_px), Some([3.0, 0.0]));
/// ```
pub fn match_markers(rest: &[Marker], pressed: &[Marker]) -> Vec<Track> {
    let mut matching = Matching::new(rest, pressed);
    matching.match_nearest();
    for _ in 0..MAX_ITERATIONS {
        let before = matching.pairs.clone();
        matching.match_predicted();
        if matching.pairs == before {
            break;
        }
    }
    matching.tracks()
}

struct Matching<'a> {
    rest: &'a [Marker],
    pressed: &'a [Marker],
    /// Distance (px) from each marker at rest to its nearest neighbour at rest.
    spacing: Vec<f64>,
    around: Vec<Vec<usize>>,
    pairs: Vec<Option<usize>>,
}

impl<'a> Matching<'a> {
    fn new(rest: &'a [Marker], pressed: &'a [Marker]) -> Self {
        let around: Vec<Vec<usize>> = rest
            .iter()
            .map(|marker| nearest(rest, marker, 2 * PREDICTORS))
            .collect();
        let mut spacing: Vec<f64> = rest
            .iter()
            .zip(&around)
            .map(|(marker, around)| {
                let away = |&other: &usize| distance(marker.centroid_px, rest[other].centroid_px);
                let next = around.iter().map(away);
                next.fold(f64::INFINITY, f64::min)
            })
            .collect();
        // A marker without near neighbours would have a very large `spacing`. Limit the spacing to a typical value for
        // markers of this size.
        for (spacing, marker) in spacing.iter_mut().zip(rest) {
            *spacing = spacing.min(8.0 * marker.size_px2.max(0.0).sqrt());
        }
        Self {
            rest,
            pressed,
            spacing,
            around,
            pairs: vec![None; rest.len()],
        }
    }

    fn match_nearest(&mut self) {
        let places: Vec<[f64; 2]> = self.rest.iter().map(|marker| marker.centroid_px).collect();
        self.pair(&places, FIRST_GATE);
    }

    /// Matches each marker at rest with the pressed marker that is nearest to the marker's expected place in `places`.
    /// No other expected place may be nearer to the pressed marker. The distance from the marker's expected place to
    /// the pressed marker must be less than `gate` times the distance from the marker at rest to its nearest neighbour.
    fn pair(&mut self, places: &[[f64; 2]], gate: f64) {
        let away = |at: usize, other: usize| distance(places[at], self.pressed[other].centroid_px);
        let closest = |count: usize, away: &dyn Fn(usize) -> f64| {
            (0..count)
                .filter(|&at| away(at).is_finite())
                .min_by(|&a, &b| away(a).total_cmp(&away(b)))
        };
        let back: Vec<Option<usize>> = (0..self.pressed.len())
            .map(|other| closest(places.len(), &|at| away(at, other)))
            .collect();
        let pairs = (0..places.len())
            .map(|at| {
                let other = closest(self.pressed.len(), &|other| away(at, other))?;
                (back[other] == Some(at) && away(at, other) < gate * self.spacing[at])
                    .then_some(other)
            })
            .collect();
        self.pairs = pairs;
    }

    /// Removes matches whose displacement differs from the displacements of the neighbours. Then matches all markers
    /// again at their predicted places.
    fn match_predicted(&mut self) {
        let is_outlier = |at: usize| {
            let moves = self.displacement(at).zip(self.expected_move(at));
            moves.is_some_and(|(one, expected)| distance(one, expected) > GATE * self.spacing[at])
        };
        let outliers: Vec<usize> = (0..self.rest.len()).filter(|&at| is_outlier(at)).collect();
        for at in outliers {
            self.pairs[at] = None;
        }
        let places: Vec<[f64; 2]> = (0..self.rest.len()).map(|at| self.place(at)).collect();
        self.pair(&places, GATE);
    }

    fn displacement(&self, at: usize) -> Option<[f64; 2]> {
        let pressed = self.pressed[self.pairs[at]?].centroid_px;
        let rest = self.rest[at].centroid_px;
        Some([0, 1].map(|axis| pressed[axis] - rest[axis]))
    }

    /// Predicted displacement of a marker: along each axis, the median of the displacements of its neighbours. `None`
    /// if none of the neighbours is matched.
    fn expected_move(&self, at: usize) -> Option<[f64; 2]> {
        let moves: Vec<[f64; 2]> = self.around[at]
            .iter()
            .filter_map(|&other| self.displacement(other))
            .take(PREDICTORS)
            .collect();
        (!moves.is_empty())
            .then(|| [0, 1].map(|axis| median(moves.iter().map(|moved| moved[axis]).collect())))
    }

    fn place(&self, at: usize) -> [f64; 2] {
        let moved = self
            .expected_move(at)
            .or_else(|| self.displacement(at))
            .unwrap_or_default();
        let rest = self.rest[at].centroid_px;
        [0, 1].map(|axis| rest[axis] + moved[axis])
    }

    fn tracks(&self) -> Vec<Track> {
        let places: Vec<[f64; 2]> = (0..self.rest.len()).map(|at| self.place(at)).collect();
        let mut tracks: Vec<Track> = (0..self.rest.len())
            .map(|at| Track {
                rest: Some(self.rest[at]),
                pressed: self.pairs[at].map(|other| self.pressed[other]),
                status: if self.pairs[at].is_some() {
                    Status::Tracked
                } else {
                    Status::Lost
                },
            })
            .collect();
        let mut used = vec![false; self.pressed.len()];
        for &other in self.pairs.iter().flatten() {
            used[other] = true;
        }
        self.merge(&places, &mut tracks, &mut used);
        self.split(&places, &mut tracks, &mut used);
        tracks.extend(self.pressed.iter().zip(used).filter(|(_, used)| !used).map(
            |(marker, _)| Track {
                rest: None,
                pressed: Some(*marker),
                status: Status::New,
            },
        ));
        tracks
    }

    /// Finds lost markers that form one shape with another marker in the pressed frame, and sets their status to
    /// `Merged`.
    fn merge(&self, places: &[[f64; 2]], tracks: &mut [Track], used: &mut [bool]) {
        for at in 0..self.rest.len() {
            if tracks[at].status != Status::Lost {
                continue;
            }
            let partner = self.around[at].iter().find_map(|&other| {
                let with = match tracks[other].status {
                    Status::Tracked => self.pairs[other],
                    Status::Lost => self.closest_free(places, [at, other], used),
                    _ => None,
                }?;
                let parts = [at, other].map(|part| (places[part], self.rest[part].size_px2));
                self.is_sum(&parts, &self.pressed[with], self.spacing[at])
                    .then_some((other, with))
            });
            if let Some((other, with)) = partner {
                used[with] = true;
                for part in [at, other] {
                    tracks[part].pressed = Some(self.pressed[with]);
                    tracks[part].status = Status::Merged;
                }
            }
        }
    }

    /// Index of the pressed marker that may consist of the two merged markers `parts`. Of all pressed markers without a
    /// match, it is the nearest to the midpoint between the expected places of the two merged markers. `None` if no
    /// such marker is nearby.
    fn closest_free(&self, places: &[[f64; 2]], parts: [usize; 2], used: &[bool]) -> Option<usize> {
        let middle = [0, 1].map(|axis| 0.5 * (places[parts[0]][axis] + places[parts[1]][axis]));
        (0..self.pressed.len())
            .filter(|&other| !used[other])
            .map(|other| (other, distance(middle, self.pressed[other].centroid_px)))
            .filter(|(_, away)| *away < REACH * self.spacing[parts[0]])
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(other, _)| other)
    }

    fn split(&self, places: &[[f64; 2]], tracks: &mut [Track], used: &mut [bool]) {
        for at in 0..self.rest.len() {
            let reach = REACH * self.spacing[at];
            let mut near: Vec<usize> = (0..self.pressed.len())
                .filter(|&other| {
                    !used[other] && distance(places[at], self.pressed[other].centroid_px) < reach
                })
                .collect();
            near.extend(self.pairs[at].filter(|_| tracks[at].status == Status::Tracked));
            let own = match tracks[at].status {
                Status::Tracked => self.pairs[at],
                Status::Lost => None,
                _ => continue,
            };
            let whole = Marker {
                centroid_px: places[at],
                ..self.rest[at]
            };
            let pieces = pairs_of(&near).find(|pair| {
                let parts = pair.map(|piece| {
                    (
                        self.pressed[piece].centroid_px,
                        self.pressed[piece].size_px2,
                    )
                });
                own.is_none_or(|own| pair.contains(&own))
                    && self.is_sum(&parts, &whole, self.spacing[at])
            });
            if let Some(pieces) = pieces {
                for piece in pieces {
                    used[piece] = true;
                }
                tracks[at].pressed = Some(combine(pieces.map(|piece| self.pressed[piece])));
                tracks[at].status = Status::Split;
            }
        }
    }

    /// Whether the marker `whole` may consist of the two markers `parts`, given by centroid and size. The size of
    /// `whole` must be about the sum of their sizes, and its centroid about their common centroid.
    fn is_sum(&self, parts: &[([f64; 2], f64); 2], whole: &Marker, spacing: f64) -> bool {
        let size = parts[0].1 + parts[1].1;
        let centre = [0, 1]
            .map(|axis| (parts[0].1 * parts[0].0[axis] + parts[1].1 * parts[1].0[axis]) / size);
        let larger = parts[0].1.max(parts[1].1);
        (whole.size_px2 - size).abs() < SIZE_GATE * size
            && (whole.size_px2 - size).abs() < (whole.size_px2 - larger).abs()
            && distance(centre, whole.centroid_px) < GATE * spacing
    }
}

fn combine(pieces: [Marker; 2]) -> Marker {
    let [a, b] = pieces;
    let size_px2 = a.size_px2 + b.size_px2;
    let turn = b.hue_turns - a.hue_turns;
    let turn = turn - (turn + 0.5).floor();
    let share = b.size_px2 / size_px2;
    Marker {
        centroid_px: [0, 1]
            .map(|axis| a.centroid_px[axis] + share * (b.centroid_px[axis] - a.centroid_px[axis])),
        hue_turns: (a.hue_turns + share * turn).rem_euclid(1.0),
        mean_hue_turns: a.mean_hue_turns + share * (b.mean_hue_turns - a.mean_hue_turns),
        size_px2,
        pixels: a.pixels.saturating_add(b.pixels),
    }
}

fn pairs_of(items: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    (0..items.len()).flat_map(move |a| (a + 1..items.len()).map(move |b| [items[a], items[b]]))
}

fn nearest(markers: &[Marker], marker: &Marker, count: usize) -> Vec<usize> {
    let mut others: Vec<(usize, f64)> = markers
        .iter()
        .enumerate()
        .filter(|(_, other)| !std::ptr::eq(*other, marker))
        .map(|(at, other)| (at, distance(marker.centroid_px, other.centroid_px)))
        .filter(|(_, away)| away.is_finite())
        .collect();
    if others.len() > count {
        others.select_nth_unstable_by(count, |a, b| a.1.total_cmp(&b.1));
        others.truncate(count);
    }
    others.sort_by(|a, b| a.1.total_cmp(&b.1));
    others.into_iter().map(|(at, _)| at).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        0.5 * (values[half - 1] + values[half])
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [a[0] - b[0], a[1] - b[1]];
    (x * x + y * y).sqrt()
}
