//! Tails of the normal distribution, of chi-squared, of F and of Student's t.

use palpate_chance::{
    CERTAIN, NORMAL_95, chi_squared_tail, normal_tail, ratio_tail, score_of_tail,
    student_half_width,
};
use palpate_verdict::{Answer, Precise, rows};

const NORMAL: &str = "chance::normal_tail";
const SCORE: &str = "chance::score_of_tail";
const CHI_SQUARED: &str = "chance::chi_squared_tail";
const RATIO: &str = "chance::ratio_tail";
const STUDENT: &str = "chance::student_half_width";

/// Sums of squares.
const SUMS: [f64; 8] = [0.0, 1e-300, 1e-9, 1.0, 30.0, 700.0, 1400.0, 2000.0];
const RATIOS: [f64; 6] = [0.0, 1e-300, 1e-9, 1.0, 30.0, 1e9];
const NO_SUMS: [f64; 4] = [f64::NEG_INFINITY, -1.0, -0.0, 0.0];
/// Sums of squares above and below whose ratio is none, and the probability.
const NO_RATIOS: [(f64, f64, f64); 4] = [
    (f64::NAN, 1.0, 0.0),
    (1.0, 0.0, 0.0),
    (f64::INFINITY, 1.0, 0.0),
    (0.0, 0.0, 1.0),
];
/// Probabilities within half-widths.
const INSIDE: [f64; 9] = [
    1e-300,
    1e-12,
    0.99e-6,
    1e-6,
    0.5,
    0.95,
    0.999_999,
    1.0 - 1e-12,
    1.0 - f64::EPSILON / 2.0,
];
/// Degrees of freedom.
const COUNTS: [usize; 6] = [1, 2, 1000, 1_000_000, 1_000_000_000, usize::MAX];

rows! {
    NORMAL, "score {score}: by its asymptotic series" => far(score), for score in [12.0, 20.0, 30.0, 37.0];
    NORMAL, "score {score:e}: by its power series" => near(score), for score in [0.0, 1e-300, 1e-9, 1e-3, -1e-3];
    NORMAL, "score {score:e}: {truth}" => Answer::near(normal_tail(score), truth),
        for (score, truth) in [(f64::INFINITY, 0.0), (f64::MAX, 0.0), (f64::MIN, 1.0), (f64::NEG_INFINITY, 1.0)];
    SCORE, "tail of {score:e}, and back" => back(score),
        for score in [-37.0, -8.0, -1.0, -1e-9, 0.0, 1e-3, 1.0, 8.0, 30.0, 37.0];
    SCORE, "probability {none:e}: -40" => Answer::at_scale(score_of_tail(none), -CERTAIN, 1.0).within(1e-12),
        for none in [f64::NAN, f64::INFINITY, 2.0, 1.0];
    SCORE, "probability {none:e}: 40" => Answer::at_scale(score_of_tail(none), CERTAIN, 1.0).within(1e-12),
        for none in [-f64::from_bits(1), -1.0, f64::NEG_INFINITY];
    SCORE, "probability {none:e}: 38 to 40" => Answer::at_scale(score_of_tail(none), 39.0, 1.0).within(1.0),
        for none in [0.0, f64::from_bits(1)];
    CHI_SQUARED, "{x:e} with {freedom} degrees of freedom: terms of an exponential" => terms(x, freedom),
        for x in SUMS, for freedom in [2, 6, 100];
    CHI_SQUARED, "as much as {freedom} degrees of freedom: by its asymptotic series" => middle(freedom),
        for freedom in [1000, 999_999, 1_000_000, 1_000_001, 1_000_000_000, 1 << 50, usize::MAX];
    CHI_SQUARED, "{times} times as much as {freedom} degrees of freedom: {truth}" =>
        Answer::near(chi_squared_tail(times * freedom as f64, freedom), truth).within(1e-9),
        for (times, truth) in [(0.5, 1.0), (2.0, 0.0), (1e200, 0.0)], for freedom in [100_000, usize::MAX];
    CHI_SQUARED, "{none:e} with {freedom} degrees of freedom: 1" => Answer::near(chi_squared_tail(none, freedom), 1.0),
        for none in NO_SUMS, for freedom in [0, 1, usize::MAX];
    CHI_SQUARED, "{x:e} with {freedom} degrees of freedom: 0" => Answer::near(chi_squared_tail(x, freedom), 0.0),
        for x in [f64::NAN, f64::INFINITY, f64::MAX], for freedom in COUNTS;
    RATIO, "1 with {count} degrees of freedom above and below" => even(count), for count in COUNTS;
    RATIO, "{ratio:e} with 2 degrees of freedom above and {below} below: a power" => power(ratio, below),
        for ratio in RATIOS, for below in COUNTS;
    RATIO, "{above:e} over {below:e} with 3 degrees of freedom above and 5 below: {truth}" =>
        Answer::near(ratio_tail(above, 3, below, 5), truth),
        for (above, below, truth) in NO_RATIOS;
    RATIO, "1 with {above} degrees of freedom above and {below} below: 1" =>
        Answer::near(ratio_tail(1.0, above, 1.0, below), 1.0),
        for (above, below) in [(0, 1), (1, 0), (0, 0), (usize::MAX, 0)];
    STUDENT, "{probability:e} with a degree of freedom: a tangent" => tangent(probability), for probability in INSIDE;
    STUDENT, "{probability:e} with 2 degrees of freedom: a root" => of_two(probability), for probability in INSIDE;
    STUDENT, "0.95 with {freedom} degrees of freedom: by its series about the normal one" => of_many(freedom),
        for freedom in [1_000_000, 1_000_000_000, usize::MAX];
    STUDENT, "{probability:e} with {freedom} degrees of freedom: 0" =>
        Answer::near(student_half_width(probability, freedom), 0.0),
        for probability in [0.0, -1.0, f64::NEG_INFINITY], for freedom in [1, usize::MAX];
    STUDENT, "{probability:e} with {freedom} degrees of freedom: 1 where it is infinite" =>
        Answer::holds(student_half_width(probability, freedom) == f64::INFINITY),
        for (probability, freedom) in [(1.0, 1), (2.0, 7), (f64::NAN, 1), (f64::INFINITY, 3), (0.5, 0)];
}

/// Probability above a score from its asymptotic series (Abramowitz and Stegun 26.2.12).
fn far(score: f64) -> Answer {
    let x = Precise::new(score);
    let square = x.squared();
    let (mut term, mut sum) = (Precise::new(1.0), Precise::new(1.0));
    for odd in (1..40).step_by(2) {
        term = term * -f64::from(odd) / &square;
        sum = sum + &term;
    }
    let density = (square * -0.5).exp() / (Precise::pi() * 2.0).sqrt();
    Answer::near(normal_tail(score), (density * sum / x).to_f64()).within(1e-13)
}

/// Probability above a score near 0 from its power series (Abramowitz and Stegun 26.2.10).
fn near(score: f64) -> Answer {
    let x = Precise::new(score);
    let square = x.squared();
    let series = (1.0 - &square / 6.0 + square.squared() / 40.0) * x;
    let truth = 0.5 - series / (Precise::pi() * 2.0).sqrt();
    Answer::near(normal_tail(score), truth.to_f64()).within(1e-15)
}

/// The rounding of a tail is seen in the score by the tail over the density.
fn back(score: f64) -> Answer {
    let density = libm::exp(-0.5 * score * score) * 0.4;
    let tail = normal_tail(score);
    Answer::at_scale(score_of_tail(tail), score, 1.0)
        .within(1e-12)
        .conditioned(tail / density)
        .or_no_digits()
}

/// With an even number of degrees of freedom, the first terms of the series of exp(x/2), times exp(−x/2).
fn terms(x: f64, freedom: usize) -> Answer {
    let half = Precise::new(x) * 0.5;
    let (mut term, mut sum) = (Precise::new(1.0), Precise::new(0.0));
    for count in 1..=freedom / 2 {
        sum = sum + &term;
        term = term * &half / count as f64;
    }
    let truth = (half * -1.0).exp() * sum;
    Answer::near(chi_squared_tail(x, freedom), truth.to_f64()).within(1e-12)
}

/// ½ − (⅓ + 1/540a − 25/6048a²)/√2πa, with half as many degrees of freedom as a (DLMF 8.12.4 and 8.12.7 at a).
fn middle(freedom: usize) -> Answer {
    let a = Precise::new(freedom as f64) * 0.5;
    let terms = 1.0 / Precise::new(3.0) + 1.0 / (&a * 540.0) - 25.0 / (a.squared() * 6048.0);
    let truth = 0.5 - terms / (Precise::pi() * 2.0 * a).sqrt();
    Answer::near(chi_squared_tail(freedom as f64, freedom), truth.to_f64()).within(1e-9)
}

/// Error that the documentation of `ratio_tail` allows.
fn of_ratio(freedom: usize) -> f64 {
    (1e-14 * freedom.min(1_000_000_000) as f64).max(1e-10)
}

fn even(count: usize) -> Answer {
    let sum = count as f64;
    Answer::near(ratio_tail(sum, count, sum, count), 0.5).within(of_ratio(count))
}

/// (1 + 2f/n)^(−n/2).
fn power(ratio: f64, below: usize) -> Answer {
    let count = below as f64;
    let truth = ((1.0 + Precise::new(ratio) * 2.0 / count).ln() * (-0.5 * count)).exp();
    let found = ratio_tail(2.0 * ratio, 2, count, below);
    Answer::at_scale(found, truth.to_f64(), 1.0).within(of_ratio(below))
}

fn tangent(probability: f64) -> Answer {
    let angle = Precise::pi() * probability * 0.5;
    let truth = angle.sin() / angle.cos();
    Answer::near(student_half_width(probability, 1), truth.to_f64()).within(1e-9)
}

/// p √(2/(1 − p²)).
fn of_two(probability: f64) -> Answer {
    let p = Precise::new(probability);
    let truth = (2.0 / (1.0 - p.squared())).sqrt() * p;
    Answer::near(student_half_width(probability, 2), truth.to_f64()).within(1e-9)
}

/// z + (z³ + z)/4n (Abramowitz and Stegun 26.7.5).
fn of_many(freedom: usize) -> Answer {
    let cube = NORMAL_95 * NORMAL_95 * NORMAL_95;
    let truth = NORMAL_95 + (cube + NORMAL_95) / (4.0 * freedom as f64);
    Answer::near(student_half_width(0.95, freedom), truth).within(1e-8)
}
