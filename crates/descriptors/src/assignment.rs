//! The linear assignment problem: one-to-one matches of least total cost.
use crate::DescriptorError;

/// The one-to-one assignment of least total cost: which column each row gets.
///
/// `costs` is `rows` x `columns`, row by row, finite. With more rows than columns, the rows left over get
/// `None`. Shortest augmenting paths with potentials (Jonker & Volgenant 1987, in the rectangular form of
/// Crouse 2016); at most `min^2 max` steps.
///
/// ```
/// use mser3d_descriptors::assign;
///
/// // Both rows would like column 0; the cheaper total gives it to the second.
/// assert_eq!(assign(&[1.0, 2.0, 1.0, 4.0], 2, 2)?, [Some(1), Some(0)]);
/// # Ok::<(), mser3d_descriptors::DescriptorError>(())
/// ```
///
/// # Errors
/// [`DescriptorError::SizeMismatch`], [`DescriptorError::NotFinite`].
pub fn assign(costs: &[f64], rows: usize, columns: usize) -> Result<Vec<Option<usize>>, DescriptorError> {
    let (found, expected) = (costs.len(), rows.saturating_mul(columns));
    if found != expected {
        return Err(DescriptorError::SizeMismatch { what: "costs of the assignment", found, expected });
    }
    if let Some(at) = costs.iter().position(|c| !c.is_finite()) {
        return Err(DescriptorError::NotFinite { row: at / columns });
    }
    let mut assigned = vec![None; rows];
    if rows <= columns {
        let owners = augment(rows, columns, |row, column| costs[row * columns + column]);
        for (column, owner) in owners.into_iter().enumerate() {
            if let Some(row) = owner {
                assigned[row] = Some(column);
            }
        }
    } else {
        assigned = augment(columns, rows, |column, row| costs[row * columns + column]);
    }
    Ok(assigned)
}

/// The row that owns each column, for `rows <= columns`.
fn augment(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<Option<usize>> {
    let mut owner: Vec<Option<usize>> = vec![None; columns];
    // Dual variables: cost(r, c) - row_price[r] - column_price[c] >= 0, with equality on assigned pairs.
    let (mut row_price, mut column_price) = (vec![0.0; rows], vec![0.0; columns]);
    for start in 0..rows {
        // Dijkstra from the new row over reduced costs, to the nearest column without an owner.
        let mut distance = vec![f64::INFINITY; columns];
        let mut reached_from = vec![start; columns];
        let mut done = vec![false; columns];
        let (mut row, mut reached, mut last) = (start, 0.0, None);
        let sink = loop {
            let mut nearest: Option<usize> = None;
            for column in (0..columns).filter(|&c| !done[c]) {
                let through = reached + (cost(row, column) - row_price[row] - column_price[column]);
                if through < distance[column] {
                    distance[column] = through;
                    reached_from[column] = row;
                }
                if nearest.is_none_or(|best| distance[column] < distance[best]) {
                    nearest = Some(column);
                }
            }
            // There are at least as many columns as rows, so a free one is left.
            let Some(column) = nearest else { break last };
            done[column] = true;
            reached = distance[column];
            last = Some(column);
            match owner[column] {
                Some(next) => row = next,
                None => break last,
            }
        };
        row_price[start] += reached;
        for column in (0..columns).filter(|&c| done[c]) {
            if let Some(row) = owner[column] {
                row_price[row] += reached - distance[column];
            }
            column_price[column] -= reached - distance[column];
        }
        // Hand the columns on along the path.
        let mut next = sink;
        while let Some(column) = next {
            let row = reached_from[column];
            next = owner.iter().position(|&o| o == Some(row)).filter(|_| row != start);
            owner[column] = Some(row);
        }
    }
    owner
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(costs: &[f64], columns: usize, assigned: &[Option<usize>]) -> f64 {
        assigned.iter().enumerate().filter_map(|(r, c)| c.map(|c| costs[r * columns + c])).sum()
    }

    /// The least total over all ways to give each row of the shorter side a partner.
    fn brute_force(costs: &[f64], rows: usize, columns: usize) -> f64 {
        fn go(
            costs: &[f64],
            columns: usize,
            row: usize,
            rows: usize,
            used: &mut Vec<bool>,
            skip: usize,
        ) -> f64 {
            if row == rows {
                return 0.0;
            }
            let mut best = f64::INFINITY;
            if skip > 0 {
                best = go(costs, columns, row + 1, rows, used, skip - 1);
            }
            for c in 0..columns {
                if !used[c] {
                    used[c] = true;
                    best = best.min(costs[row * columns + c] + go(costs, columns, row + 1, rows, used, skip));
                    used[c] = false;
                }
            }
            best
        }
        go(costs, columns, 0, rows, &mut vec![false; columns], rows.saturating_sub(columns))
    }

    #[test]
    fn totals_equal_those_of_brute_force_and_partners_are_distinct() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 60) as f64 - 7.0 // few distinct values, negative ones too: ties matter
        };
        for (rows, columns) in [(1, 1), (2, 5), (5, 2), (5, 5), (6, 4), (4, 6)] {
            for _ in 0..50 {
                let costs: Vec<f64> = (0..rows * columns).map(|_| random()).collect();
                let assigned = assign(&costs, rows, columns).unwrap();
                let mut partners: Vec<usize> = assigned.iter().flatten().copied().collect();
                assert_eq!(partners.len(), rows.min(columns));
                partners.sort_unstable();
                partners.dedup();
                assert_eq!(partners.len(), rows.min(columns));
                assert_eq!(total(&costs, columns, &assigned), brute_force(&costs, rows, columns));
            }
        }
    }

    #[test]
    fn nothing_to_assign_is_no_error() {
        assert_eq!(assign(&[], 0, 3).unwrap(), []);
        assert_eq!(assign(&[], 2, 0).unwrap(), [None, None]);
    }

    #[test]
    fn costs_must_fit_and_be_finite() {
        assert!(matches!(assign(&[1.0], 1, 2), Err(DescriptorError::SizeMismatch { .. })));
        let error = assign(&[1.0, 1.0, f64::NAN, 1.0], 2, 2).unwrap_err();
        assert_eq!(error, DescriptorError::NotFinite { row: 1 });
    }
}
