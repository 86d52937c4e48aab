//! Claims 5 to 8 about the resolution of the contact sensor (1996 paper, section 4.1.3). Lengths are in units of the
//! probe's radius R₁, which is 1 cm in the paper.

use super::bounds::Bound::{Above, AtLeast, AtMost, Below, Between};
use super::bounds::{is, near, within};
use super::claim::Claim;
use super::rolls::{of_convex, rms_error, size_in_words};
use super::row::{Row, probe_radius, roll_angle, size, sorted};

const OFFSET: &str = "scene.sensor.offset";

pub(super) fn claims() -> [Claim; 4] {
    [pad_size(), zeros(), longer_rolls(), half_millimetre()]
}

fn of_pads(number: u32, texts: [&'static str; 3]) -> Claim {
    of_convex(number, texts).numbers(&["scene.probe.radius", "scene.sensor.pitch"])
}

fn pitch(row: &Row<'_>) -> Option<f64> {
    Some(row.number("scene.sensor.pitch")? / probe_radius(row)?)
}

/// The rms error in a row of the table. `None` if any trial failed: the rms error of the successful trials alone would
/// be too small.
fn complete_error(row: &Row<'_>) -> Option<f64> {
    rms_error(row).filter(|_| row.statistic("failures") == Some(0.0))
}

fn is_random(row: &Row<'_>) -> bool {
    row.text(OFFSET) == Some("random")
}

/// Whether the trials of a table row have random offsets of the pads, so that its error is a mean over these offsets.
/// If no row of the study has random offsets, the result is true for all rows.
fn is_statistical(row: &Row<'_>) -> bool {
    let values = row.study.cells().axis(OFFSET).map(|axis| axis.values());
    is_random(row) || !values.is_some_and(|values| values.iter().any(|value| value == "random"))
}

impl Claim {
    /// Adds a check that the error increases with `x`. The error must increase in at least 90 % of the steps between
    /// successive values of `x`. Steps in which the error does not change are ignored.
    fn growth(self, free: &'static [&'static str], x: fn(&Row<'_>) -> Option<f64>) -> Self {
        self.steps(free, x, complete_error)
            .when(is_statistical)
            .without(1.0)
            .bound(Above(1.0))
            .in_share(0.9)
    }
}

fn pad_size() -> Claim {
    let says = [
        "Error grows with the pad size",
        "grows",
        "The error grows with the size of the pads, and it grows more at low relative curvature.",
    ];
    of_pads(5, says)
        .growth(&["scene.sensor.pitch"], pitch)
        .says("the rms relative error grows in {count} steps from one pad size to the next coarser size")
        .headline("in {count} steps")
        .growth(&["scene.object"], size)
        .only(size, AtLeast(1.0))
        .says("it grows in {count} steps to a larger R₂ from R₁ up")
        .growth(&["scene.object"], |row| Some(-size(row)?))
        .only(size, AtMost(1.0))
        .reports("below R₁, where the contact moves less, it grows in {count} steps to a \
            sharper object")
        .remark(
            "Steps are between cells without failed trials, with random offsets if there are any; equal errors are \
             left out.",
        )
}

fn zeros() -> Claim {
    let estimate = |row: &Row<'_>| Some(row.statistic("mean")?.abs() * probe_radius(row)?);
    let centred_coarse = |row: &Row<'_>| !is_random(row) && within(pitch, Above(0.01))(row);
    let says = [
        "Coarse pads read large spheres flat",
        "zero in many cases",
        "In many cases the estimate is zero curvature for R₂ above 5 cm and pads coarser than \
            0.1 mm (R₁ = 1 cm).",
    ];
    of_pads(6, says)
        .rows(estimate)
        .when(centred_coarse)
        .only(size, AtLeast(5.0))
        .bound(AtMost(1e-12))
        .in_share(0.5)
        .says(
            "{count} cells from a pad's centre, with R₂ ≥ 5 R₁ and pads coarser than 0.01 \
            R₁, give zero curvature",
        )
        .headline("zero in {count} cells")
        .rows(estimate)
        .when(centred_coarse)
        .only(size, is(5.0))
        .bound(AtMost(1e-12))
        .reports("at R₂ = 5 R₁ {count} do")
        .remark("A curvature of at most 10⁻¹² / R₁ counts as zero.")
}

/// Rms errors of the estimates from the shortest and from the longest roll in a group of table rows. `None` if both
/// rolls have the same length or the same error.
fn ends(group: &[Row<'_>]) -> Option<(f64, f64)> {
    match sorted(group, roll_angle, complete_error)[..] {
        [first, .., last] if !near(first.0, last.0) && !near(first.1, last.1) => {
            Some((first.1, last.1))
        }
        _ => None,
    }
}

fn longer_rolls() -> Claim {
    let says = [
        "Longer rolls reduce errors from pads",
        "falls",
        "A longer roll reduces the error that pads cause.",
    ];
    of_pads(7, says)
        .groups(&["scene.motion"], |group| {
            ends(group).filter(|ends| ends.0 > 0.0).map(|(first, last)| last / first)
        })
        .when(is_statistical)
        .bound(Below(1.0))
        .in_share(0.9)
        .says(
            "from the shortest to the longest roll the rms error falls in {count} combinations of radius and \
             pitch|, to {range} × its value",
        )
        .headline("falls in {count}")
        .groups(&["scene.motion"], |group| ends(group).map(|ends| ends.0).filter(|first| *first == 0.0))
        .when(is_statistical)
        .reports("{n} more begin with a roll by a whole number of pads, which is read exactly")
        .growth(&["scene.motion"], roll_angle)
        .reports("the error rises in {count} single steps")
        .rows(roll_angle)
        .when(is_statistical)
        .reports("the rolls are {range} rad long")
        .remark("Cells with failed trials are left out; offsets are random if any are.")
}

fn half_millimetre() -> Claim {
    let half = |row: &Row<'_>| within(pitch, is(0.05))(row) && within(roll_angle, is(0.5))(row);
    let on_sphere =
        move |radius: f64| move |row: &Row<'_>| half(row) && within(size, is(radius))(row);
    let says = [
        "Half-millimetre pads suffice for spheres",
        "reasonable",
        "With 0.5 mm pads a roll of 0.5 rad gives a reasonable estimate for spheres from 5 to \
            0.2 cm (R₁ = 1 cm).",
    ];
    of_pads(8, says)
        .needs(
            "pads of 0.05 R₁ rolled by 0.5 rad on a sphere of 5 R₁",
            on_sphere(5.0),
        )
        .needs(
            "pads of 0.05 R₁ rolled by 0.5 rad on a sphere of 0.2 R₁",
            on_sphere(0.2),
        )
        .rows(rms_error)
        .when(half)
        .only(size, Between(0.2, 5.0))
        .named(|row| match is_random(row) {
            true => format!("random offsets, {}", size_in_words(row)),
            false => format!("centred, {}", size_in_words(row)),
        })
        .bound(AtMost(0.25))
        .says("the rms relative error is {list%}")
        .headline("{max%} at worst")
        .rows(|row| row.failed(|_| true))
        .when(half)
        .only(size, Between(0.2, 5.0))
        .bound(AtMost(0.0))
        .says("{max%} of a cell's trials fail")
}
