//! Measured figures, each beside its mark.

/// What a figure should be.
#[derive(Clone, Copy)]
pub enum Mark {
    /// So much or less; and less still, if it can be had.
    AtMost(f64, Option<f64>),
    /// So much or more.
    AtLeast(f64),
    /// Nothing was promised.
    None,
}

/// All figures of a run.
#[derive(Default)]
pub struct Figures(Vec<(String, f64, &'static str, Mark)>);

impl Figures {
    /// Takes a figure down.
    pub fn add(&mut self, what: &str, value: f64, unit: &'static str, mark: Mark) {
        self.0.push((what.to_owned(), value, unit, mark));
    }

    /// Prints the table, and how many marks were missed.
    pub fn print(&self) {
        let width = self.0.iter().map(|(what, ..)| what.chars().count()).max().unwrap_or(0);
        println!("\n{:width$}  {:>10} {:8}  {:24}  outcome", "figure", "measured", "", "mark");
        let mut missed = 0;
        for (what, value, unit, mark) in &self.0 {
            let (promise, outcome) = judge(*value, *mark);
            missed += usize::from(outcome.starts_with("MISSED"));
            println!("{what:width$}  {value:>10.2} {unit:8}  {promise:24}  {outcome}");
        }
        println!("\n{} figures, {missed} marks missed", self.0.len());
    }
}

fn judge(value: f64, mark: Mark) -> (String, String) {
    match mark {
        Mark::None => (String::new(), String::new()),
        Mark::AtLeast(least) => (format!("at least {least}"), outcome(value >= least, least / value)),
        Mark::AtMost(most, stretch) => {
            let promise = stretch.map_or_else(String::new, |stretch| format!(", stretch {stretch}"));
            let reached = stretch.is_some_and(|stretch| value <= stretch);
            let outcome = if reached { "met, and the stretch".into() } else { outcome(value <= most, value / most) };
            (format!("at most {most}{promise}"), outcome)
        }
    }
}

fn outcome(met: bool, factor: f64) -> String {
    if met { "met".into() } else { format!("MISSED {factor:.2} times over") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_judged() {
        let verdict = |value, mark| judge(value, mark).1;
        assert_eq!(verdict(6.0, Mark::AtMost(6.0, Some(3.0))), "met");
        assert_eq!(verdict(3.0, Mark::AtMost(6.0, Some(3.0))), "met, and the stretch");
        assert_eq!(verdict(9.0, Mark::AtMost(6.0, None)), "MISSED 1.50 times over");
        assert_eq!(verdict(100.0, Mark::AtLeast(200.0)), "MISSED 2.00 times over");
        assert_eq!(verdict(200.0, Mark::AtLeast(200.0)), "met");
        assert!(verdict(f64::NAN, Mark::AtMost(1.0, None)).starts_with("MISSED"));
    }
}
