//! How much of an edit there is in a frame (Tejera et al. (2013), III-C).

use actor::timeline::Timeline;

use crate::document::Edit;

/// Seconds to both sides that an edit reaches where its window is not given.
const DEFAULT_SECONDS: f32 = 0.25;
/// Seconds over which a foot that is about to stand, or has stood, is held less and less.
const FADE: f32 = 0.2;

/// The window of an edit: frames before and after its own at which it has faded to nothing.
#[must_use]
pub fn window(edit: &Edit, timeline: &Timeline) -> [i64; 2] {
    let default = (DEFAULT_SECONDS * timeline.fps()).ceil().max(1.0) as i64;
    let frame = i64::from(edit.frame);
    let [first, last] = edit.window.unwrap_or([frame - default, frame + default]);
    [frame.saturating_sub(first), last.saturating_sub(frame)]
}

/// The share of an edit of frame `key` in `frame`, both counted over the whole capture: 1 at the key, `1 - (3 u^2 - 2 u^3)` on
/// the way to the end of the window, 0 from there and in other sequences. Cyclic sequences are gone round.
#[must_use]
pub fn share(timeline: &Timeline, key: u32, window: [i64; 2], frame: u32) -> f32 {
    let Some(sequence) = timeline.sequence_of(key).filter(|sequence| sequence.contains(frame)) else { return 0.0 };
    let steps = i64::from(frame) - i64::from(key);
    let count = i64::from(sequence.frame_count);
    let rounds: &[i64] = if sequence.cyclic { &[-count, 0, count] } else { &[0] };
    rounds.iter().map(|round| fade(steps + round, window)).fold(0.0, f32::max)
}

fn fade(steps: i64, [before, after]: [i64; 2]) -> f32 {
    if steps == 0 {
        return 1.0;
    }
    let reach = if steps < 0 { before } else { after };
    if steps.abs() >= reach {
        return 0.0;
    }
    let u = steps.abs() as f32 / reach as f32;
    1.0 - u * u * (3.0 - 2.0 * u)
}

/// How firmly a foot is held in `frame`, of which `stands` says in which frames it stands: 1 where it stands, less and less in
/// the frames beside.
#[must_use]
pub fn firmness(timeline: &Timeline, frame: u32, stands: impl Fn(u32) -> bool) -> f32 {
    let fade = (FADE * timeline.fps()).ceil().clamp(1.0, 1000.0) as i64;
    let held = |steps: i64| {
        let other = timeline.offset(frame, steps)?;
        let u = steps.abs() as f32 / fade as f32;
        stands(other).then_some(1.0 - u * u * (3.0 - 2.0 * u))
    };
    (1 - fade..fade).filter_map(held).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use actor::timeline::Sequence;

    use super::*;

    #[test]
    fn edits_fade_within_their_window_and_go_round() {
        let sequence = |name: &str, first_frame, frame_count, cyclic| Sequence {
            name: name.into(),
            labels: vec![],
            first_frame,
            frame_count,
            cyclic,
        };
        let timeline = Timeline::new(20.0, vec![sequence("a", 0, 20, false), sequence("b", 20, 10, true)]).unwrap();
        let at = |key, frame| share(&timeline, key, [4, 8], frame);
        assert_eq!((at(10, 10), at(10, 6), at(10, 18), at(10, 25)), (1.0, 0.0, 0.0, 0.0));
        assert_eq!((at(10, 8), at(10, 14)), (0.5, 0.5));
        assert!(at(10, 9) > at(10, 8) && at(10, 11) > at(10, 12));
        assert_eq!((at(21, 29), at(29, 23)), (0.5, 0.5));

        let firm = |frame| firmness(&timeline, frame, |frame| frame == 5);
        assert!(firm(5) == 1.0 && firm(4) < 1.0 && firm(3) < firm(4) && firm(11) == 0.0 && firm(0) == 0.0);
    }
}
