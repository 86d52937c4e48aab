//! Tests image fits at their limits: sensors of any size, presses that images can hardly resolve, and the names of the
//! errors for impossible inputs.

use palpate_press::Rest;

use super::*;

const MARKERS: usize = 81;
const EXACT: [f64; 5] = [0.0; 5];
/// True deviations of the sensor parameters from their nominal values: both disc depths, both coordinates of the image
/// centre (px), and pixels per radian (relative).
const DEPARTED: [f64; 5] = [0.0, 0.0, 0.3, -0.2, 0.005];

#[derive(Clone, Copy)]
struct Press {
    /// Unit of length of the press. The radius of the skin is 20 units.
    unit: f64,
    /// Standard deviations of the uncertain sensor parameters: disc depths, image centre, and pixels per radian.
    known: [f64; 5],
    /// Ratio of the noise that is stated to the fit to the noise [`STDS`].
    stated: f64,
    object: f64,
    /// Position of the contact along x, in multiples of `unit`.
    x: f64,
    /// Indentation, as a share of the sensor's radius.
    depth: f64,
}

const PRESS: Press = Press {
    unit: 1.0,
    known: EXACT,
    stated: 1.0,
    object: 0.25,
    x: 2.5,
    depth: 0.05,
};

impl Press {
    fn fit(&self) -> ImageFit {
        ImageFit {
            misalignment_std: 0.0,
            ..Ideal::new(self.unit).fit(None, self.known)
        }
    }

    fn seen(&self, common: &[f64; 5], moved: &[[MarkerDisplacement; 2]]) -> Vec<Option<Seen>> {
        let misalignments = &[[0.0; 2]; MARKERS];
        let sensor = SensorState {
            common,
            misalignments,
        };
        let pictures = Ideal::new(self.unit).pictures(&sensor, moved).unwrap();
        let variances = STDS.map(|std| (self.stated * std) * (self.stated * std));
        let covariance = Matrix4::from_diagonal(&variances.into());
        let seen = |picture| Seen {
            picture,
            covariance,
        };
        let pictures = pictures.into_iter();
        pictures.map(|picture| picture.map(seen)).collect()
    }

    fn at_rest(&self) -> Vec<Option<Seen>> {
        self.seen(&EXACT, &[[MarkerDisplacement::default(); 2]; MARKERS])
    }

    fn rest(&self) -> Rest {
        self.fit().at_rest(&self.at_rest()).unwrap()
    }

    fn moved(&self) -> Vec<[MarkerDisplacement; 2]> {
        let ideal = Ideal::new(self.unit);
        let (skin, markers) = (ideal.skin(), ideal.markers());
        let [magenta, yellow] = ideal.bodies(None, [0.0; 2]).map(|body| {
            let depth = self.depth * skin.radius();
            let contact = skin.contact(&body, self.object * skin.curvature(), depth);
            markers.displacements(&contact.unwrap(), [self.x * self.unit, 0.0])
        });
        magenta.into_iter().zip(yellow).map(Into::into).collect()
    }

    fn pressed(&self) -> Vec<Option<Seen>> {
        self.seen(&EXACT, &self.moved())
    }

    fn estimate(
        &self,
        seen: &[Option<Seen>],
        known: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.fit().estimate(&self.rest(), seen, known)
    }

    fn relative_curvature(&self) -> f64 {
        (1.0 + self.object) / (RADIUS * self.unit)
    }
}

fn few(count: usize) -> Vec<Option<Seen>> {
    let seen = PRESS.pressed().into_iter().enumerate();
    seen.map(|(marker, seen)| seen.filter(|_| marker < count))
        .collect()
}

fn name<T>(result: Result<T, PressError>) -> &'static str {
    result.err().map_or("none", Into::into)
}

#[test]
fn noiseless_presses_are_estimated_within_a_thousandth_of_a_standard_deviation() {
    let mut presses = vec![];
    for unit in [1e-30, 1.0, 1e30] {
        presses.extend([EXACT, ROUGHLY].map(|known| Press {
            unit,
            known,
            ..PRESS
        }));
    }
    for object in [-0.9, 0.0, 5.0, 20.0] {
        presses.extend([0.01, 0.05].map(|depth| Press {
            object,
            depth,
            ..PRESS
        }));
    }
    presses.extend([1e-20, 100.0].map(|stated| Press { stated, ..PRESS }));
    // The markers extend to x = 8, so a contact at x = 15 is outside of the grid.
    presses.extend([0.0, 1e-300, 15.0].map(|x| Press { x, ..PRESS }));
    presses.push(Press {
        object: -0.99,
        depth: 0.001,
        ..PRESS
    });
    for press in presses {
        let found = press.estimate(&press.pressed(), None).unwrap();
        let off = found.most_likely_curvature - press.relative_curvature();
        let bound = 1e-3 * found.relative_curvature.std + 1e-12 * press.relative_curvature();
        assert!(off.abs() <= bound, "{off:e} > {bound:e}: {found:?}");
    }
}

#[test]
fn needles_have_no_upper_bound() {
    let needle = Press {
        object: 1e3,
        depth: 0.01,
        ..PRESS
    };
    for (press, seen) in [(needle, needle.pressed()), (PRESS, few(2))] {
        let found = press.estimate(&seen, None).unwrap();
        let interval = found.relative_curvature.interval;
        assert!(interval.holds(press.relative_curvature()) && interval.high.is_none());
    }
}

#[test]
fn pictures_without_a_press_have_named_errors() {
    let of = |press: Press| name(press.estimate(&press.pressed(), None));
    for (object, depth, stated) in [(5.0, 0.001, 1.0), (0.25, 0.05, 1e9)] {
        let press = Press {
            object,
            depth,
            stated,
            ..PRESS
        };
        assert_eq!(of(press), "no-contact");
    }
    assert_eq!(of(Press { x: 20.0, ..PRESS }), "off-markers");
    assert_eq!(of(Press { x: 40.0, ..PRESS }), "undetermined");
    let read = |seen: &[Option<Seen>]| name(PRESS.estimate(seen, None));
    assert_eq!(read(&PRESS.at_rest()), "no-contact");
    assert_eq!(read(&[PRESS.pressed()[40]; MARKERS]), "other-body");
    assert_eq!(read(&few(0)), "too-few-markers");
    let fit = ImageFit {
        shift_std: 1.0,
        ..PRESS.fit()
    };
    let found = fit.estimate(&PRESS.rest(), &few(1), None);
    assert_eq!(name(found), "too-few-markers");
}

#[test]
fn settings_out_of_range_have_named_errors() {
    for (factor, expected) in [
        (f64::NAN, "not-finite"),
        (1e60, "not-finite"),
        (0.0, "bad-setting"),
        (-1.0, "bad-setting"),
    ] {
        let mut seen = PRESS.pressed();
        seen[7].as_mut().unwrap().covariance *= factor;
        assert_eq!(name(PRESS.estimate(&seen, None)), expected);
        assert_eq!(name(PRESS.fit().at_rest(&seen)), expected);
    }
    for (value, std, expected) in [
        (0.0, 0.0, "no-indentation"),
        (f64::NAN, 0.0, "out-of-range"),
        (1.0, f64::NAN, "bad-setting"),
        (1.0, -1.0, "bad-setting"),
        (1.0, 1e100, "none"),
    ] {
        let known = Some(Measured { value, std });
        assert_eq!(name(PRESS.estimate(&PRESS.pressed(), known)), expected);
    }
    let at_rest = |fit: ImageFit| name(fit.at_rest(&PRESS.at_rest()));
    let with_stds = |common_stds| {
        at_rest(ImageFit {
            common_stds,
            ..PRESS.fit()
        })
    };
    for bad in [f64::NAN, -1.0, 1e-101, 1e101] {
        assert_eq!(with_stds(vec![bad; 5]), "bad-setting");
        for change in [
            |fit: &mut ImageFit, bad| fit.shift_std = bad,
            |fit: &mut ImageFit, bad| fit.misalignment_std = bad,
        ] {
            let mut fit = PRESS.fit();
            change(&mut fit, bad);
            assert_eq!(at_rest(fit), "bad-setting");
        }
    }
    assert_eq!(with_stds(vec![0.01; 4]), "out-of-range");
}

/// With 81 markers, the prior pulls the estimated camera parameters towards their nominal values by only about 1e-5 of
/// their deviation.
#[test]
fn camera_errors_are_estimated_on_sensors_of_any_size() {
    for unit in [1e-30, 1.0, 1e30] {
        let press = Press {
            unit,
            known: ROUGHLY,
            ..PRESS
        };
        let still = [[MarkerDisplacement::default(); 2]; MARKERS];
        let seen = press.seen(&DEPARTED, &still);
        let rest = press.fit().at_rest(&seen).unwrap();
        for number in 2..5 {
            let off = (rest.common[number] - DEPARTED[number]) / ROUGHLY[number];
            assert!(off.abs() < 1e-4, "{unit:e}: {off:e}");
        }
    }
}

#[test]
fn impossible_estimates_have_named_errors() {
    let (rest, seen) = (PRESS.rest(), PRESS.pressed());
    let good = PRESS.estimate(&seen, None).unwrap();
    let curvature = good.most_likely_curvature;
    let depth = good.indentation.value;
    for (curvature, depth, expected) in [
        (0.0, depth, "conforming"),
        (1e-9, depth, "too-wide"),
        (f64::NAN, depth, "out-of-range"),
        (-1.0, depth, "out-of-range"),
        (curvature, f64::NAN, "out-of-range"),
        (curvature, RADIUS, "too-deep"),
        (curvature, 0.0, "no-indentation"),
    ] {
        let mut estimate = good.clone();
        estimate.most_likely_curvature = curvature;
        estimate.indentation.value = depth;
        assert_eq!(name(PRESS.fit().beyond(&rest, &seen, &estimate)), expected);
        let misfits = PRESS.fit().misfits(&rest, &seen, None, &estimate);
        assert_eq!(name(misfits), expected);
    }
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        let mut aside = good.clone();
        aside.contact = [x; 2];
        let found = PRESS.fit().misfits(&rest, &seen, None, &aside);
        let mut found = found.into_iter().flatten();
        assert!(found.all(|one| (0.0..=1.0).contains(&one.p_value())));
    }
    let beyond = PRESS.fit().beyond(&rest, &seen, &good).unwrap();
    assert!(beyond.iter().flatten().all(|more| more.normal.abs() < 1e-3));
    let misfits = PRESS.fit().misfits(&rest, &seen, None, &good);
    assert_eq!(misfits.unwrap(), []);
}
