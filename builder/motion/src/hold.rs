//! Feet of varied motion stand as the recorded ones do: at one place from their landing to their lifting.

use actor::feet::{Feet, FootVertex, SHARE_STEP};
use glam::Vec3;

use crate::smooth::ramp;

/// After it has lifted, a foot is its own again over so many seconds.
const LET_GO: f32 = 0.15;

/// A vertex of a foot, and where it is in a pose.
pub type Sole = (usize, FootVertex);

/// How far feet are put aside, frame by frame.
#[derive(Clone, Debug)]
pub struct Held {
    /// For each foot and frame: by how much it is moved, how far its sole is shaped as recorded, and how far the variation carries it off.
    feet: Vec<Vec<(Vec3, f32, Vec3)>>,
}

impl Held {
    /// How feet are to be moved in varied frames that stand for those from `first` on; `carried` says, frame by frame, how far the variation
    /// carries each foot off. What stands at an end stands as recorded: there the motion goes on into the recording.
    #[must_use]
    pub fn new(feet: &Feet, first: u32, fps: f32, carried: &[Vec<Vec3>]) -> Self {
        let count = carried.len();
        let foot = |foot: usize| {
            let carried: Vec<Vec3> = carried.iter().map(|feet| feet[foot]).collect();
            let stands: Vec<bool> = (0..count).map(|k| feet.stands(first + k as u32, foot)).collect();
            let moves = moves(&carried, &stands, (LET_GO * fps).max(1.0), Ends::Recorded);
            moves.into_iter().zip(carried).map(|((by, shaped), carried)| (by, shaped, carried)).collect()
        };
        Self { feet: (0..feet.count()).map(foot).collect() }
    }

    /// Moves the feet of frame `k`; `feet` says where their vertices are in both poses.
    pub fn apply(&self, feet: &[Vec<Sole>], k: usize, recorded: &[Vec3], pose: &mut [Vec3]) {
        for (foot, moves) in feet.iter().zip(&self.feet) {
            let (by, shaped, carried) = moves[k];
            for &(at, vertex) in foot {
                let own = pose[at] - recorded[at] - carried;
                let share = |share: u8| f32::from(share) * SHARE_STEP;
                pose[at] += by * share(vertex.leg) - own * (share(vertex.sole) * shaped);
            }
        }
    }
}

/// What a motion goes over into at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Into the recording: what stands there stands as recorded.
    Recorded,
    /// Into nothing.
    Free,
}

/// How far feet are moved that stand still while they stand, frame by frame: `carried` is where a foot is, or how far off, whose
/// height is 0 on the ground.
#[must_use]
pub fn stand_still(carried: &[Vec3], stands: &[bool], fps: f32, ends: Ends) -> Vec<Vec3> {
    moves(carried, stands, (LET_GO * fps).max(1.0), ends).into_iter().map(|(by, _)| by).collect()
}

/// By how much a foot is moved in each frame, and how far it is shaped as recorded.
fn moves(carried: &[Vec3], stands: &[bool], let_go: f32, ends: Ends) -> Vec<(Vec3, f32)> {
    let count = carried.len();
    let mut stances: Vec<(usize, usize, Vec3)> = Vec::new();
    let mut k = 0;
    while k < count {
        let from = k;
        while k < count && stands[k] {
            k += 1;
        }
        if k > from {
            // Where it stands: as far off as the variation has it in the middle, but not beyond the ground.
            let free = from > 0 && k < count || ends == Ends::Free;
            let off = if free { carried[(from + k - 1) / 2].with_y(0.0) } else { Vec3::ZERO };
            stances.push((from, k - 1, off));
        }
        k += 1;
    }
    let move_of = |k: usize| {
        let after = stances.iter().position(|&(_, to, _)| to >= k);
        let before = match after {
            Some(after) => after.checked_sub(1),
            None => stances.len().checked_sub(1),
        };
        if let Some(&(from, _, off)) = after.map(|after| &stances[after])
            && k >= from
        {
            return (off - carried[k], 1.0);
        }
        // In the air, what is corrected at the last stance goes over into what is corrected at the next.
        let (start, first) = before.map_or((0, Vec3::ZERO), |s| (stances[s].1, stances[s].2 - carried[stances[s].1]));
        let (end, last) =
            after.map_or((count - 1, Vec3::ZERO), |s| (stances[s].0, stances[s].2 - carried[stances[s].0]));
        // Where nothing follows, a foot goes on as it is moved.
        let (first, last) = match ends {
            Ends::Free if before.is_none() => (last, last),
            Ends::Free if after.is_none() => (first, first),
            _ => (first, last),
        };
        let share = ramp((k - start) as f64 / (end - start).max(1) as f64) as f32;
        let since = if before.is_some() { (k - start) as f32 / let_go } else { 1.0 };
        let until = if after.is_some() { (end - k) as f32 / let_go } else { 1.0 };
        (first.lerp(last, share), 1.0 - ramp(f64::from(since.min(until))) as f32)
    };
    (0..count).map(move_of).collect()
}

/// The mean of a foot's sole.
#[must_use]
pub fn mean(foot: &[FootVertex], pose: &[Vec3]) -> Vec3 {
    let (mut sum, mut weight) = (Vec3::ZERO, 0.0);
    for vertex in foot.iter().filter(|vertex| vertex.sole > 0) {
        sum += pose[vertex.vertex as usize] * f32::from(vertex.sole);
        weight += f32::from(vertex.sole);
    }
    sum / f32::max(weight, f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_does_not_move() {
        let carried: Vec<Vec3> = (0..30).map(|k| Vec3::new(0.01 * (k as f32 * 0.4).sin(), 0.003, 0.0)).collect();
        let stands: Vec<bool> = (0..30).map(|k| (8..14).contains(&k) || k > 24).collect();
        let moves = moves(&carried, &stands, 3.0, Ends::Recorded);
        let places: Vec<Vec3> = (0..30).map(|k| carried[k] + moves[k].0).collect();
        assert!((8..13).all(|k| places[k].distance(places[k + 1]) < 1e-7 && places[k].y.abs() < 1e-7));
        assert!((25..30).all(|k| places[k].length() < 1e-7), "the last stance goes on");
        let steps = (0..29).map(|k| places[k].distance(places[k + 1]));
        assert!(steps.fold(0.0, f32::max) < 0.008, "nothing jumps");
        assert!(moves[10].1 == 1.0 && moves[18].1 == 0.0);
        // Free ends: the last stance stays where its middle is.
        let free = stand_still(&carried, &stands, 20.0, Ends::Free);
        let place = |k: usize| carried[k] + free[k];
        assert!((25..29).all(|k| place(k).distance(place(k + 1)) < 1e-7));
        assert!(place(27).distance(carried[27].with_y(0.0)) < 1e-7 && free[0] == free[8]);
    }
}
