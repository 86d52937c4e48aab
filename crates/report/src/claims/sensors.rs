//! Claims 14, 18, 19 and 22 about markers in camera images and about the skin (2020 paper, sections III and IV.A).

use super::bounds::Bound::{Above, AtLeast, AtMost, Below};
use super::bounds::{near, range};
use super::claim::Claim;
use super::row::{Row, groups};

/// Slope of the straight line through all 39 readings in the paper's Fig. 6b, turns/mm. `palpate sensor calibrate`
/// computed it in `examples/chromatouch-2020/`.
const HUE_SLOPE: f64 = 0.02583;
/// Slope of the straight line through the readings in the paper's Fig. 6c, px/mm. `palpate sensor calibrate` computed
/// it in `examples/chromatouch-2020/`.
const CENTROID_SLOPE: f64 = 7.0;

pub(super) fn claims() -> [Claim; 4] {
    [linear(), gores(), fisheye(), slopes()]
}

fn mean(row: &Row<'_>) -> Option<f64> {
    row.statistic("mean")
}

/// Tangential displacement of the marker; 0 if neither the table nor the config states it.
fn shift(row: &Row<'_>) -> Option<f64> {
    Some(row.number("scene.motion.shift").unwrap_or(0.0))
}

fn indentation(row: &Row<'_>) -> Option<f64> {
    row.number("scene.motion.indentation")
}

fn read(row: &Row<'_>) -> Option<(f64, f64)> {
    Some((mean(row)?, row.statistic("std").unwrap_or(0.0)))
}

/// Straight lines that were fitted to groups of table rows, each with the first row of its group.
type Lines<'a> = Vec<(Row<'a>, StraightLine)>;

/// The two hues of a marker: name of the quantity, and name of the hue in sentences. The paper uses the mean hue.
const HUES: [(&str, &str); 2] = [
    ("hue_change", "hue of the summed light"),
    ("mean_hue_change", "mean hue"),
];

/// Straight lines that are fitted to a measured hue as a function of the indentation, one line for each combination of
/// the other swept fields. Only markers without tangential displacement are used.
fn hue<'a>(rows: &[Row<'a>], quantity: &str) -> Lines<'a> {
    through(
        unmoved(rows, quantity),
        &["scene.motion"],
        indentation,
        read,
    )
}

/// Straight lines that are fitted to the true hue (without pixels and noise) as a function of the indentation, one line
/// for each combination of the other swept fields.
fn exact_hue<'a>(rows: &[Row<'a>], quantity: &str) -> Lines<'a> {
    let exact = |row: &Row<'_>| Some((row.statistic("truth")?, 0.0));
    through(
        unmoved(rows, quantity),
        &["scene.motion"],
        indentation,
        exact,
    )
}

fn unmoved<'a>(rows: &[Row<'a>], quantity: &str) -> Vec<Row<'a>> {
    let is_unmoved = |row: &&Row<'_>| row.quantity() == quantity && shift(row) == Some(0.0);
    rows.iter().filter(is_unmoved).copied().collect()
}

/// Straight lines that are fitted to the shift of a marker's centroid in the image as a function of the tangential
/// displacement. There is one line for each indentation and each combination of the other swept fields.
fn centroid<'a>(rows: &[Row<'a>]) -> Lines<'a> {
    let shifts = rows.iter().filter(|row| row.quantity() == "centroid_shift");
    through(
        shifts.copied().collect(),
        &["scene.motion.shift"],
        shift,
        read,
    )
}

/// Fits one straight line to each group of table rows. The rows of a group differ only in swept fields whose paths
/// begin with one of the texts in `free`. For each row, `along` returns x, and `read` returns the mean and the standard
/// deviation of the measured y.
fn through<'a>(
    rows: Vec<Row<'a>>,
    free: &[&str],
    along: fn(&Row<'_>) -> Option<f64>,
    read: fn(&Row<'_>) -> Option<(f64, f64)>,
) -> Lines<'a> {
    let reading = |row: &Row<'_>| {
        let (mean, std) = read(row)?;
        Some(Reading {
            x: along(row)?,
            mean,
            std,
        })
    };
    let line = |group: Vec<Row<'a>>| {
        let readings: Vec<Reading> = group.iter().filter_map(reading).collect();
        Some((group[0], StraightLine::through(&readings)?))
    };
    groups(&rows, free).into_iter().filter_map(line).collect()
}

impl Claim {
    fn lines(
        self,
        lines: impl for<'a> Fn(&[Row<'a>]) -> Lines<'a> + 'static,
        number: impl Fn(&Row<'_>, StraightLine) -> Option<f64> + 'static,
    ) -> Self {
        self.values(move |rows| {
            let lines = lines(rows).into_iter();
            let numbers = lines.filter_map(|(row, line)| Some((row, number(&row, line)?)));
            numbers.collect()
        })
    }
}

fn linear() -> Claim {
    let object = |row: &Row<'_>| row.swept(&["scene.object"]);
    let says = [
        "Hue and centroid respond linearly",
        "R² 0.89; 0.99",
        "A marker's hue is linear in its normal displacement, and its centroid is linear in its tangential \
         displacement.",
    ];
    let mut claim = Claim::new(14, says, "rows", |_| true);
    for (quantity, name) in HUES {
        let steeper = |row: &Row<'_>, line| {
            let ratio = 1.0 / hue_share(row, line)?;
            Some(ratio).filter(|ratio| ratio.is_finite())
        };
        claim = claim
            .lines(
                move |rows| hue(rows, quantity),
                |_, line| Some(line.r_squared),
            )
            .bound(AtLeast(0.89))
            .says(format!(
                "R² of the {name} at three or more indentations is {{range}}"
            ))
            .headline("R² {range}")
            .lines(move |rows| hue(rows, quantity), slope)
            .named(object)
            .reports(format!("slopes of the {name} are {{list}} turns/mm"))
            .lines(move |rows| hue(rows, quantity), steeper)
            .reports(format!(
                "the published slope of 0.02583 turns/mm is {{range}} times that of the {name}"
            ));
    }
    claim
        .lines(centroid, |_, line| Some(line.r_squared))
        .bound(AtLeast(0.99))
        .says("R² of the centroid at three or more shifts is {range}")
        .headline("{range}")
        .lines(centroid, slope)
        .named(object)
        .reports("slopes of the centroid are {list} px/mm")
        .remark(
            "The paper stores the mean hue. The bounds are the paper's own R². The scatter of single readings counts \
             against it. Per object the slopes of the paper's hues differ by ±20 %.",
        )
}

/// Slope of a fitted line, converted from the study's length unit to 1/mm; `None` if this unit is not metric.
fn slope(row: &Row<'_>, line: StraightLine) -> Option<f64> {
    Some(line.slope / row.millimetres()?)
}

/// Slope of a line that is fitted to hues, divided by the slope in the paper.
fn hue_share(row: &Row<'_>, line: StraightLine) -> Option<f64> {
    Some(slope(row, line)? / HUE_SLOPE)
}

/// Slope of a line that is fitted to centroids, divided by the slope in the paper.
fn centroid_share(row: &Row<'_>, line: StraightLine) -> Option<f64> {
    Some(slope(row, line)? / CENTROID_SLOPE)
}

fn sensor(row: &Row<'_>) -> String {
    row.swept(&["scene.sensor"])
}

/// Whether the discs of the markers are rigid, as in the paper's model: the config states no strain of skin or discs.
fn is_rigid(row: &Row<'_>) -> bool {
    let strains = ["strain", "yellow_strain"].map(|key| format!("scene.probe.discs.{key}"));
    strains.iter().all(|path| row.number(path).is_none())
}

/// Compares fitted slopes with the two slopes that the paper states, for the hue and for the centroid. For each line
/// that is fitted to hues, returns the larger of two relative deviations. The first is the deviation of its slope from
/// the published slope of the hue. The second is the deviation of a centroid line of the same sensor from the published
/// slope of the centroid, namely of the line with the smallest deviation.
fn farther_off<'a>(rows: &[Row<'a>], quantity: &str) -> Vec<(Row<'a>, f64)> {
    let off = |share: f64| (share - 1.0).abs();
    let centroids = centroid(rows);
    let both = |(row, line): (Row<'a>, StraightLine)| {
        let same = centroids
            .iter()
            .filter(|(other, _)| sensor(other) == sensor(&row));
        let shares = same.filter_map(|(row, line)| centroid_share(row, *line));
        let centroid = shares.map(off).reduce(f64::min)?;
        Some((row, centroid.max(off(hue_share(&row, line)?))))
    };
    hue(rows, quantity).into_iter().filter_map(both).collect()
}

fn slopes() -> Claim {
    let says = [
        "Hue and centroid slopes as published",
        "0.0258 turns/mm; 7 px/mm",
        "A marker's hue changes by 0.0258 turns per millimetre of indentation, its centroid by 7.0 px per millimetre \
         of shift.",
    ];
    let discs = |row: &Row<'_>| row.swept(&["scene.probe.discs"]);
    let mut claim = Claim::new(22, says, "rows", |_| true);
    for (quantity, name) in HUES {
        claim = claim
            .lines(move |rows| hue(rows, quantity), hue_share)
            .named(sensor)
            .reports(format!(
                "the slope of the {name} is, of the published 0.02583 turns/mm, {{list%}}"
            ))
            .headline("{range%}")
            .lines(move |rows| exact_hue(rows, quantity), hue_share)
            .named(discs)
            .reports("without pixels {list%}")
            .lines(
                move |rows| hue(rows, quantity),
                |_, line| Some(line.r_squared),
            )
            .reports("its R² is {range}, where 0.89 is published");
    }
    claim
        .lines(centroid, centroid_share)
        .named(sensor)
        .reports("the slope of the centroid is, of the published 7 px/mm, {list%}")
        .headline("{range%}")
        .values(|rows| farther_off(rows, HUES[0].0))
        .reports("with the hue of the summed light, both slopes of a sensor are off by {range%}")
        .values(|rows| farther_off(rows, HUES[1].0))
        .named(sensor)
        .comparing(is_rigid)
        .bound(AtMost(0.2))
        .in_one()
        .says("with the mean hue, both slopes of a sensor are off by {list%}")
        .remark(
            "The paper stores the mean hue. Sensors whose skin strains are only reported. The bound is that by which \
             the paper's slopes of the hue differ between objects. The paper does not determine which disc is nearer \
             to the camera, how stiff the yellow film is, or how large the frames are.",
        )
}

fn gore_count(row: &Row<'_>) -> Option<f64> {
    row.number("scene.probe.layout.gores")
}

fn gores() -> Claim {
    const COUNTS: [f64; 3] = [4.0, 6.0, 8.0];
    let says = [
        "More gores distort the skin less",
        "less for 6 and 8 than 4",
        "A skin cut into 6 or 8 gores is distorted less than a skin of 4 gores.",
    ];
    let mut claim = Claim::new(18, says, "skin of 4, 6 or 8 gores", |row| {
        gore_count(row).is_some_and(|count| COUNTS.contains(&count))
    });
    for (quantity, headline) in [("greatest_fold_strain", "{list%}"), ("rms_fold_strain", "")] {
        for count in COUNTS {
            claim = claim.needs(format!("{quantity} of {count} gores"), move |row| {
                row.quantity() == quantity && gore_count(row) == Some(count)
            });
        }
        let words = quantity.replace('_', " ");
        claim = claim
            .rows(mean)
            .of(quantity)
            .named(|row| format!("{} gores", gore_count(row).unwrap_or_default()))
            .reports(format!("the {words} is {{list%}}"))
            .headline(headline)
            .steps(&["scene.probe.layout"], gore_count, mean)
            .of(quantity)
            .bound(Below(1.0))
            .says(format!(
                "the {words} falls in {{count}} steps from 4 to 6 and 8 gores"
            ));
    }
    claim
}

/// Polar angle of a marker in the camera's view, degrees; `None` if the image does not show the marker.
fn polar(row: &Row<'_>) -> Option<f64> {
    row.number("scene.view.polar_deg")
        .filter(|_| mean(row).is_some_and(|area| area > 0.0))
}

fn fisheye() -> Claim {
    let says = [
        "Fisheye keeps the marker area even",
        "similar area",
        "The fisheye lens gives all markers a similar area in the image.",
    ];
    let is_area = |row: &Row<'_>| row.quantity() == "marker_area" && polar(row).is_some();
    let mut claim = Claim::new(19, says, "marker_area at a polar angle", is_area);
    for (lens, bound, headline) in [
        ("fisheye", AtMost(1.25), "ratio {range}"),
        ("pinhole", Above(1.25), "pinhole {range}"),
    ] {
        claim = claim
            .groups(&["scene.view"], |group| {
                let (smallest, largest) = range(group.iter().filter_map(mean))?;
                let angles = range(group.iter().filter_map(polar))?;
                (angles.0 < angles.1).then(|| largest / smallest)
            })
            .when(move |row| row.text("scene.sensor.lens") == Some(lens))
            .bound(bound)
            .says(format!(
                "the largest image area of a marker under the {lens} is {{range}} \
                times the smallest"
            ))
            .headline(headline)
            .rows(polar)
            .when(move |row| row.text("scene.sensor.lens") == Some(lens))
            .reports("over polar angles of {range}°");
    }
    claim
}

/// Mean and standard deviation of all values of y that were measured at the same x.
#[derive(Debug, Clone, Copy)]
struct Reading {
    x: f64,
    mean: f64,
    std: f64,
}

#[derive(Debug, Clone, Copy)]
struct StraightLine {
    slope: f64,
    /// Share of the variance of the single readings that the line explains (R²); 0 if the readings have no variance.
    r_squared: f64,
}

impl StraightLine {
    /// Fits a line to `readings` with equal weights. `None` for fewer than three different x, because a line through
    /// two points always fits exactly.
    fn through(readings: &[Reading]) -> Option<Self> {
        let mut places: Vec<f64> = readings.iter().map(|reading| reading.x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| near(*a, *b));
        if places.len() < 3 {
            return None;
        }
        let count = readings.len() as f64;
        let mean = |of: &dyn Fn(&Reading) -> f64| readings.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|r| r.x), mean(&|r| r.mean));
        let slope = mean(&|r| (r.x - x) * (r.mean - y)) / mean(&|r| (r.x - x).powi(2));
        let scatter = mean(&|r| r.std * r.std);
        let left = mean(&|r| (r.mean - y - slope * (r.x - x)).powi(2)) + scatter;
        let all = mean(&|r| (r.mean - y).powi(2)) + scatter;
        let r_squared = if all > 0.0 { 1.0 - left / all } else { 0.0 };
        (slope.is_finite() && r_squared.is_finite()).then_some(Self { slope, r_squared })
    }
}
