//! The cheapest way through a matrix of costs on which time goes on for both sides (thesis section 5.5.1).
//!
//! ```text
//!      target ->        steps: one on in both, or in one of them, at most three times in a row;
//!   s  x x . . . .      an actor is at most four times as fast as the other
//!   o  . . x . . .
//!   u  . . . K x .      K: a key, through which the way must go
//!   r  . . . . . x
//! ```
//!
//! A step in both counts twice: then all ways are equally long, and what is the same everywhere decides nothing.

use learn::dense::Matrix;

/// Steps in one of both in a row, at most.
const STRAIGHT: usize = 3;
/// What a step was: in both, then the first, second and third in a row in the source, and in the target.
const STATES: usize = 1 + 2 * STRAIGHT;

/// The cheapest way from the first entry of `costs` to the last, through all `keys` (row, column); `None` where there is none.
#[must_use]
pub fn path(costs: &Matrix, keys: &[(usize, usize)]) -> Option<Vec<(usize, usize)>> {
    let (rows, columns) = (costs.rows(), costs.columns());
    if rows == 0 || columns == 0 {
        return None;
    }
    let open = |i: usize, j: usize| !keys.iter().any(|&(a, b)| (i < a && j > b) || (i > a && j < b));
    // A step in both must not slip past a key.
    let slips = |i: usize, j: usize| keys.iter().any(|&(a, b)| (i, j) == (a, b + 1) || (i, j) == (a + 1, b));
    let at = |i: usize, j: usize| (i * columns + j) * STATES;
    let mut best = vec![f64::INFINITY; rows * columns * STATES];
    let mut before = vec![0_u8; best.len()];
    best[0] = costs[(0, 0)];
    for i in 0..rows {
        for j in 0..columns {
            if (i, j) == (0, 0) || !open(i, j) {
                continue;
            }
            for state in 0..STATES {
                let Some((k, l)) = previous(i, j, state).filter(|_| state > 0 || !slips(i, j)) else { continue };
                let from = at(k, l);
                let weight = if state == 0 { 2.0 } else { 1.0 };
                for last in predecessors(state) {
                    let cost = best[from + last] + weight * costs[(i, j)];
                    if cost < best[at(i, j) + state] {
                        best[at(i, j) + state] = cost;
                        before[at(i, j) + state] = last as u8;
                    }
                }
            }
        }
    }
    let end = at(rows - 1, columns - 1);
    let mut state = (0..STATES).min_by(|&a, &b| best[end + a].total_cmp(&best[end + b]))?;
    if best[end + state].is_infinite() {
        return None;
    }
    let mut way = vec![(rows - 1, columns - 1)];
    while let Some(&(i, j)) = way.last()
        && (i, j) != (0, 0)
    {
        let last = before[at(i, j) + state] as usize;
        way.push(previous(i, j, state)?);
        state = last;
    }
    way.reverse();
    Some(way)
}

/// Where a step came from.
fn previous(i: usize, j: usize, state: usize) -> Option<(usize, usize)> {
    match state {
        0 => Some((i.checked_sub(1)?, j.checked_sub(1)?)),
        state if state <= STRAIGHT => Some((i.checked_sub(1)?, j)),
        _ => Some((i, j.checked_sub(1)?)),
    }
}

/// What the step before may have been.
fn predecessors(state: usize) -> std::ops::Range<usize> {
    match state {
        0 => 0..STATES,
        // The first in a row follows a step in both.
        1 => 0..1,
        state if state == STRAIGHT + 1 => 0..1,
        state => state - 1..state,
    }
}

/// For each column of a way the mean of its rows, smoothed over `width` columns; its ends stay.
pub fn rows_of_columns(way: &[(usize, usize)], width: usize) -> Vec<f64> {
    let first = way.first().map_or(0, |cell| cell.1);
    let last = way.last().map_or(0, |cell| cell.1);
    let mean = |column: usize| {
        let rows: Vec<f64> = way.iter().filter(|cell| cell.1 == column).map(|cell| cell.0 as f64).collect();
        rows.iter().sum::<f64>() / rows.len().max(1) as f64
    };
    let mut plain: Vec<f64> = (first..=last).map(mean).collect();
    // A run at an end begins with the end itself.
    let (Some(&(begin, _)), Some(&(end, _))) = (way.first(), way.last()) else { return plain };
    let count = plain.len();
    (plain[0], plain[count - 1]) = (begin as f64, end as f64);
    let smooth = |k: usize| {
        let reach = (width / 2).min(k).min(count - 1 - k);
        plain[k - reach..=k + reach].iter().sum::<f64>() / (2 * reach + 1) as f64
    };
    (0..count).map(smooth).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    /// All ways, one by one.
    fn plain(costs: &Matrix, keys: &[(usize, usize)]) -> Option<f64> {
        fn on(
            costs: &Matrix,
            (i, j): (usize, usize),
            straight: (usize, usize),
            sum: f64,
            left: &[(usize, usize)],
            best: &mut Option<f64>,
        ) {
            let left = if left.first() == Some(&(i, j)) { &left[1..] } else { left };
            let end = (costs.rows() - 1, costs.columns() - 1);
            if left.iter().any(|&(a, b)| a < i || b < j) {
                return;
            }
            if (i, j) == end {
                *best = Some(best.map_or(sum, |best| best.min(sum)));
                return;
            }
            if i < end.0 && j < end.1 {
                on(costs, (i + 1, j + 1), (0, 0), sum + 2.0 * costs[(i + 1, j + 1)], left, best);
            }
            // At the start both counts are 0: any step may be the first.
            if i < end.0 && straight.1 == 0 && straight.0 < STRAIGHT {
                on(costs, (i + 1, j), (straight.0 + 1, 0), sum + costs[(i + 1, j)], left, best);
            }
            if j < end.1 && straight.0 == 0 && straight.1 < STRAIGHT {
                on(costs, (i, j + 1), (0, straight.1 + 1), sum + costs[(i, j + 1)], left, best);
            }
        }
        let mut best = None;
        on(costs, (0, 0), (0, 0), costs[(0, 0)], keys, &mut best);
        best
    }

    #[test]
    fn the_way_is_the_cheapest_of_all() {
        for case in 0..40_u64 {
            let (rows, columns) = (3 + case as usize % 4, 3 + case as usize / 7 % 4);
            let costs = Matrix::from_fn(rows, columns, |i, j| f64::from(signed(case, (i * columns + j) as u64)) + 0.3);
            let keys = if case % 3 == 0 { vec![] } else { vec![(rows / 2, columns / 2)] };
            let found = path(&costs, &keys).map(|way| {
                assert!(keys.iter().all(|key| way.contains(key)), "the way goes through its keys");
                way.windows(2).fold(costs[(0, 0)], |sum, step| {
                    let both = step[1].0 > step[0].0 && step[1].1 > step[0].1;
                    sum + if both { 2.0 } else { 1.0 } * costs[step[1]]
                })
            });
            match (found, plain(&costs, &keys)) {
                (Some(found), Some(plain)) => assert!((found - plain).abs() < 1e-12, "case {case}: {found} {plain}"),
                (found, plain) => assert_eq!(found.is_some(), plain.is_some(), "case {case}"),
            }
        }
    }

    #[test]
    fn what_is_too_fast_has_no_way() {
        assert!(path(&Matrix::zeros(30, 3), &[]).is_none());
        assert!(path(&Matrix::zeros(9, 3), &[]).is_some());
        assert!(path(&Matrix::zeros(9, 3), &[(8, 0)]).is_none());
        assert_eq!(path(&Matrix::zeros(1, 1), &[]), Some(vec![(0, 0)]));
    }

    #[test]
    fn runs_are_averaged_and_ends_stay() {
        let way = [(0, 0), (1, 0), (2, 1), (3, 2), (3, 3), (4, 4)];
        assert_eq!(rows_of_columns(&way, 1), [0.0, 2.0, 3.0, 3.0, 4.0]);
        let smooth = rows_of_columns(&way, 3);
        assert!((smooth[1] - 5.0 / 3.0).abs() < 1e-12 && smooth[4] == 4.0);
    }
}
