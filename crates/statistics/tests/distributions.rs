//! Compares tail probabilities of the chi-squared, F, t and normal distributions with published tables and closed
//! forms.

use palpate_statistics::{
    CERTAIN, HALF_WIDTHS, NORMAL_95, chi_squared_tail, normal_tail, ratio_tail, score_of_tail,
    student_half_width,
};

/// Largest number of degrees of freedom that `ratio_tail` uses; larger numbers are replaced by this number.
const MOST_FREEDOM: usize = 1_000_000_000;

/// Percentage points of chi-squared from published tables (Abramowitz and Stegun, table 26.8): degrees of freedom,
/// chi-squared, and tail probability.
const POINTS: [(usize, f64, f64); 7] = [
    (1, 3.841_459, 0.05),
    (2, 9.210_340, 0.01),
    (5, 11.070_50, 0.05),
    (10, 29.588_30, 0.001),
    (30, 18.492_66, 0.95),
    (75, 96.216_67, 0.05),
    (100, 135.806_72, 0.01),
];

#[test]
fn tails_are_those_of_tables() {
    for (freedom, chi_squared, probability) in POINTS {
        let found = chi_squared_tail(chi_squared, freedom);
        assert!(
            (found / probability - 1.0).abs() < 1e-4,
            "{found} with {freedom}"
        );
    }
}

/// Percentage points of F from published tables (Abramowitz and Stegun, table 26.9): both degrees of freedom, F,
/// and tail probability.
const RATIOS: [(usize, usize, f64, f64); 8] = [
    (1, 1, 161.447_6, 0.05),
    (1, 12, 4.747_225, 0.05),
    (2, 1, 199.5, 0.05),
    (4, 9, 6.422_085, 0.01),
    (6, 5, 4.950_288, 0.05),
    (10, 30, 2.979_1, 0.01),
    (30, 30, 1.840_9, 0.05),
    (120, 60, 1.467_3, 0.05),
];

#[test]
fn ratios_are_those_of_tables() {
    for (of_above, of_below, ratio, probability) in RATIOS {
        let found = ratio_tail(ratio * of_above as f64, of_above, of_below as f64, of_below);
        assert!(
            (found / probability - 1.0).abs() < 3e-4,
            "{found} with {of_above} and {of_below}"
        );
    }
}

#[test]
fn half_widths_are_those_of_tables() {
    for (freedom, probability, half_width) in [
        (1, 0.95, 12.706),
        (5, 0.5, 0.727),
        (5, 0.8, 1.476),
        (13, 0.95, 2.160),
        (30, 0.99, 2.750),
        (120, 0.95, 1.980),
    ] {
        let found = student_half_width(probability, freedom);
        assert!((found - half_width).abs() < 6e-4, "{found} with {freedom}");
    }
    let of_many = student_half_width(0.95, 100_000_000);
    assert!((of_many - NORMAL_95).abs() < 1e-6, "{of_many}");
    for (probability, freedom) in [(0.95, 0), (1.0, 7), (f64::NAN, 3)] {
        assert_eq!(student_half_width(probability, freedom), f64::INFINITY);
    }
    for probability in [0.0, -1.0, f64::NEG_INFINITY] {
        assert_eq!(student_half_width(probability, 3), 0.0);
    }
    // The half-width of a narrow interval follows from the density at 0. For Student's t with 3 degrees of freedom,
    // this density is 2/(π√3).
    let narrow = student_half_width(1e-9, 3);
    let due = 0.5e-9 * 0.5 * std::f64::consts::PI * 3_f64.sqrt();
    assert!((narrow - due).abs() < 1e-6 * due, "{narrow:e} {due:e}");
}

#[test]
fn ratios_with_two_degrees_below_and_above_are_in_closed_form() {
    for ratio in [1e-8, 0.3, 2.0, 70.0, 1e9] {
        let below = ratio_tail(ratio, 2, 2.0, 2);
        assert!((below * (1.0 + ratio / 2.0) - 1.0).abs() < 1e-12, "{below}");
        // Closed form: if F has 2 and n degrees of freedom, the probability of F > f is (1 + 2 f/n)^(−n/2).
        let of_many = ratio_tail(2.0 * ratio, 2, 7.0, 7);
        let exact = libm::exp(-3.5 * libm::log1p(2.0 * ratio / 7.0));
        assert!((of_many / exact - 1.0).abs() < 1e-10, "{of_many} {exact}");
    }
}

#[test]
fn tails_of_any_numbers_are_probabilities() {
    let sums = [0.0, 1e-300, 1.0, 1e5, 1e300, f64::INFINITY];
    let counts = [0, 1, 2, 77, 100_000];
    for freedom in counts {
        for sum in sums {
            let found = chi_squared_tail(sum, freedom);
            assert!((0.0..=1.0).contains(&found), "{found}");
            for (below, of_below) in sums.iter().flat_map(|sum| counts.map(|n| (*sum, n))) {
                let found = ratio_tail(sum, freedom, below, of_below);
                assert!((0.0..=1.0).contains(&found), "{found}");
            }
        }
        if freedom > 0 {
            assert_eq!(chi_squared_tail(f64::INFINITY, freedom), 0.0);
        }
    }
}

#[test]
fn far_tails_and_many_degrees_keep_their_digits() {
    let is_near = |found: f64, due: f64, bound: f64, what: &str| {
        assert!(
            (found - due).abs() <= bound,
            "{what}: {found:e}, not {due:e}"
        );
    };
    for (sum, freedom, due) in [
        (1e-300, 6, 1.0),
        (1e-9, 2, 0.999_999_999_5),
        (30.0, 6, 3.930_844_818_448_461e-5),
        (700.0, 100, 8.658_230_861_323_854e-91),
        (1400.0, 2, 9.859_676_543_759_77e-305),
    ] {
        let found = chi_squared_tail(sum, freedom);
        is_near(found, due, 1e-12 * due, "chi-squared");
    }
    // Up to a million degrees of freedom, the tail is computed as a sum. The test uses degrees of freedom just below
    // and just above this limit, and the largest `usize`.
    for (freedom, due) in [
        (999_999, 0.499_811_936_709_362_8),
        (1_000_001, 0.499_811_936_897_426_03),
        (usize::MAX, 0.499_999_999_956_213_14),
    ] {
        let found = chi_squared_tail(freedom as f64, freedom);
        is_near(found, due, 1e-9, "as much as freedom");
        assert_eq!(chi_squared_tail(1e200 * freedom as f64, freedom), 0.0);
        assert!(chi_squared_tail(0.5 * freedom as f64, freedom) > 1.0 - 1e-9);
        is_near(
            ratio_tail(freedom as f64, freedom, freedom as f64, freedom),
            0.5,
            1e-14 * MOST_FREEDOM.min(freedom) as f64,
            "as much above as below",
        );
    }
    for (ratio, below, due) in [
        (1e-9, 1, 0.999_999_999),
        (30.0, 1000, 2.223_654_796_488_696_8e-13),
        (1.0, usize::MAX, 0.367_879_441_171_442_33),
    ] {
        let found = ratio_tail(2.0 * ratio, 2, below as f64, below);
        let bound = (1e-14 * below.min(MOST_FREEDOM) as f64).max(1e-10);
        is_near(found, due, bound, "ratio");
    }
    // Half-widths from closed-form quantiles of Student's t: for one degree of freedom (`of_one`, computed with a
    // tangent) and for two degrees (`of_two`, computed with a square root).
    for (probability, of_one, of_two) in [
        (
            1e-300,
            1.570_796_326_794_896_8e-300,
            1.414_213_562_373_095e-300,
        ),
        (
            0.99e-6,
            1.555_088_363_528_201_3e-6,
            1.400_071_426_750_050_3e-6,
        ),
        (0.999_999, 636_619.772_348_751_3, 999.999_249_985_465_9),
        (
            1.0 - f64::EPSILON / 2.0,
            5_734_161_139_222_659.0,
            94_906_265.624_251_54,
        ),
    ] {
        for (freedom, due) in [(1, of_one), (2, of_two)] {
            let found = student_half_width(probability, freedom);
            is_near(found, due, 1e-9 * due, "Student's t");
        }
    }
    let found = student_half_width(0.95, 1_000_000);
    is_near(found, 1.959_966_356_811_284_4, 1e-8, "Student's t of many");
    for none in [f64::NAN, f64::INFINITY] {
        assert_eq!(chi_squared_tail(none, 3), 0.0);
        assert_eq!(ratio_tail(none, 3, 1.0, 5), 0.0);
    }
    assert_eq!(chi_squared_tail(-1.0, 3), 1.0);
    assert_eq!(ratio_tail(1.0, 3, 0.0, 5), 0.0);
    assert_eq!(ratio_tail(0.0, 3, 0.0, 5), 1.0);
}

#[test]
fn tails_and_scores_are_inverse() {
    for score in [-3.0, -1.0, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 30.0] {
        let found = score_of_tail(normal_tail(score));
        assert!((found - score).abs() < 1e-8, "{score}");
    }
}

#[test]
fn far_tails_keep_their_digits_and_no_probabilities_have_the_last_scores() {
    for (score, due) in [
        (1e-9, 0.499_999_999_601_057_73),
        (-1e-3, 0.500_398_942_213_911),
        (12.0, 1.776_482_112_077_679e-33),
        (37.0, 5.725_571_222_524_577e-300),
        (f64::INFINITY, 0.0),
        (f64::MIN, 1.0),
    ] {
        let found = normal_tail(score);
        assert!((found - due).abs() <= 1e-13 * due, "{score}: {found:e}");
    }
    for (probability, due, bound) in [
        (f64::NAN, -CERTAIN, 1e-12),
        (1.0, -CERTAIN, 1e-12),
        (-1.0, CERTAIN, 1e-12),
        (0.0, 39.0, 1.0),
    ] {
        let found = score_of_tail(probability);
        assert!((found - due).abs() <= bound, "{probability}: {found}");
    }
}

#[test]
fn half_widths_leave_half_of_the_rest_above() {
    for (half_width, share) in HALF_WIDTHS.into_iter().zip([0.5, 0.8, 0.95]) {
        let above = normal_tail(half_width);
        assert!((1.0 - 2.0 * above - share).abs() < 1e-15, "{share}");
    }
}
