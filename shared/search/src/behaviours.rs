//! What behaviours a capture has, and which sequences show them. Everybody asks here: searches, links and the page.

use actor::timeline::Timeline;

use super::request::RequestError;

/// A behaviour by name, and for every sequence whether it shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Behaviour {
    /// A label, or the name of a sequence that is no label.
    pub name: String,
    /// By sequence.
    pub shown_by: Vec<bool>,
}

/// All behaviours: the labels, then the sequences whose name is no label. A label wins over a sequence of the same name.
#[must_use]
pub fn behaviours(timeline: &Timeline) -> Vec<Behaviour> {
    let sequences = timeline.sequences();
    let labels = sequences.iter().flat_map(|sequence| &sequence.labels);
    let names = labels.chain(sequences.iter().map(|sequence| &sequence.name));
    let mut found: Vec<Behaviour> = Vec::new();
    for name in names {
        if found.iter().any(|behaviour| behaviour.name == *name) {
            continue;
        }
        let by_label: Vec<bool> = sequences.iter().map(|sequence| sequence.labels.contains(name)).collect();
        let by_name = || sequences.iter().map(|sequence| sequence.name == *name).collect();
        let shown_by = if by_label.contains(&true) { by_label } else { by_name() };
        found.push(Behaviour { name: name.clone(), shown_by });
    }
    found
}

/// The number among `behaviours` of the one with this name.
///
/// # Errors
/// There is none; the error lists those that there are.
pub fn find_behaviour(behaviours: &[Behaviour], name: &str) -> Result<usize, RequestError> {
    behaviours.iter().position(|behaviour| behaviour.name == name).ok_or_else(|| RequestError::UnknownBehaviour {
        name: name.into(),
        known: behaviours.iter().map(|behaviour| behaviour.name.clone()).collect(),
    })
}

/// For every frame, whether it shows `behaviour`.
#[must_use]
pub fn frames_of(behaviour: &Behaviour, timeline: &Timeline) -> Vec<bool> {
    let shown = timeline.sequences().iter().zip(&behaviour.shown_by);
    shown.flat_map(|(sequence, &shown)| (0..sequence.frame_count).map(move |_| shown)).collect()
}
