//! Values without duplicates.

/// The values, once each, in order of appearance.
pub fn distinct<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_neighbours_are_found_equal() {
        assert_eq!(distinct([2, 1, 2, 2, 3, 1]), [2, 1, 3]);
        assert!(distinct(Vec::<u32>::new()).is_empty());
    }
}
