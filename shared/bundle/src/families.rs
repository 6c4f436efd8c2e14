//! The families section: which sequences do the same, and by which numbers they are asked for. Optional: JSON, which the page
//! reads with the parser that it has.

use actor::families::Family;
use actor::json::Json;
use actor::timeline::Timeline;

/// The section's bytes.
pub(super) fn encode(families: &[Family]) -> Vec<u8> {
    Family::to_json(families).into_bytes()
}

/// The sequences with the families that the section holds; the reason where they are none of these sequences.
pub(super) fn decode(bytes: &[u8], timeline: Timeline) -> Result<Timeline, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "is no text")?;
    let document = Json::document(text, Json::read).map_err(|error| error.to_string())?;
    let families = Family::of_json(&document).map_err(|error| error.to_string())?;
    timeline.with_families(families).map_err(|error| error.to_string())
}
