//! What a file's unit is: told from how tall the skeleton would be.

use driving::Clip;

use crate::note::Note;

/// What the file itself says of its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hint {
    /// Nothing.
    None,
    /// Metres.
    Metres,
    /// An ASF file's `length`, of which an inch over it is a unit.
    Asf(f64),
}

/// Units that files have: metres each, and their names.
const UNITS: [(f64, &str); 6] = [
    (1.0, "metres"),
    (0.1, "decimetres"),
    (0.01, "centimetres"),
    (0.001, "millimetres"),
    (0.0254, "inches"),
    (0.0254 / 0.45, "inches over 0.45"),
];
/// A skeleton without its skin is about as tall as this, in metres, and no taller than that.
const USUAL: f64 = 1.6;
const PLAUSIBLE: std::ops::Range<f64> = 0.9..2.4;

/// `clip` in metres; a note where the unit was told from its height.
pub(crate) fn in_metres(clip: Clip, said: Option<f32>, hint: Hint, notes: &mut Vec<Note>) -> Clip {
    if let Some(unit) = said {
        return clip.scaled(unit);
    }
    let height = f64::from(clip.height());
    let hinted = match hint {
        Hint::None => None,
        Hint::Metres => Some(1.0),
        Hint::Asf(length) => Some(0.0254 / length),
    };
    if let Some(unit) = hinted.filter(|unit| PLAUSIBLE.contains(&(unit * height))) {
        return clip.scaled(unit as f32);
    }
    // As many times too tall, or too small.
    let off = |unit: f64| {
        let times = unit * height.max(1e-9) / USUAL;
        times.max(1.0 / times)
    };
    let (unit, name) = UNITS.into_iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0))).unwrap_or((1.0, "metres"));
    notes.push(Note::Unit { name, tall: (unit * height) as f32 });
    clip.scaled(unit as f32)
}
