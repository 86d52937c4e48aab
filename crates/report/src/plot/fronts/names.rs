//! Placement of names beside points, so that none hides another name or a point.

use crate::plot::canvas::Point;
use crate::plot::lettering::width;

/// Size of a name.
pub(super) const NAME: f64 = 15.0;
/// Distances from its point at which a name may stand, pixels.
const DISTANCES: [f64; 9] = [9.0, 18.0, 30.0, 45.0, 62.0, 82.0, 105.0, 130.0, 160.0];
/// Distance from which on a line leads from the point to its name, pixels.
const LED: f64 = 20.0;
/// Number of these distances for names of points that are not on the front.
const BESIDE: usize = 2;
const DIRECTIONS: usize = 24;
/// Half the height of a name with the space around it, pixels.
const HALF: f64 = 0.62 * NAME;
/// Half the side of the square around a point that names should leave free, pixels.
const POINT: f64 = 6.0;

/// Costs of a place at which a name hides or crosses something, in pixels of distance from its point.
const HIDES_NAME: f64 = 1e6;
const HIDES_POINT: f64 = 1e5;
const OUTSIDE: f64 = 1e7;
const CROSSES_FRONT: f64 = 30.0;
const HIDES_BEATEN: f64 = 30.0;
const HIDES_BAR: f64 = 30.0;

/// A name in its place.
pub(super) struct Name {
    pub(super) text: String,
    /// Left end, at the middle of its height.
    pub(super) place: Point,
    /// Line from the point to the name, where they are far apart.
    pub(super) leader: Option<[Point; 2]>,
    pub(super) bounds: Bounds,
    /// Whether its point is on the front.
    pub(super) of_front: bool,
}

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds([f64; 4]);

impl Bounds {
    fn around((x, y): Point, half: (f64, f64)) -> Self {
        Self([x - half.0, y - half.1, x + half.0, y + half.1])
    }

    pub(super) fn meets(&self, other: &Self) -> bool {
        let [left, top, right, bottom] = self.0;
        let [other_left, other_top, other_right, other_bottom] = other.0;
        left < other_right && other_left < right && top < other_bottom && other_top < bottom
    }

    fn within(&self, frame: [f64; 4]) -> bool {
        let [left, top, right, bottom] = self.0;
        left >= frame[0] + 2.0
            && top >= frame[1] + 1.0
            && right <= frame[2] - 2.0
            && bottom <= frame[3] - 1.0
    }

    /// The place in it that is nearest to a point.
    fn nearest(&self, (x, y): Point) -> Point {
        let [left, top, right, bottom] = self.0;
        (x.clamp(left, right), y.clamp(top, bottom))
    }
}

/// Places the names of points one after the other within a frame: first of those on the front, each where it hides the
/// least, then of the others, those that have room beside their points. Bars are what names should leave free, too.
pub(super) fn place(
    front: &[(String, Point)],
    beaten: &[(String, Point)],
    bars: &[[Point; 2]],
    frame: [f64; 4],
) -> Vec<Name> {
    let points = |named: &[(String, Point)]| named.iter().map(|(_, place)| *place).collect();
    let [of_front, of_beaten]: [Vec<Point>; 2] = [points(front), points(beaten)];
    let mut names: Vec<Name> = Vec::new();
    let all = front.iter().map(|named| (named, true));
    for ((text, point), is_on_front) in all.chain(beaten.iter().map(|named| (named, false))) {
        let half_width = 0.5 * width(text, NAME) + 2.0;
        let reach = match is_on_front {
            true => DISTANCES.len(),
            false => BESIDE,
        };
        let candidates = DISTANCES[..reach].iter().flat_map(|&distance| {
            (0..DIRECTIONS).map(move |at| candidate(*point, half_width, distance, at))
        });
        let covers = |bounds: &Bounds| {
            let covered = bars.iter().filter(|[low, high]| {
                along(*low, *high).any(|at| bounds.meets(&Bounds::around(at, (1.0, 1.0))))
            });
            HIDES_BAR * covered.count() as f64
        };
        let hidden = |bounds: &Bounds| {
            covers(bounds) + hidden(bounds, *point, &names, &of_front, &of_beaten, frame)
        };
        let cost = |(distance, bounds): &(f64, Bounds)| *distance + hidden(bounds);
        let best = candidates.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let best = best.filter(|(_, bounds)| is_on_front || hidden(bounds) == 0.0);
        let Some((distance, bounds)) = best else {
            continue;
        };
        let [left, top, _, bottom] = bounds.0;
        names.push(Name {
            text: text.clone(),
            place: (left + 2.0, 0.5 * (top + bottom)),
            leader: (distance > LED).then(|| [*point, bounds.nearest(*point)]),
            bounds,
            of_front: is_on_front,
        });
    }
    names
}

/// A name at a distance in one of the directions, first level to the right.
fn candidate((x, y): Point, half_width: f64, distance: f64, at: usize) -> (f64, Bounds) {
    let angle = std::f64::consts::TAU * at as f64 / DIRECTIONS as f64;
    let (sine, cosine) = libm::sincos(angle);
    let centre = (
        x + cosine * (distance + half_width),
        y - sine * (distance + HALF),
    );
    (distance, Bounds::around(centre, (half_width, HALF)))
}

fn hidden(
    bounds: &Bounds,
    own: Point,
    names: &[Name],
    front: &[Point],
    beaten: &[Point],
    frame: [f64; 4],
) -> f64 {
    let mut cost = if bounds.within(frame) { 0.0 } else { OUTSIDE };
    let point = |place: &&Point| bounds.meets(&Bounds::around(**place, (POINT, POINT)));
    cost += HIDES_POINT * front.iter().filter(point).count() as f64;
    cost += HIDES_BEATEN * beaten.iter().filter(point).count() as f64;
    let leader = bounds.nearest(own);
    for name in names {
        let crossed =
            along(own, leader).any(|at| name.bounds.meets(&Bounds::around(at, (1.0, 1.0))));
        if bounds.meets(&name.bounds) || crossed {
            cost += HIDES_NAME;
        }
        if let Some([from, to]) = name.leader
            && along(from, to).any(|at| bounds.meets(&Bounds::around(at, (1.0, 1.0))))
        {
            cost += HIDES_NAME;
        }
    }
    let crossings = front.windows(2).filter(|pair| {
        along(pair[0], pair[1]).any(|at| bounds.meets(&Bounds::around(at, (1.0, 1.0))))
    });
    cost + CROSSES_FRONT * crossings.count() as f64
}

/// Places along a segment.
fn along(from: Point, to: Point) -> impl Iterator<Item = Point> {
    (0..=40).map(move |step| {
        let share = f64::from(step) / 40.0;
        (
            from.0 + share * (to.0 - from.0),
            from.1 + share * (to.1 - from.1),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_hides_a_name_or_a_point_even_where_points_crowd() {
        let named: Vec<(String, Point)> = (0..9)
            .map(|at| {
                let place = (80.0 + 25.0 * f64::from(at), 20.0 + 11.0 * f64::from(at));
                (format!("RK4 × {}, Montana", 1 << at), place)
            })
            .collect();
        let names = place(&named, &[], &[], [0.0, 0.0, 700.0, 230.0]);
        assert_eq!(names.len(), named.len());
        for (at, name) in names.iter().enumerate() {
            assert!(
                name.bounds.within([0.0, 0.0, 700.0, 230.0]),
                "{}",
                name.text
            );
            for other in &names[..at] {
                assert!(
                    !name.bounds.meets(&other.bounds),
                    "{} {}",
                    name.text,
                    other.text
                );
            }
            for (_, point) in &named {
                let point = Bounds::around(*point, (POINT, POINT));
                assert!(!name.bounds.meets(&point), "{}", name.text);
            }
        }
    }
}
