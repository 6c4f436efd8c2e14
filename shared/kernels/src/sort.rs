//! Sorting, once for all of the player: the standard library's sort of each further type would weigh 2 KB on the page.

/// Sorts keys that callers pack from what orders their elements, most significant first.
#[inline(never)]
pub fn sort(keys: &mut [u128]) {
    keys.sort_unstable();
}

/// Moves the `count` least keys to the front, in no order, and the others behind them.
#[inline(never)]
pub fn least_first(keys: &mut [u128], count: usize) {
    if count > 0 && count < keys.len() {
        keys.select_nth_unstable(count);
    }
}

/// Four numbers as one key.
#[must_use]
pub fn key(numbers: [u32; 4]) -> u128 {
    numbers.iter().fold(0, |key, &number| key << 32 | u128::from(number))
}

/// The numbers of a [`key`].
#[must_use]
pub fn numbers(key: u128) -> [u32; 4] {
    [96, 64, 32, 0].map(|shift| (key >> shift) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_come_first() {
        let keys: Vec<u128> = (0..1000_u128).map(|index| index * 7919 % 1009).collect();
        let mut sorted = keys.clone();
        sort(&mut sorted);
        for count in [0, 1, 400, 999, 1000, 2000] {
            let mut parted = keys.clone();
            least_first(&mut parted, count);
            sort(&mut parted[..count.min(1000)]);
            assert!(count == 0 || parted[..count.min(1000)] == sorted[..count.min(1000)]);
        }
    }

    #[test]
    fn keys_sort_as_their_numbers() {
        let all = [[0, 0, 0, 1], [0, 0, 1, 0], [0, u32::MAX, 0, 0], [1, 0, 5, 0], [1, 0, 5, u32::MAX], [2, 0, 0, 0]];
        let mut keys: Vec<u128> = all.iter().rev().map(|&numbers| key(numbers)).collect();
        sort(&mut keys);
        assert!(keys.into_iter().map(numbers).eq(all));
    }
}
