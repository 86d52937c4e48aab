//! Places labels beside the points of a figure, so that labels cover neither each other nor points.

use super::lettering::width;
use super::sheet::Point;

/// Font size of a label, in drawing units (1/3 px).
pub(super) const NAME: i32 = 45;
/// Possible distances between a point and its label, in drawing units (1/3 px).
const DISTANCES: [i32; 9] = [27, 54, 90, 135, 186, 246, 315, 390, 480];
/// If the distance between a label and its point is larger than this, a line (leader) connects them; in drawing units
/// (1/3 px).
const MAX_WITHOUT_LEADER: i32 = 60;
/// Number of [`DISTANCES`], from the smallest, that are tried for the label of a point that is not on the Pareto front.
const BESIDE: usize = 2;
const DIRECTIONS: usize = 24;
/// Half the height of the area of a label: its text and the space above and below the text; in drawing units (1/3 px).
const HALF: i32 = 28;
/// Half the side of the square around a point that labels should not cover, in drawing units (1/3 px).
const POINT: i32 = 18;

/// Penalty for each other label that a label covers, and for each leader that it covers. A leader is the line from a
/// label to its point. Penalties are added to the distance of a label from its point, and have the same unit.
const HIDES_NAME: i32 = 3_000_000;
/// Penalty for each other label that the leader of a label crosses. A leader is the line from a label to its point.
const LEADER_CROSSES_NAME: i32 = 1_000_000;
/// Penalty for each point on the Pareto front that a label covers.
const HIDES_POINT: i32 = 300_000;
/// Penalty for a label that extends beyond the frame.
const OUTSIDE: i32 = 30_000_000;
/// Penalty for each segment of the Pareto front that a label crosses.
const CROSSES_FRONT: i32 = 90;
/// Penalty for each point that a label covers, if the point is not on the Pareto front.
const HIDES_BEATEN: i32 = 90;
/// Penalty for each error bar that a label covers.
const HIDES_BAR: i32 = 90;

pub(super) struct PlacedLabel {
    pub(super) text: String,
    pub(super) place: Point,
    /// Line from the point to the label; `None` if the label is close to its point.
    pub(super) leader: Option<[Point; 2]>,
    pub(super) bounds: Bounds,
    /// Whether the point of this label is on the Pareto front.
    pub(super) of_front: bool,
}

/// A rectangle: left, top, right and bottom, in drawing units (1/3 px).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds([i32; 4]);

impl Bounds {
    fn around((x, y): Point, half: Point) -> Self {
        Self([x - half.0, y - half.1, x + half.0, y + half.1])
    }

    pub(super) fn meets(&self, other: &Self) -> bool {
        let [left, top, right, bottom] = self.0;
        let [other_left, other_top, other_right, other_bottom] = other.0;
        left < other_right && other_left < right && top < other_bottom && other_top < bottom
    }

    fn within(&self, frame: [i32; 4]) -> bool {
        let [left, top, right, bottom] = self.0;
        left >= frame[0] + 6
            && top >= frame[1] + 3
            && right <= frame[2] - 6
            && bottom <= frame[3] - 3
    }

    /// Whether a line segment crosses the rectangle or passes close to it.
    fn is_crossed(&self, from: Point, to: Point) -> bool {
        along(from, to).any(|at| self.meets(&Self::around(at, (3, 3))))
    }

    fn nearest(&self, (x, y): Point) -> Point {
        let [left, top, right, bottom] = self.0;
        (x.clamp(left, right), y.clamp(top, bottom))
    }
}

/// Places the labels of a figure within a frame, one after another. Labels of points on the Pareto front (`front`) are
/// placed first, each at the position with the smallest penalty. Labels of the other points (`beaten`) are placed only
/// where there is space. Labels also avoid the error bars `bars`.
pub(super) fn place(
    front: &[(String, Point)],
    beaten: &[(String, Point)],
    bars: &[[Point; 2]],
    frame: [i32; 4],
) -> Vec<PlacedLabel> {
    let points = |named: &[(String, Point)]| named.iter().map(|(_, place)| *place).collect();
    let [of_front, of_beaten]: [Vec<Point>; 2] = [points(front), points(beaten)];
    let mut names: Vec<PlacedLabel> = Vec::new();
    let all = front.iter().map(|named| (named, true));
    for ((text, point), is_on_front) in all.chain(beaten.iter().map(|named| (named, false))) {
        let half_width = width(text, NAME) / 2 + 6;
        let reach = match is_on_front {
            true => DISTANCES.len(),
            false => BESIDE,
        };
        let candidates = DISTANCES[..reach].iter().flat_map(|&distance| {
            (0..DIRECTIONS).map(move |at| candidate(*point, half_width, distance, at))
        });
        let covers = |bounds: &Bounds| {
            let covered = bars
                .iter()
                .filter(|[low, high]| bounds.is_crossed(*low, *high));
            HIDES_BAR * covered.count() as i32
        };
        let hidden = |bounds: &Bounds| {
            covers(bounds) + hidden(bounds, *point, &names, &of_front, &of_beaten, frame)
        };
        let best = candidates.min_by_key(|(distance, bounds)| distance + hidden(bounds));
        let best = best.filter(|(_, bounds)| is_on_front || hidden(bounds) == 0);
        let Some((distance, bounds)) = best else {
            continue;
        };
        let [left, top, _, bottom] = bounds.0;
        names.push(PlacedLabel {
            text: text.clone(),
            place: (left + 6, (top + bottom) / 2),
            leader: (distance > MAX_WITHOUT_LEADER).then(|| [*point, bounds.nearest(*point)]),
            bounds,
            of_front: is_on_front,
        });
    }
    names
}

/// Returns `distance`, and the rectangle of a label at this distance from its point. `at` is the index of the direction
/// from the point to the label. The directions are equally spaced and numbered counterclockwise from 0, which is to the
/// right.
fn candidate((x, y): Point, half_width: i32, distance: i32, at: usize) -> (i32, Bounds) {
    let angle = std::f64::consts::TAU * at as f64 / DIRECTIONS as f64;
    let (sine, cosine) = libm::sincos(angle);
    let along = |part: f64, length: i32| (part * f64::from(length)) as i32;
    let centre = (
        x + along(cosine, distance + half_width),
        y - along(sine, distance + HALF),
    );
    (distance, Bounds::around(centre, (half_width, HALF)))
}

/// Sum of the penalties for a label in the rectangle `bounds`, without the penalties for error bars.
fn hidden(
    bounds: &Bounds,
    own: Point,
    names: &[PlacedLabel],
    front: &[Point],
    beaten: &[Point],
    frame: [i32; 4],
) -> i32 {
    let mut cost = if bounds.within(frame) { 0 } else { OUTSIDE };
    let point = |place: &&Point| bounds.meets(&Bounds::around(**place, (POINT, POINT)));
    cost += HIDES_POINT * front.iter().filter(point).count() as i32;
    cost += HIDES_BEATEN * beaten.iter().filter(point).count() as i32;
    let leader = bounds.nearest(own);
    for name in names {
        if bounds.meets(&name.bounds) {
            cost += HIDES_NAME;
        } else if name.bounds.is_crossed(own, leader) {
            cost += LEADER_CROSSES_NAME;
        }
        if let Some([from, to]) = name.leader
            && bounds.is_crossed(from, to)
        {
            cost += HIDES_NAME;
        }
    }
    let crossings = front.windows(2);
    let crossings = crossings.filter(|pair| bounds.is_crossed(pair[0], pair[1]));
    cost + CROSSES_FRONT * crossings.count() as i32
}

fn along(from: Point, to: Point) -> impl Iterator<Item = Point> {
    (0..=40).map(move |step| {
        let on_the_way = |from: i32, to: i32| from + step * (to - from) / 40;
        (on_the_way(from.0, to.0), on_the_way(from.1, to.1))
    })
}
