//! A Gaussian blur of rows as they come.

use super::row::Row;

/// The last rows, blurred along themselves, and the weights of neighbours.
pub(super) struct Blur {
    /// Weights of the pixel itself and of its neighbours outward, to 3.5 standard deviations; both sides together sum
    /// to 1.
    weights: Vec<f32>,
    rows: Vec<Row>,
    /// How many rows were taken in.
    taken: usize,
    size: usize,
    source: Row,
}

impl Blur {
    /// Blur with a standard deviation of `std_px`; `None` where that is 0.
    pub(super) fn new(std_px: f64, size: usize) -> Option<Self> {
        if std_px <= 0.0 {
            return None;
        }
        let reach = (3.5 * std_px).ceil() as usize;
        let bell = |step: usize| libm::exp(-0.5 * (step as f64 / std_px).powi(2));
        let total: f64 = bell(0) + 2.0 * (1..=reach).map(bell).sum::<f64>();
        Some(Self {
            weights: (0..=reach)
                .map(|step| (bell(step) / total) as f32)
                .collect(),
            rows: vec![Row::new(size); 2 * reach + 1],
            taken: 0,
            size,
            source: Row::new(size),
        })
    }

    /// A row of the blurred frame: the rows are asked for from the first to the last, and painted as they are needed.
    /// Beyond its edges the frame goes on as it ends.
    pub(super) fn blurred(
        &mut self,
        number: usize,
        row: &mut Row,
        mut paint: impl FnMut(usize, &mut Row),
    ) {
        let reach = self.weights.len() - 1;
        let last = self.size - 1;
        let count = self.rows.len();
        while self.taken <= (number + reach).min(last) {
            paint(self.taken, &mut self.source);
            self.source
                .blur_into(&self.weights, &mut self.rows[self.taken % count]);
            self.taken += 1;
        }
        let at = |number: usize| &self.rows[number % count];
        row.set(at(number), self.weights[0]);
        for (step, &weight) in self.weights.iter().enumerate().skip(1) {
            row.add(at(number.saturating_sub(step)), weight);
            row.add(at((number + step).min(last)), weight);
        }
    }
}
