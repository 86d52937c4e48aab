//! Selects a few readings from a long list of readings.

/// Selects at most `most` of `count` readings, and returns their indices in ascending order. The readings are divided
/// into blocks of equal length, and one reading of each block is selected. Its position within the block differs from
/// block to block. With a fixed position, all selected readings could be of the same finger if the readings of several
/// fingers alternate.
///
/// ```
/// use palpate_statistics::evenly_spaced;
///
/// assert_eq!(evenly_spaced(5, 9).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
/// // The readings of seven fingers alternate. Of 70 readings of each finger, about ten are selected.
/// let mut counts = [0; 7];
/// evenly_spaced(490, 70).for_each(|index| counts[index % 7] += 1);
/// assert!(counts.iter().all(|count| (8..=12).contains(count)), "{counts:?}");
/// ```
pub fn evenly_spaced(count: usize, most: usize) -> impl Iterator<Item = usize> {
    // The golden ratio, as a fraction of 2^64. The fractional parts of its multiples are evenly distributed, so they
    // give the positions within the blocks.
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    let step = count.div_ceil(most.max(1)).max(1);
    (0..count.div_ceil(step)).map(move |block| {
        let share = u128::from((block as u64).wrapping_mul(GOLDEN));
        let within = (share * step as u128) >> u64::BITS;
        (block * step + within as usize).min(count - 1)
    })
}
