//! Simulates a unit sphere that rolls by an angle of 6 rad over a unit sphere and over the paraboloid z = −r². The
//! method DOP853 of the crate ode_solvers integrates Montana's contact equations, in coordinates (charts) of both
//! surfaces.
//!
//! Prints one line of JSON per task. The error is the largest difference from the closed form, in any coordinate of the
//! contact on either body.

use std::hint::black_box;
use std::time::Instant;

use ode_solvers::{Dop853, OutputType, SVector, System};

/// State of the contact: latitude and longitude on the probe (rad), two coordinates on the object, and the angle
/// between the axes of both charts at the contact (rad).
type State = SVector<f64, 5>;

const RATE: f64 = 0.1;
const ANGLE: f64 = 6.0;
const DIRECTION: f64 = 0.7;
const TOLERANCE: f64 = 1e-12;
const BATCHES: usize = 9;
const BATCH_S: f64 = 0.02;
/// Latitude on the probe at the start of the roll over the sphere, rad.
const LATITUDE: f64 = 0.3;

#[derive(Clone, Copy)]
struct OverSphere;

impl System<f64, State> for OverSphere {
    fn system(&self, _: f64, state: &State, rate: &mut State) {
        let (sine, cosine) = state[4].sin_cos();
        let along = RATE / 2.0;
        let (up, across) = (-sine * along, -cosine * along);
        rate[0] = 0.0;
        rate[1] = along / state[0].cos();
        rate[2] = up;
        rate[3] = across / state[2].cos();
        rate[4] = -state[0].tan() * along - state[2].tan() * across;
    }
}

#[derive(Clone, Copy)]
struct OverParaboloid;

impl System<f64, State> for OverParaboloid {
    fn system(&self, _: f64, state: &State, rate: &mut State) {
        // `p` and `q` are the slopes of the paraboloid along x and y. These slopes determine the two tangent axes of
        // the Gauss frame. If the contact moves with unit velocity along the first axis, x changes at the rate
        // `x_first`. If the contact moves with unit velocity along the second axis, x and y change at the rates
        // `x_second` and `y_second`.
        let (p, q) = (-2.0 * state[2], -2.0 * state[3]);
        let square = 1.0 + p * p;
        let (first, area) = (square.sqrt(), (square + q * q).sqrt());
        let (x_first, x_second, y_second) = (1.0 / first, -p * q / (first * area), first / area);
        // `k11`, `k12` and `k22` are the components of the object's curvature form in the object's frame. `r11`, `r12`
        // and `r22` are the components of the sum of the object's and the probe's curvature forms, in the probe's
        // frame.
        let bend = 2.0 / area;
        let k11 = bend * x_first * x_first;
        let k12 = bend * x_first * x_second;
        let k22 = bend * (x_second * x_second + y_second * y_second);
        let (sine, cosine) = state[4].sin_cos();
        let r11 = k11 * cosine * cosine - 2.0 * k12 * cosine * sine + k22 * sine * sine + 1.0;
        let r22 = k11 * sine * sine + 2.0 * k12 * cosine * sine + k22 * cosine * cosine + 1.0;
        let r12 = (k22 - k11) * cosine * sine - k12 * (cosine * cosine - sine * sine);
        let determinant = r11 * r22 - r12 * r12;
        let (up, along) = (-r12 * RATE / determinant, r11 * RATE / determinant);
        let (b1, b2) = (cosine * up - sine * along, -sine * up - cosine * along);
        let x_rate = x_first * b1 + x_second * b2;
        rate[0] = up;
        rate[1] = along / state[0].cos();
        rate[2] = x_rate;
        rate[3] = y_second * b2;
        rate[4] = -state[0].tan() * along - 2.0 * q / (square * area) * x_rate;
    }
}

fn roll<S: System<f64, State>>(system: S, latitude: f64) -> State {
    let first = State::from([0.0, 0.0, latitude, 0.0, DIRECTION]);
    let end = ANGLE / RATE;
    // Use the sparse output of the solver: the dense output would extrapolate the last point.
    let mut solver = Dop853::from_param(
        system,
        0.0,
        end,
        end,
        first,
        TOLERANCE,
        TOLERANCE,
        0.9,
        0.0,
        0.333,
        6.0,
        end,
        0.0,
        100_000,
        1000,
        OutputType::Sparse,
    );
    solver.integrate().expect("a roll");
    *solver.y_out().last().expect("the end of the roll")
}

/// Returns the largest difference of a coordinate between two points of a pair. Each pair consists of the computed and
/// the exact contact point.
fn largest<const N: usize>(pairs: [([f64; 3], [f64; 3]); N]) -> f64 {
    let differences = pairs
        .iter()
        .flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
    differences.fold(0.0, f64::max)
}

fn on_probe(state: &State) -> [f64; 3] {
    let (u, v) = (state[0], state[1]);
    [u.cos() * v.cos(), -u.cos() * v.sin(), u.sin()]
}

/// The exact contact point on the probe after the contact has moved by `length` along a great circle.
fn after(length: f64) -> [f64; 3] {
    [length.cos(), -length.sin(), 0.0]
}

fn error_over_sphere(state: &State) -> f64 {
    let length = ANGLE / 2.0;
    let (u, v) = (state[2], state[3]);
    let (sine, cosine) = LATITUDE.sin_cos();
    let (turn, straight) = DIRECTION.sin_cos();
    let radial = [cosine, 0.0, sine];
    let tangent = [turn * sine, straight, -turn * cosine];
    let expected = [0, 1, 2].map(|axis| length.cos() * radial[axis] + length.sin() * tangent[axis]);
    let found = [u.cos() * v.cos(), -u.cos() * v.sin(), u.sin()];
    largest([(found, expected), (on_probe(state), after(length))])
}

/// Arc length of the meridian z = −r² from the apex to the distance r from the axis.
fn meridian(r: f64) -> f64 {
    let slope = 2.0 * r;
    r / 2.0 * slope.hypot(1.0) + slope.asinh() / 4.0
}

fn error_over_paraboloid(state: &State) -> f64 {
    // The roll angle of the probe is the sum of two angles: the slope angle of the paraboloid, and the length of the
    // meridian divided by the probe's radius, which is 1. Find the distance r from the axis at which the roll angle is
    // ANGLE.
    let mut r = ANGLE / 3.0;
    for _ in 0..60 {
        let slope = 2.0 * r;
        let excess = slope.atan() + meridian(r) - ANGLE;
        r -= excess / (2.0 / (1.0 + slope * slope) + slope.hypot(1.0));
    }
    let (sine, cosine) = DIRECTION.sin_cos();
    let (x, y) = (state[2], state[3]);
    let found = [x, y, -(x * x + y * y)];
    let expected = [-sine * r, -cosine * r, -r * r];
    largest([(found, expected), (on_probe(state), after(meridian(r)))])
}

/// Median over batches of the time of one call, µs.
fn median_us(mut job: impl FnMut()) -> f64 {
    let start = Instant::now();
    job();
    let calls = (BATCH_S / start.elapsed().as_secs_f64()).max(1.0) as usize;
    let mut batch = || {
        let start = Instant::now();
        (0..calls).for_each(|_| job());
        start.elapsed().as_secs_f64() / calls as f64 * 1e6
    };
    batch();
    let mut times: Vec<f64> = (0..BATCHES).map(|_| batch()).collect();
    times.sort_by(f64::total_cmp);
    times[BATCHES / 2]
}

fn print_figure(object: &str, time_us: f64, error: f64) {
    println!(
        "{{\"task\": \"roll 6 rad over a {object}\", \"peer\": \"ode_solvers DOP853, 1e-12\", \
         \"version\": \"0.6.2\", \"time_us\": {time_us}, \"error\": {error}}}"
    );
}

fn main() {
    let time_us = median_us(|| {
        black_box(roll(OverSphere, black_box(LATITUDE)));
    });
    print_figure(
        "sphere",
        time_us,
        error_over_sphere(&roll(OverSphere, LATITUDE)),
    );
    let time_us = median_us(|| {
        black_box(roll(OverParaboloid, black_box(0.0)));
    });
    print_figure(
        "paraboloid",
        time_us,
        error_over_paraboloid(&roll(OverParaboloid, 0.0)),
    );
}
