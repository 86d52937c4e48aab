//! Threshold between the ground and markers in a plane of top-hats.

/// Two classes of pixels and the limit between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Classes {
    /// Pixels above this belong to markers.
    pub(crate) limit: u8,
    /// Mean of the ground.
    pub(crate) ground: f64,
    /// Standard deviation of the ground.
    pub(crate) ground_std: f64,
    /// Mean of the markers.
    pub(crate) markers: f64,
}

impl Classes {
    /// The classes with the largest variance between them (Otsu, 1979), the limit moved half way from one mean to the
    /// other. `None` if all values are alike.
    pub(crate) fn of(histogram: &[u32; 256]) -> Option<Self> {
        let count: f64 = histogram.iter().map(|&count| f64::from(count)).sum();
        let sum: f64 = weighted(histogram);
        let (mut below, mut sum_below, mut best) = (0.0, 0.0, (0.0, 0));
        for (value, &at) in histogram.iter().enumerate() {
            below += f64::from(at);
            sum_below += f64::from(at) * value as f64;
            let above = count - below;
            if below > 0.0 && above > 0.0 {
                let apart = sum_below / below - (sum - sum_below) / above;
                let between = below * above * apart * apart;
                if between > best.0 {
                    best = (between, value + 1);
                }
            }
        }
        if best.1 == 0 {
            return None;
        }
        let (low, high) = histogram.split_at(best.1);
        let total = |part: &[u32]| part.iter().map(|&count| f64::from(count)).sum::<f64>();
        let ground = weighted(low) / total(low);
        let markers = best.1 as f64 + weighted(high) / total(high);
        let spread: f64 = low
            .iter()
            .enumerate()
            .map(|(value, &count)| f64::from(count) * (value as f64 - ground).powi(2))
            .sum();
        Some(Self {
            limit: (0.5 * (ground + markers)) as u8,
            ground,
            ground_std: (spread / total(low)).sqrt(),
            markers,
        })
    }
}

fn weighted(histogram: &[u32]) -> f64 {
    histogram
        .iter()
        .enumerate()
        .map(|(value, &count)| value as f64 * f64::from(count))
        .sum()
}

/// The value below which a share of the counts lies.
pub(crate) fn quantile(histogram: &[u32; 256], share: f64) -> u8 {
    let count: u64 = histogram.iter().map(|&count| u64::from(count)).sum();
    let wanted = share * count as f64;
    let mut below = 0.0;
    for (value, &at) in (0..=u8::MAX).zip(histogram) {
        below += f64::from(at);
        if below >= wanted && at > 0 {
            return value;
        }
    }
    u8::MAX
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_heaps_are_told_apart() {
        let mut histogram = [0; 256];
        histogram[3] = 500;
        histogram[5] = 500;
        histogram[100] = 20;
        let classes = Classes::of(&histogram).unwrap();
        assert_eq!(
            (classes.ground, classes.markers, classes.limit),
            (4.0, 100.0, 52)
        );
        assert_eq!(classes.ground_std, 1.0);
        assert_eq!(
            [0.0, 0.6, 1.0].map(|share| quantile(&histogram, share)),
            [3, 5, 100]
        );
    }

    #[test]
    fn one_heap_has_no_classes() {
        let mut histogram = [0; 256];
        histogram[77] = 9;
        assert_eq!(Classes::of(&histogram), None);
        assert_eq!(Classes::of(&[0; 256]), None);
    }
}
