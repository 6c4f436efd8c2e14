//! Numbers with a sign as numbers without, small ones staying small.

/// 0, -1, 1, -2, 2, ... as 0, 1, 2, 3, 4, ...
#[must_use]
pub fn zigzag(value: i32) -> u32 {
    (value << 1 ^ value >> 31) as u32
}

/// The inverse of [`zigzag`].
#[must_use]
pub fn unzigzag(value: u32) -> i32 {
    (value >> 1) as i32 ^ -((value & 1) as i32)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn zigzag_is_undone(value: i32) {
            prop_assert_eq!(unzigzag(zigzag(value)), value);
        }
    }
}
