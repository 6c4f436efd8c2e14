//! Which texels show the actor, at full size and at smaller ones, and which neighbours belong to one chart.

/// Sizes that a mask is kept at: each half the one before, the first one full.
pub const LEVELS: usize = 5;

/// Flag of a texel that shows the actor.
pub const ACTIVE: u8 = 1;
/// Flags of a texel whose neighbour is active too: to the right, to the left, below, above.
pub const NEIGHBOURS: [(u8, [i32; 2]); 4] = [(2, [1, 0]), (4, [-1, 0]), (8, [0, 1]), (16, [0, -1])];

/// Active texels of a texture at one size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Level {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// [`ACTIVE`] and [`NEIGHBOURS`] of each texel, row-major.
    pub flags: Vec<u8>,
}

/// Active texels of a texture at [`LEVELS`] sizes.
///
/// A texel of a smaller size is active where one of its four is, and touches a neighbour where one of its four touches
/// one of the neighbour's: charts that lie side by side stay apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Full size first.
    pub levels: Vec<Level>,
}

impl Mask {
    /// The mask of a texture `width` texels wide; `active` is row-major, its length a multiple of `width`.
    #[must_use]
    pub fn new(width: usize, active: &[bool]) -> Self {
        let height = active.len().checked_div(width).unwrap_or(0);
        let mut flags: Vec<u8> = active.iter().map(|&active| u8::from(active)).collect();
        for y in 0..height {
            for x in 0..width {
                let at = y * width + x;
                if active[at] {
                    let right = 2 * u8::from(x + 1 < width && active[at + 1]);
                    let left = 4 * u8::from(x > 0 && active[at - 1]);
                    let below = 8 * u8::from(y + 1 < height && active[at + width]);
                    let above = 16 * u8::from(y > 0 && active[at - width]);
                    flags[at] |= right | left | below | above;
                }
            }
        }
        let mut levels = vec![Level { width, height, flags }];
        while let Some(finer) = levels.last().filter(|_| levels.len() < LEVELS) {
            levels.push(finer.halved());
        }
        Self { levels }
    }

    /// Full size.
    #[must_use]
    pub fn full(&self) -> &Level {
        &self.levels[0]
    }
}

impl Level {
    fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut flags = vec![0; width * height];
        for y in 0..self.height {
            for x in 0..self.width {
                let own = self.flags[y * self.width + x];
                // Only what leads out of the four texels counts as a neighbour.
                let outward = ACTIVE | if x % 2 == 1 { 2 } else { 4 } | if y % 2 == 1 { 8 } else { 16 };
                flags[y / 2 * width + x / 2] |= own & outward;
            }
        }
        Self { width, height, flags }
    }

    /// Whether texel (`x`, `y`) is active; none is outside.
    #[must_use]
    pub fn active(&self, x: i32, y: i32) -> bool {
        let inside = (0..self.width as i32).contains(&x) && (0..self.height as i32).contains(&y);
        inside && self.flags[y as usize * self.width + x as usize] & ACTIVE != 0
    }

    /// Indices of the active neighbours of texel `at`.
    pub fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> {
        let (flags, width) = (self.flags[at], self.width as i32);
        let present = NEIGHBOURS.iter().filter(move |(flag, _)| flags & flag != 0);
        present.map(move |&(_, [dx, dy])| (at as i32 + dy * width + dx) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charts_side_by_side_stay_apart() {
        // Two charts with a gutter of one texel, which is gone at half the size.
        let active: Vec<bool> = (0..8 * 8).map(|at| at % 8 != 3).collect();
        let mask = Mask::new(8, &active);
        assert_eq!(mask.levels.len(), LEVELS);
        let half = &mask.levels[1];
        assert_eq!((half.width, half.height), (4, 4));
        assert!((0..16).all(|at| half.flags[at] & ACTIVE != 0));
        let right = |x: usize| half.flags[4 + x] & 2 != 0;
        assert_eq!([right(0), right(1), right(2), right(3)], [true, false, true, false]);
        let left = |x: usize| half.flags[4 + x] & 4 != 0;
        assert_eq!([left(0), left(1), left(2), left(3)], [false, true, false, true]);
    }

    #[test]
    fn neighbours_know_each_other() {
        let active: Vec<bool> = (0..13 * 9_u32).map(|at| at.wrapping_mul(2_654_435_761) >> 30 != 0).collect();
        for level in Mask::new(13, &active).levels {
            for at in 0..level.flags.len() {
                assert!(level.neighbours(at).all(|other| level.neighbours(other).any(|back| back == at)));
            }
        }
    }
}
