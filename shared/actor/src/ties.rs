//! Ties: components of the surface that stay where they are on another one, as an eyebrow does on a head.
//!
//! Not in the papers. An in-between is found for each connected component by itself, about a centre that moves on a straight
//! line; so parts that belong together drift apart where the body turns. The builder finds what stays together in the
//! recordings (`builder/pipeline/src/ties.rs`), and blends keep it so.

use kernels::topology::Topology;

/// Vertices of a tie's ends at most.
pub const MOST_TIED: usize = 32;

/// One component that follows another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tie {
    /// Where it touches: vertices of the component that follows, in ascending order.
    pub contact: Vec<u32>,
    /// What it follows: vertices of another component beside them, in ascending order.
    pub patch: Vec<u32>,
}

/// What follows what. A component follows at most one other, and what it follows comes before it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ties(Vec<Tie>);

impl Ties {
    /// Ties over `topology`. `None` where an end has no vertex, too many, or vertices of several components; where a
    /// component follows two others, itself, or one that follows something only later.
    #[must_use]
    pub fn new(ties: Vec<Tie>, topology: &Topology) -> Option<Self> {
        let component = topology.component_of_vertex();
        let of = |end: &[u32]| {
            let first = *component.get(*end.first()? as usize)?;
            let holds = end.len() <= MOST_TIED && end.is_sorted_by(|a, b| a < b);
            let one = end.iter().all(|&vertex| component.get(vertex as usize) == Some(&first));
            (holds && one).then_some(first as usize)
        };
        let (mut follows, mut leads) =
            (vec![false; topology.component_count()], vec![false; topology.component_count()]);
        for tie in &ties {
            let (from, to) = (of(&tie.contact)?, of(&tie.patch)?);
            // What leads something already is where it will be.
            if from == to || follows[from] || leads[from] {
                return None;
            }
            (follows[from], leads[to]) = (true, true);
        }
        Some(Self(ties))
    }

    /// The ties, what is followed before what follows it.
    #[must_use]
    pub fn all(&self) -> &[Tie] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tie(contact: &[u32], patch: &[u32]) -> Tie {
        Tie { contact: contact.to_vec(), patch: patch.to_vec() }
    }

    #[test]
    fn ties_lead_down_from_what_follows_nothing() {
        let triangles = (0..4).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
        let topology = Topology::new(12, triangles, vec![1.0; 12]).unwrap();
        let holds = |ties: &[Tie]| Ties::new(ties.to_vec(), &topology).is_some();
        assert!(holds(&[]));
        assert!(holds(&[tie(&[3, 4], &[0, 2]), tie(&[6], &[3]), tie(&[9, 11], &[0])]));
        // Itself, two others, in a circle, too late.
        assert!(!holds(&[tie(&[3], &[4])]));
        assert!(!holds(&[tie(&[3], &[0]), tie(&[3], &[6])]));
        assert!(!holds(&[tie(&[3], &[6]), tie(&[6], &[3])]));
        assert!(!holds(&[tie(&[6], &[3]), tie(&[3], &[0])]));
        // Ends that are none.
        assert!(!holds(&[tie(&[], &[0])]));
        assert!(!holds(&[tie(&[3], &[0, 6])]));
        assert!(!holds(&[tie(&[4, 3], &[0])]));
        assert!(!holds(&[tie(&[3], &[12])]));
    }
}
