//! The known name that is most like a name, for messages about an unknown one.

/// Least Jaro-Winkler similarity (0 to 1) of a name that a message suggests.
const SIMILAR: f64 = 0.75;

/// The one of the `known` names that is most like `name`, without regard to capitals; `None` if none is like it.
#[must_use]
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let similarity = |other: &str| strsim::jaro_winkler(&lower, &other.to_lowercase());
    let all = known.into_iter().map(|other| (similarity(other), other));
    let nearest = all.max_by(|(a, _), (b, _)| a.total_cmp(b));
    let (_, nearest) = nearest.filter(|(similarity, _)| *similarity >= SIMILAR)?;
    Some(nearest)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn similar_name_is_found_and_a_different_one_is_not() {
        let known = ["wall", "free-air", "excite"];
        assert_eq!(nearest("exite", known), Some("excite"));
        assert_eq!(nearest("WALL", known), Some("wall"));
        assert_eq!(nearest("q", known), None);
        assert_eq!(nearest("wall", []), None);
    }
}
