//! The best of several values. A ground plane changes the scale of scene space, and so the last
//! bits of every distance; it must not change which of two equal places is chosen.

/// Values within this share of the largest are equal to it. One of 576 rays that meets another
/// surface changes a value by a fifth of it.
const EQUAL_SHARE: f64 = 0.01;

/// Returns the index of the first of the largest values; `None` without values.
pub(super) fn first_largest(values: &[f64]) -> Option<usize> {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    values.iter().position(|v| *v >= largest - EQUAL_SHARE * largest.abs())
}

/// Returns the indices of up to `count` values, the largest first.
pub(super) fn largest(values: &[f64], count: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..values.len()).collect();
    let next = |_| {
        let values: Vec<f64> = left.iter().map(|&i| values[i]).collect();
        first_largest(&values).map(|first| left.remove(first))
    };
    (0..count).map_while(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_keep_their_order_whatever_their_last_bits() {
        let values = [1.0, 3.0 - 1e-9, 2.0, 3.0, 3.0 + 1e-9];
        assert_eq!(first_largest(&values), Some(1));
        assert_eq!(largest(&values, 4), [1, 3, 4, 2]);
        assert_eq!((first_largest(&[]), largest(&[1.0], 3)), (None, vec![0]));
    }
}
