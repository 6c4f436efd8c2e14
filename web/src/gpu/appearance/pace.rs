//! How carefully the texture is rebuilt, chosen by how long it took.

/// Ways to rebuild, quick ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Setting {
    /// At half the size, moved directly.
    Half,
    /// Moved directly.
    Direct,
    /// Moved with its gradients.
    Poisson,
}

impl Setting {
    /// All of them, quick ones first.
    pub const ALL: [Self; 3] = [Self::Half, Self::Direct, Self::Poisson];

    /// The page's word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Half => "half",
            Self::Direct => "direct",
            Self::Poisson => "poisson",
        }
    }
}

/// Milliseconds from a rebuild's commands to their end, above which the setting is too high, and below which the next
/// one may do. Pictures drawn meanwhile count too, so this is an upper bound of the rebuild itself.
const SLOW: f64 = 14.0;
const QUICK: f64 = 7.0;
/// Rebuilds that must agree.
const AGREED: i32 = 8;

/// Chooses a setting.
#[derive(Clone, Debug)]
pub struct Pace {
    index: usize,
    /// The best setting that has not been too slow twice.
    best: usize,
    failures: [u8; 3],
    /// Rebuilds in a row that were quick (above zero) or slow (below).
    run: i32,
    kept: Option<Setting>,
}

impl Pace {
    /// Begins in the middle, or lowest where the device is known to be `slow`.
    pub fn new(slow: bool) -> Self {
        Self { index: usize::from(!slow), best: Setting::ALL.len() - 1, failures: [0; 3], run: 0, kept: None }
    }

    /// The present choice.
    pub fn setting(&self) -> Setting {
        self.kept.unwrap_or(Setting::ALL[self.index])
    }

    /// Keeps to one setting, or chooses again.
    pub fn keep(&mut self, setting: Option<Setting>) {
        self.kept = setting;
    }

    /// A rebuild took this long.
    pub fn note(&mut self, milliseconds: f64) {
        self.run = match milliseconds {
            slow if slow > SLOW => self.run.min(0) - 1,
            quick if quick < QUICK => self.run.max(0) + 1,
            _ => 0,
        };
        if self.run <= -AGREED && self.index > 0 {
            self.failures[self.index] += 1;
            if self.failures[self.index] > 1 {
                self.best = self.index - 1;
            }
            self.index -= 1;
            self.run = 0;
        } else if self.run >= AGREED && self.index < self.best {
            self.index += 1;
            self.run = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The settings that a device goes through whose rebuilds take `cost` of each.
    fn course(slow: bool, cost: [f64; 3]) -> Vec<Setting> {
        let mut pace = Pace::new(slow);
        let mut course = vec![pace.setting()];
        for _ in 0..200 {
            pace.note(cost[pace.index]);
            if course.last() != Some(&pace.setting()) {
                course.push(pace.setting());
            }
        }
        course
    }

    #[test]
    fn quick_devices_rise_and_slow_ones_sink() {
        use Setting::{Direct, Half, Poisson};
        assert_eq!(course(false, [1.0, 2.0, 4.0]), [Direct, Poisson]);
        assert_eq!(course(true, [40.0, 100.0, 400.0]), [Half]);
        assert_eq!(course(false, [9.0, 30.0, 90.0]), [Direct, Half]);
        // Between two settings a device does not waver for ever.
        assert_eq!(course(false, [1.0, 2.0, 30.0]), [Direct, Poisson, Direct, Poisson, Direct]);
    }

    #[test]
    fn a_kept_setting_stays() {
        let mut pace = Pace::new(true);
        pace.keep(Some(Setting::Poisson));
        (0..50).for_each(|_| pace.note(500.0));
        assert_eq!(pace.setting(), Setting::Poisson);
    }
}
