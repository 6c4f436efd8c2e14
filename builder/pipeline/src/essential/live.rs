//! One graph for every alpha that a player may choose.
//!
//! What is essential at one alpha is exact (thesis section 3.3), and at the capture's own alpha it is all kept. With alpha the
//! essential graph grows: at 0.2, in the papers' terms a quick actor, half of all pairs of frames are joined best by a
//! transition of their own, and nearly all of them differ from a neighbour by a frame or two of waiting. Nobody sees that. So of
//! what is essential elsewhere a transition is left out where one that is kept can be reached by playing on, and leads there by
//! playing on, with at most [`SLACK_SECONDS`] of both together, and costs no more than that much dearer.

use actor::timeline::Timeline;

use super::candidates::Candidates;
use crate::transitions::TransitionCost;

/// Seconds of recorded frames by which a way may be longer than the best one, for each of its transitions.
pub const SLACK_SECONDS: f32 = 0.16;

/// All of `own`, which is essential at the capture's own alpha, and of each of `others`, with the alpha at which it is
/// essential, enough to stand for the rest.
#[must_use]
pub fn one_for_all(own: &Candidates, others: &[(f64, Candidates)], timeline: &Timeline) -> Candidates {
    let slack = (SLACK_SECONDS * timeline.fps()).round() as u32;
    let mut kept: Vec<Row> = (0..own.frame_count()).map(|frame| own.from(frame).to_vec()).collect();
    for &(alpha, ref others) in others {
        let around = Around { timeline, alpha, slack };
        // Whoever leaves first and arrives last has nobody behind it that it could stand for.
        for from in 0..others.frame_count() {
            for &(to, cost) in others.from(from).iter().rev() {
                let most = cost.cost(alpha) + alpha * f64::from(slack);
                if around.ahead(|frame| &kept[frame as usize], (from, to), most).next().is_some() {
                    continue;
                }
                // What stands for most of those around it; itself, if need be.
                let best =
                    around.ahead(|frame| others.from(frame), (from, to), most).max_by_key(|stand_in| stand_in.area);
                let Some(StandIn { from, to, cost, .. }) = best else { continue };
                let row = &mut kept[from as usize];
                let place = row.partition_point(|&(other, _)| other < to);
                row.insert(place, (to, cost));
            }
        }
    }
    let mut union = Candidates::new();
    kept.into_iter().for_each(|row| union.push_row(row));
    union
}

/// Transitions from one frame, by destination.
type Row = Vec<(u32, TransitionCost)>;

/// A transition that may stand for another one.
struct StandIn {
    from: u32,
    to: u32,
    cost: TransitionCost,
    /// Transitions that it stands for, if costs allow.
    area: u32,
}

/// Where transitions are looked for that stand for another one.
struct Around<'a> {
    timeline: &'a Timeline,
    alpha: f64,
    /// Frames that may be waited before and after.
    slack: u32,
}

impl Around<'_> {
    /// Those of `rows` that leave from `from` or a little later, arrive at `to` or a little earlier, and cost at most `most` with
    /// the frames between.
    fn ahead<'r>(
        &self,
        rows: impl Fn(u32) -> &'r [(u32, TransitionCost)],
        (from, to): (u32, u32),
        most: f64,
    ) -> impl Iterator<Item = StandIn> {
        let waits = (0..=self.slack).flat_map(|late| (0..=self.slack - late).map(move |early| (late, early)));
        waits.filter_map(move |(late, early)| {
            let (from, to) = (self.timeline.offset(from, late.into())?, self.timeline.offset(to, -i64::from(early))?);
            let row = rows(from);
            let cost = row[row.binary_search_by_key(&to, |&(to, _)| to).ok()?].1;
            let waited = self.alpha * f64::from(late + early);
            (waited + cost.cost(self.alpha) <= most).then_some(StandIn {
                from,
                to,
                cost,
                area: (late + 1) * (early + 1),
            })
        })
    }
}
