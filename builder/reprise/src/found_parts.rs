//! The parts of the body of a capture that is packed: as they were painted, or found, so that the page can show them.

use actor::capture::Capture;
use bundle::FoundParts;
use job::{Job, Stopped};
use parts::Parts;
use serde::Serialize;

/// What came of the parts of the body.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartsSummary {
    /// Their names, the torso's first; none where the body is one part.
    pub names: Vec<String>,
    /// Whether they were painted, not found.
    pub painted: bool,
}

/// The parts of `capture`, of which the number of each vertex's part may have been `painted`; nothing to store where they were, or where
/// the body is one part.
pub(crate) fn found_parts(
    capture: &Capture,
    painted: Option<&[u8]>,
    job: &Job,
) -> Result<(Option<FoundParts>, PartsSummary), Stopped> {
    job.begin("parts of the body")?;
    if let Some(numbers) = painted {
        let mut numbers = numbers.to_vec();
        numbers.sort_unstable();
        numbers.dedup();
        let names = numbers.iter().map(|number| format!("part {number}")).collect();
        return Ok((None, PartsSummary { names, painted: true }));
    }
    let parts = Parts::find(&capture.topology, &capture.poses);
    // One part is nothing to show; more than there are numbers for are no body's.
    let of_vertex: Option<Vec<u8>> = parts.of_vertices().into_iter().map(|part| u8::try_from(part).ok()).collect();
    let found = of_vertex.filter(|_| !parts.limbs.is_empty());
    let found = found.map(|of_vertex| FoundParts { names: parts.names(&capture.poses), of_vertex });
    let names = found.as_ref().map_or(Vec::new(), |found| found.names.clone());
    Ok((found, PartsSummary { names, painted: false }))
}
