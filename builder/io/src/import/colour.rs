//! Colours as files write them: 0 to 1, or by a common mistake 0 to 255.

use super::mesh::byte;
use super::warning::Note;

/// A component may be this much above 1 by rounding.
const ROUNDING: f32 = 1e-3;

/// What one stands for in the numbers of some colours, and what to say about it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Range {
    /// The number that means full brightness.
    pub full: f32,
    /// What is unusual.
    pub note: Option<Note>,
}

/// The range of red, green and blue components that should be between 0 and 1.
///
/// Whole numbers above 1, and any number from 2 on, are of 0 to 255 or of 0 to 65535; others are cut off at 1.
pub(super) fn range(components: impl Iterator<Item = f32>) -> Range {
    let (mut least, mut most, mut whole) = (0.0_f32, 0.0_f32, true);
    for component in components {
        (least, most) = (least.min(component), most.max(component));
        whole &= component.fract() == 0.0;
    }
    let note = |message: String| Some(Note::new("W_COLOUR_RANGE", message));
    if most <= 1.0 + ROUNDING {
        let message = || format!("colours go down to {least}: what is below 0 counts as 0");
        return Range { full: 1.0, note: if least < -ROUNDING { note(message()) } else { None } };
    }
    let full = match most {
        _ if most < 2.0 && !whole => 1.0,
        _ if most < 256.0 => 255.0,
        _ if most < 65536.0 => 65535.0,
        _ => 1.0,
    };
    let meaning =
        if full > 1.0 { format!("they are read as 0 to {full}") } else { "what is above 1 counts as 1".into() };
    Range { full, note: note(format!("colours go up to {most} instead of 1: {meaning}")) }
}

/// sRGB bytes of vertex colours (red, green, blue, opacity); those of no number are white.
pub(super) fn bytes(colours: &[[f32; 4]]) -> (Vec<[u8; 4]>, Option<Note>) {
    let given = || colours.iter().filter(|colour| !colour[0].is_nan());
    let Range { full, note } = range(given().flat_map(|colour| colour[..3].iter().copied()));
    // Opacity is 1 where it is not given, whatever the colours are.
    let opaque = given().map(|colour| colour[3]).fold(1.0, f32::max);
    let opaque = if opaque > 1.0 + ROUNDING { full } else { 1.0 };
    let written = |&[r, g, b, a]: &[f32; 4]| {
        if r.is_nan() { [255; 4] } else { [byte(r / full), byte(g / full), byte(b / full), byte(a / opaque)] }
    };
    (colours.iter().map(written).collect(), note)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_told_from_the_largest_number() {
        for (most, full, said) in [
            (1.0, 1.0, false),
            (1.0005, 1.0, false),
            (1.3, 1.0, true),
            (2.0, 255.0, true),
            (127.5, 255.0, true),
            (255.0, 255.0, true),
            (3000.0, 65535.0, true),
            (1e9, 1.0, true),
        ] {
            let found = range([0.0, most].into_iter());
            assert_eq!((found.full, found.note.is_some()), (full, said), "{most}");
        }
        assert!(range([-0.5, 0.5].into_iter()).note.is_some());
    }

    #[test]
    fn colours_become_bytes() {
        let (brown, said) = bytes(&[[120.0, 60.0, 30.0, 1.0], [f32::NAN; 4]]);
        assert_eq!((brown, said.is_some()), (vec![[120, 60, 30, 255], [255; 4]], true));
        assert_eq!(bytes(&[[1.0, 0.0, 0.0, 0.5]]), (vec![[255, 0, 0, 128]], None));
        assert_eq!(bytes(&[[200.0, 0.0, 0.0, 51.0]]).0, [[200, 0, 0, 51]]);
    }
}
