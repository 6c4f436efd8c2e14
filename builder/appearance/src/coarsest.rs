//! The coarsest step of colours that reaches a similarity.
//!
//! Similarity falls as steps grow, slowly and nearly in line with their logarithm. From where it starts the search goes
//! towards the wanted similarity in longer and longer moves until it lies between two steps, and then between them where a
//! line says.

use super::AppearanceError;
use super::stored::StoredQuality;

/// Steps are never finer.
pub(super) const FINEST: f64 = 0.001;
/// Nor coarser: what is left is little more than the mean.
const COARSEST: f64 = 0.25;
/// Steps are whole numbers of parts of 1, so many, so that they do not depend on how a processor takes logarithms.
const PARTS: f64 = 1e5;
/// So much more similarity than wanted is good enough.
const TOLERANCE: f64 = 0.0005;
/// What steps e times as fine gain, or a little less: 0.014 to 0.017 at a similarity of 0.98, so that first moves are long
/// enough.
const SLOPE: f64 = 0.012;
/// The longest first move, as a logarithm.
const FIRST_MOVE: f64 = 1.0;
/// Two steps that differ by a smaller part are the same.
const CLOSE: f64 = 0.002;
/// Steps tried at most; nine moves, each twice as long as the one before, lead from one end to the other from anywhere.
const ATTEMPTS: usize = 10;

/// A step of colours and what it comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stepped {
    /// 1 being the range of a channel.
    pub step: f64,
    /// What is left after storing.
    pub stored: StoredQuality,
}

/// The coarsest step that `measure` finds similar enough, to within a tolerance; where none is, the finest that was tried.
/// A step that is not, and has `most_bytes` a frame all the same, is the last one: what is similar enough has more.
pub(super) fn coarsest(
    wanted: f64,
    start: f64,
    most_bytes: f64,
    mut measure: impl FnMut(f64) -> Result<StoredQuality, AppearanceError>,
) -> Result<Stepped, AppearanceError> {
    // The coarsest that reaches it, and the finest that does not.
    let mut ends: [Option<Stepped>; 2] = [None; 2];
    let (mut step, mut length, mut attempts) = (allowed(start), 0.0_f64, 0);
    loop {
        let found = Stepped { step, stored: measure(step)? };
        let above = found.stored.ssim - wanted;
        ends[usize::from(above < 0.0)] = Some(found);
        attempts += 1;
        let logarithm = match ends {
            _ if attempts == ATTEMPTS || is_last(&found, above, most_bytes) => break Ok(ends[0].unwrap_or(found)),
            [Some(fine), Some(coarse)] if coarse.step - fine.step < CLOSE * fine.step + 1.0 / PARTS => break Ok(fine),
            [Some(fine), Some(coarse)] => between(&fine, &coarse, wanted),
            _ => {
                length = (2.0 * length).max(((above - 0.5 * TOLERANCE).abs() / SLOPE).min(FIRST_MOVE));
                step.ln() + length.copysign(above)
            }
        };
        step = allowed(logarithm.exp());
    }
}

/// The step next to `step` that may be tried.
fn allowed(step: f64) -> f64 {
    ((step * PARTS).round() / PARTS).clamp(FINEST, COARSEST)
}

/// Whether nothing is left to try after a step whose similarity is so far `above` the wanted one.
fn is_last(found: &Stepped, above: f64, most_bytes: f64) -> bool {
    match above < 0.0 {
        true => found.step <= FINEST || found.stored.bytes_per_frame >= most_bytes,
        false => found.step >= COARSEST || above <= TOLERANCE,
    }
}

/// The logarithm of a step between one that reaches `wanted` and one that does not.
fn between(fine: &Stepped, coarse: &Stepped, wanted: f64) -> f64 {
    let spare = fine.stored.ssim - wanted - 0.5 * TOLERANCE;
    let way = (spare / (fine.stored.ssim - coarse.stored.ssim)).clamp(0.1, 0.9);
    fine.step.ln() + way * (coarse.step / fine.step).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps that were tried where similarity falls from `best` and bytes as measured, with what came out.
    fn search(best: f64, wanted: f64, start: f64, most_bytes: f64) -> (Stepped, Vec<f64>) {
        let mut tried = Vec::new();
        let found = coarsest(wanted, start, most_bytes, |step| {
            tried.push(step);
            let ssim = best - 0.4 * step.powf(0.7);
            Ok(StoredQuality { ssim, bytes_per_frame: 100.0 / step, ..StoredQuality::default() })
        });
        (found.unwrap(), tried)
    }

    #[test]
    fn lands_just_above_what_is_wanted_in_a_few_attempts() {
        for start in [FINEST, 0.003, 0.012, 0.09, COARSEST] {
            for wanted in [0.85, 0.9, 0.95, 0.97, 0.98, 0.985] {
                let (found, tried) = search(0.992, wanted, start, f64::INFINITY);
                let above = found.stored.ssim - wanted;
                println!("{wanted} from {start}: {above:.5} at {:.5}, tried {}", found.step, tried.len());
                assert!((0.0..=TOLERANCE).contains(&above), "{wanted} from {start}: {found:?}, {tried:?}");
                assert!(tried.len() < ATTEMPTS && tried.iter().filter(|&&step| step == found.step).count() == 1);
            }
        }
    }

    #[test]
    fn ends_at_the_finest_and_at_the_coarsest() {
        for start in [FINEST, 0.012, COARSEST] {
            let (found, tried) = search(0.97, 0.98, start, f64::INFINITY);
            assert!(found.step == FINEST && found.stored.ssim < 0.98, "{found:?}, {tried:?}");
            // A quality holds 32 bits: from there the same step is not tried again.
            let (_, tried) = search(0.97, 0.98, f64::from(found.step as f32), f64::INFINITY);
            assert_eq!(tried, [FINEST]);
            let (found, _) = search(0.992, 0.3, start, f64::INFINITY);
            assert!(found.step == COARSEST && found.stored.ssim >= 0.3);
        }
    }

    #[test]
    fn gives_up_where_it_has_too_many_bytes_already() {
        let (found, tried) = search(0.992, 0.985, 0.012, 100.0 / 0.011);
        assert!(found.stored.ssim < 0.985 && found.step > FINEST && tried.len() == 2, "{found:?}, {tried:?}");
    }

    #[test]
    fn errors_are_handed_on() {
        let failing = coarsest(0.9, 0.01, f64::INFINITY, |_| Err(AppearanceError::NoFrames));
        assert!(matches!(failing, Err(AppearanceError::NoFrames)));
    }
}
