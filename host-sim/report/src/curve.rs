//! Curves: reduced to the visible points and cut at the axes.

/// At most two points in each of `columns` equal parts of `x`: the lowest and the highest, in
/// their order; values that are not finite are dropped. Points must come in order of x.
pub(super) fn reduce(
    points: impl Iterator<Item = (f64, f64)>,
    [left, right]: [f64; 2],
    columns: usize,
) -> Vec<(f64, f64)> {
    let points: Vec<_> = points.filter(|(_, y)| y.is_finite()).collect();
    if points.len() <= 2 * columns {
        return points;
    }
    let column = |x: f64| ((x - left) / (right - left) * columns as f64) as usize;
    let mut reduced = Vec::with_capacity(2 * columns);
    for part in points.chunk_by(|a, b| column(a.0) == column(b.0)) {
        let low = (0..part.len()).min_by(|&a, &b| part[a].1.total_cmp(&part[b].1));
        let high = (0..part.len()).max_by(|&a, &b| part[a].1.total_cmp(&part[b].1));
        let (Some(low), Some(high)) = (low, high) else {
            continue;
        };
        reduced.push(part[low.min(high)]);
        if low != high {
            reduced.push(part[low.max(high)]);
        }
    }
    reduced
}

/// The pieces of a polyline that lie between `low` and `high`, cut exactly at both.
pub(super) fn clip(points: &[(f64, f64)], [low, high]: [f64; 2]) -> Vec<Vec<(f64, f64)>> {
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut piece: Vec<(f64, f64)> = Vec::new();
    for pair in points.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        // The parts of the segment, 0 to 1, at which it enters and leaves.
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        if y0 == y1 {
            if y0 < low || y0 > high {
                (enter, leave) = (1.0, 0.0);
            }
        } else {
            let (a, b) = ((low - y0) / (y1 - y0), (high - y0) / (y1 - y0));
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        let at = |part: f64| (x0 + part * (x1 - x0), y0 + part * (y1 - y0));
        if enter <= leave {
            if piece.is_empty() {
                piece.push(at(enter));
            }
            piece.push(at(leave));
        }
        if (enter > leave || leave < 1.0) && !piece.is_empty() {
            pieces.push(std::mem::take(&mut piece));
        }
    }
    if !piece.is_empty() {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduction_keeps_every_extreme_and_few_points() {
        let noisy = |i: u32| f64::from((i * 7919) % 101) + if i == 51_234 { 900.0 } else { 0.0 };
        let points = (0..100_000).map(|i| (f64::from(i), noisy(i)));
        let reduced = reduce(points, [0.0, 100_000.0], 300);
        assert!(reduced.len() <= 600, "{}", reduced.len());
        assert!(reduced.iter().any(|p| p.1 >= 900.0));
        assert!(reduced.iter().any(|p| p.1 == 0.0));
        assert!(reduced.is_sorted_by(|a, b| a.0 < b.0));
    }

    #[test]
    fn short_curve_keeps_its_finite_points() {
        let points = [
            (0.0, 1.0),
            (1.0, f64::NAN),
            (2.0, f64::INFINITY),
            (3.0, 4.0),
        ];
        let reduced = reduce(points.into_iter(), [0.0, 3.0], 10);
        assert_eq!(reduced, [(0.0, 1.0), (3.0, 4.0)]);
    }

    #[test]
    fn curve_is_cut_where_it_leaves_the_axes() {
        let saw = [
            (0.0, 0.0),
            (1.0, 4.0),
            (2.0, 0.0),
            (3.0, -4.0),
            (4.0, -4.0),
            (5.0, 0.0),
        ];
        let pieces = clip(&saw, [-2.0, 2.0]);
        assert_eq!(
            pieces,
            [
                vec![(0.0, 0.0), (0.5, 2.0)],
                vec![(1.5, 2.0), (2.0, 0.0), (2.5, -2.0)],
                vec![(4.5, -2.0), (5.0, 0.0)],
            ]
        );
    }

    #[test]
    fn jump_across_both_ends_keeps_its_middle_and_outside_is_dropped() {
        assert_eq!(
            clip(&[(0.0, -3.0), (1.0, 3.0)], [-1.5, 1.5]),
            [vec![(0.25, -1.5), (0.75, 1.5)]]
        );
        assert!(clip(&[(0.0, 5.0), (1.0, 6.0), (2.0, 5.0)], [-1.0, 1.0]).is_empty());
    }
}
