//! Computes, for each marker, the direction along the skin away from the contact. The tables state only the distance
//! of each marker from the contact, so the position of the contact is fitted to these distances.

/// The curvature of the skin is found by a coarse and a fine search. This is the number of equal steps of the curvature
/// in the coarse search.
const STEPS: u32 = 60;
/// Number of golden-section steps in the fine search for the skin's curvature. The fine search starts from the
/// curvature that fits best in the coarse search.
const REFINEMENTS: u32 = 60;
/// Upper end of the search for the curvature of the skin, which is fitted as a sphere. The curvature is multiplied by
/// the largest distance of a marker from the contact or from the apex (no unit). The product must be less than π,
/// because for π this distance would be half a great circle.
const ROUNDEST: f64 = 3.1;
/// Regularisation of the least-squares fit: the trace of the matrix of the normal equations, multiplied by this number,
/// is added to the diagonal of this matrix. The solution is then unique, even if the positions do not determine all
/// unknowns.
const RIDGE: f64 = 1e-13;
/// A marker counts as being at the contact if its distance from the contact is below this share of the largest
/// distance.
const AT_CONTACT: f64 = 1e-6;

/// Unit vector along the skin away from the contact, for each marker; `None` at the contact.
///
/// `places` are the positions of the markers along the skin: (x, y) is the point at the distance √(x² + y²) from the
/// apex of the skin, in the direction (x, y). `distances` are the distances of the markers from the contact along the
/// skin. The skin is a sphere of unknown radius. The components of the result are along two axes in the skin at the
/// marker: the axes at the apex, parallel-transported along the meridian to the marker.
pub(super) fn outward(places: &[[f64; 2]], distances: &[f64]) -> Vec<Option<[f64; 2]>> {
    let lengths = places.iter().map(|[x, y]| libm::hypot(*x, *y));
    let size = lengths.chain(distances.iter().copied()).fold(0.0, f64::max);
    if size <= f64::MIN_POSITIVE {
        return vec![None; places.len()];
    }
    let places: Vec<[f64; 2]> = places.iter().map(|p| p.map(|part| part / size)).collect();
    let distances: Vec<f64> = distances.iter().map(|d| d / size).collect();
    let contact = |curvature: f64| Contact::fitted(curvature, &places, &distances);

    let step = ROUNDEST / f64::from(STEPS);
    let coarse = (0..=STEPS).map(|k| contact(f64::from(k) * step));
    let Some(best) = coarse.min_by(|a, b| a.misfit.total_cmp(&b.misfit)) else {
        return vec![None; places.len()];
    };
    let (mut low, mut high) = ((best.curvature - step).max(0.0), best.curvature + step);
    let mut best = best;
    for _ in 0..REFINEMENTS {
        let (a, b) = (low + (high - low) * 0.382, low + (high - low) * 0.618);
        let (first, second) = (contact(a), contact(b));
        let better = if first.misfit <= second.misfit {
            high = b;
            first
        } else {
            low = a;
            second
        };
        if better.misfit < best.misfit {
            best = better;
        }
    }
    places.iter().map(|place| best.away_at(*place)).collect()
}

/// Fitted position of the contact on a sphere with the curvature `curvature`. The origin is at the apex of the sphere.
struct Contact {
    curvature: f64,
    place: [f64; 3],
    /// Sum of the squared misfits of the chords from the markers to the contact. The misfit of a chord is its squared
    /// length on the fitted sphere, minus the squared length that follows from the given distance.
    misfit: f64,
}

impl Contact {
    /// Fits the position C of the contact on a sphere with this curvature, so that the chords from C to the markers p
    /// agree best with the given distances. With the origin at the apex and the radius R, |p − C|² = |p|² − 2 p·C − 2 R
    /// C_z. This is linear in the unknowns C_x, C_y and R C_z.
    fn fitted(curvature: f64, places: &[[f64; 2]], distances: &[f64]) -> Self {
        let chord = |length: f64| length * over(0.5 * length * curvature);
        let rows: Vec<([f64; 3], f64)> = places
            .iter()
            .zip(distances)
            .map(|(place, distance)| {
                let length = libm::hypot(place[0], place[1]);
                let [x, y, _] = on_sphere(*place, curvature);
                let cosine = libm::cos(length * curvature);
                let difference = chord(length).powi(2) - chord(*distance).powi(2);
                ([2.0 * x, 2.0 * y, 2.0 * cosine], difference)
            })
            .collect();
        let solution = least_squares(&rows);
        let misfit = rows
            .iter()
            .map(|(row, value)| (dot(*row, solution) - value).powi(2));
        Self {
            curvature,
            place: [solution[0], solution[1], curvature * solution[2]],
            misfit: misfit.sum(),
        }
    }

    /// Unit vector along the skin away from the contact, at the marker at `place`. Its components are along the axes
    /// that are parallel-transported from the apex to the marker. `None` at the contact.
    fn away_at(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let length = libm::hypot(place[0], place[1]);
        let [x, y, z] = on_sphere(place, self.curvature);
        let from = [x - self.place[0], y - self.place[1], z - self.place[2]];
        let (sin, cos) = libm::sincos(length * self.curvature);
        let (east, north) = if length > 0.0 {
            (place[0] / length, place[1] / length)
        } else {
            (1.0, 0.0)
        };
        let along = dot(from, [cos * east, cos * north, -sin]);
        let across = dot(from, [-north, east, 0.0]);
        let far = libm::hypot(along, across);
        let in_axes = [
            (along * east - across * north) / far,
            (along * north + across * east) / far,
        ];
        (far > AT_CONTACT).then_some(in_axes)
    }
}

/// Three-dimensional coordinates of a position along the skin of a sphere with this curvature.
fn on_sphere(place: [f64; 2], curvature: f64) -> [f64; 3] {
    let length = libm::hypot(place[0], place[1]);
    let stretch = over(length * curvature);
    let chord = length * over(0.5 * length * curvature);
    [
        stretch * place[0],
        stretch * place[1],
        -0.5 * curvature * chord * chord,
    ]
}

fn over(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Least-squares solution of linear equations with three unknowns. Each row contains the three coefficients and the
/// right-hand side.
fn least_squares(rows: &[([f64; 3], f64)]) -> [f64; 3] {
    let sum =
        |term: &dyn Fn(&[f64; 3], f64) -> f64| rows.iter().map(|(r, v)| term(r, *v)).sum::<f64>();
    let mut matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| sum(&|row, _| row[i] * row[j])));
    let right = [0, 1, 2].map(|i| sum(&|row, value| row[i] * value));
    let ridge = RIDGE * (matrix[0][0] + matrix[1][1] + matrix[2][2]).max(f64::MIN_POSITIVE);
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] += ridge;
    }
    // The 3 × 3 system of normal equations is solved by Cramer's rule.
    let column = |j: usize| [matrix[0][j], matrix[1][j], matrix[2][j]];
    let volume = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| dot(a, cross(b, c));
    let whole = volume(column(0), column(1), column(2));
    let [x, y, z] = [
        volume(right, column(1), column(2)),
        volume(column(0), right, column(2)),
        volume(column(0), column(1), right),
    ];
    if whole > 0.0 {
        [x / whole, y / whole, z / whole]
    } else {
        [0.0; 3]
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
