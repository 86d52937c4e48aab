//! Items in groups, in the order in which they appear.

/// Items by their keys, each key once.
pub(crate) fn by_key<K: PartialEq, T>(items: impl IntoIterator<Item = (K, T)>) -> Vec<(K, Vec<T>)> {
    let mut groups: Vec<(K, Vec<T>)> = Vec::new();
    for (key, item) in items {
        // Items of one key mostly follow each other.
        match groups.iter_mut().rev().find(|(known, _)| *known == key) {
            Some((_, items)) => items.push(item),
            None => groups.push((key, vec![item])),
        }
    }
    groups
}

/// Items without those that equal one before.
pub(crate) fn distinct<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let keys = items.into_iter().map(|item| (item, ()));
    by_key(keys).into_iter().map(|(item, _)| item).collect()
}
