//! A value for each finger.

use std::collections::BTreeMap;

/// A value per finger, in the order of first appearance; quick where contacts of one finger follow
/// each other.
#[derive(Debug, Default)]
pub(crate) struct ByFinger<T> {
    places: BTreeMap<usize, usize>,
    values: Vec<T>,
    last: Option<(usize, usize)>,
}

impl<T: Default> ByFinger<T> {
    /// The value of a finger, which is the default at first.
    #[inline]
    pub(crate) fn of(&mut self, finger: usize) -> &mut T {
        let place = match self.last {
            Some((last, place)) if last == finger => place,
            _ => {
                let next = self.values.len();
                let place = *self.places.entry(finger).or_insert(next);
                if place == next {
                    self.values.push(T::default());
                }
                self.last = Some((finger, place));
                place
            }
        };
        &mut self.values[place]
    }

    /// The values, in the order of their fingers' first contact.
    pub(crate) fn iter(&self) -> std::slice::Iter<'_, T> {
        self.values.iter()
    }
}
