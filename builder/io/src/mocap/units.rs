//! What a file's unit is: told from how tall the skeleton would be.

use std::path::Path;

use drive::Clip;

use crate::import::Warning;

/// What the file itself says of its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hint {
    /// Nothing.
    None,
    /// Metres.
    #[cfg(feature = "gltf")]
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

/// `clip` in metres, and a sentence where the unit was told from its height.
pub(super) fn in_metres(clip: Clip, path: &Path, said: Option<f32>, hint: Hint, warnings: &mut Vec<Warning>) -> Clip {
    if let Some(unit) = said {
        return clip.scaled(unit);
    }
    let height = f64::from(clip.height());
    let hinted = match hint {
        Hint::None => None,
        #[cfg(feature = "gltf")]
        Hint::Metres => Some(1.0),
        Hint::Asf(length) => Some(0.0254 / length),
    };
    if let Some(unit) = hinted.filter(|unit| PLAUSIBLE.contains(&(unit * height))) {
        return clip.scaled(unit as f32);
    }
    let off = |unit: f64| (unit * height.max(1e-9) / USUAL).ln().abs();
    let (unit, name) = UNITS.into_iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0))).unwrap_or((1.0, "metres"));
    let message = format!(
        "{}: lengths are taken for {name}, for the skeleton is then {:.2} m tall (--clip-unit)",
        path.display(),
        unit * height
    );
    warnings.push(Warning::new("W_MOCAP_UNIT", message));
    clip.scaled(unit as f32)
}
