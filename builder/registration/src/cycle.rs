//! The cheapest labels around a cycle, exactly: dynamic programming along it, once for each label that it may begin with.

/// What pairs of labels cost, of places around a cycle that each have the same number of labels.
#[derive(Clone, Debug)]
pub struct Cycle {
    labels: usize,
    /// By place, its label, and that of the place after it.
    costs: Vec<f32>,
}

impl Cycle {
    /// Of `places` with `labels` each: `cost` is asked for a place, its label and that of the next; the last one's next is the first.
    #[must_use]
    pub fn new(places: usize, labels: usize, mut cost: impl FnMut(usize, usize, usize) -> f32) -> Self {
        let mut costs = Vec::with_capacity(places * labels * labels);
        for place in 0..places {
            for own in 0..labels {
                costs.extend((0..labels).map(|next| cost(place, own, next)));
            }
        }
        Self { labels, costs }
    }

    /// The labels whose costs have the least sum; of several the first, by the label of the first place. Empty where there is no place.
    #[must_use]
    pub fn cheapest(&self) -> Vec<usize> {
        let begun = (0..self.labels).map(|first| self.from(first));
        let least = begun.reduce(|best, other| if other.0 < best.0 { other } else { best });
        least.map_or(Vec::new(), |(_, labels)| labels)
    }

    /// The cheapest labels of which the first is `first`, and what they cost.
    fn from(&self, first: usize) -> (f64, Vec<usize>) {
        let labels = self.labels;
        let mut sums = vec![f64::INFINITY; labels];
        sums[first] = 0.0;
        let mut ways: Vec<Vec<usize>> = Vec::new();
        for costs in self.costs.chunks_exact(labels * labels) {
            let (mut next, mut way) = (vec![f64::INFINITY; labels], vec![0; labels]);
            for (own, costs) in costs.chunks_exact(labels).enumerate().filter(|(own, _)| sums[*own].is_finite()) {
                for (label, &cost) in costs.iter().enumerate() {
                    let sum = sums[own] + f64::from(cost);
                    if sum < next[label] {
                        (next[label], way[label]) = (sum, own);
                    }
                }
            }
            sums = next;
            ways.push(way);
        }
        let mut at = first;
        let back = |way: &Vec<usize>| {
            at = way[at];
            at
        };
        let mut found: Vec<usize> = ways.iter().rev().map(back).collect();
        found.reverse();
        (sums[first], found)
    }
}

#[cfg(test)]
mod tests {
    use kernels::random::signed;

    use super::*;

    /// All labels of all places, one after the other.
    fn plain(cycle: &Cycle, places: usize) -> f64 {
        let of = |mut code: usize| -> Vec<usize> {
            let digit = |_| {
                let label = code % cycle.labels;
                code /= cycle.labels;
                label
            };
            (0..places).map(digit).collect()
        };
        (0..cycle.labels.pow(places as u32)).map(|code| sum(cycle, &of(code))).fold(f64::INFINITY, f64::min)
    }

    fn sum(cycle: &Cycle, labels: &[usize]) -> f64 {
        let cost = |place: usize| {
            let [own, next] = [labels[place], labels[(place + 1) % labels.len()]];
            f64::from(cycle.costs[(place * cycle.labels + own) * cycle.labels + next])
        };
        (0..labels.len()).map(cost).sum()
    }

    #[test]
    fn no_labels_are_cheaper_than_those_that_are_found() {
        let mut drawn = 0;
        for (places, labels) in [(1, 1), (1, 5), (2, 4), (3, 4), (5, 3), (6, 4), (7, 2)] {
            for _ in 0..20 {
                let cycle = Cycle::new(places, labels, |_, _, _| {
                    drawn += 1;
                    signed(7, drawn)
                });
                let found = cycle.cheapest();
                assert_eq!(found.len(), places);
                assert!((sum(&cycle, &found) - plain(&cycle, places)).abs() < 1e-9, "{places} of {labels}");
            }
        }
    }

    #[test]
    fn what_costs_the_same_is_found_by_the_least_first_label() {
        assert_eq!(Cycle::new(4, 3, |_, _, _| 1.0).cheapest(), [0; 4]);
        assert!(Cycle::new(0, 3, |_, _, _| 1.0).cheapest().is_empty());
        assert!(Cycle::new(3, 0, |_, _, _| 1.0).cheapest().is_empty());
    }
}
