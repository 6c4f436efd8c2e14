//! Which frames of two captures belong together, by the names of their sequences: for `transfer.json`, which the page of key poses shows.

use actor::timeline::{Sequence, Timeline};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use transfer::{Costs, FrameMap};

/// What was found between the first and the last key of a stretch; frames are counted within their sequences, from 0.
#[derive(Clone, Debug, Serialize)]
pub struct MappedFrames {
    /// Sequence of the source.
    pub from: String,
    /// Sequence of the target.
    pub to: String,
    /// The stretch's name, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<String>,
    /// First frame of the source.
    pub from_first: u32,
    /// Last frame of the source.
    pub from_last: u32,
    /// First frame of the target.
    pub to_first: u32,
    /// Last frame of the target.
    pub to_last: u32,
    /// For each frame of the target from the first to the last the frame of the source, to a hundredth.
    pub path: Vec<f64>,
    /// How improbable it is that frames belong together.
    pub costs: CostPicture,
}

/// Costs as bytes ([`Costs`]).
#[derive(Clone, Debug, Serialize)]
pub struct CostPicture {
    /// Rows: frames of the source from the first to the last, 200 at most.
    pub rows: usize,
    /// Columns: frames of the target, 200 at most.
    pub columns: usize,
    /// A byte each, row by row, in base64: 0 for what is most probable.
    pub values: String,
}

/// Maps by the names of sequences; `stretch` tells the name of the stretch of a number.
pub fn named_maps(
    maps: &[FrameMap],
    source: &Timeline,
    target: &Timeline,
    stretch: impl Fn(u32) -> Option<String>,
) -> Vec<MappedFrames> {
    let named = |map: &FrameMap| {
        let (from, to) = (source.sequence_of(map.source[0])?, target.sequence_of(map.target[0])?);
        Some(one(map, from, to, stretch(map.stretch)))
    };
    maps.iter().filter_map(named).collect()
}

fn one(map: &FrameMap, from: &Sequence, to: &Sequence, stretch: Option<String>) -> MappedFrames {
    let Costs { rows, columns, values } = &map.costs;
    let hundredths = |frame: &f64| ((frame - f64::from(from.first_frame)) * 100.0).round() / 100.0;
    MappedFrames {
        from: from.name.clone(),
        to: to.name.clone(),
        stretch,
        from_first: map.source[0] - from.first_frame,
        from_last: map.source[1] - from.first_frame,
        to_first: map.target[0] - to.first_frame,
        to_last: map.target[1] - to.first_frame,
        path: map.path.iter().map(hundredths).collect(),
        costs: CostPicture { rows: *rows, columns: *columns, values: STANDARD.encode(values) },
    }
}
