//! Which families a capture has: what cycles in its sequences, and which of these cycles do the same at another speed.

use glam::Vec3;
use kernels::align::centre_of_mass;

use crate::cycle::Cycle;
use crate::family::{Part, Wanted, best_cycle, how_unlike};
use crate::jump::jumps;
use crate::parameter::Parameter;
use crate::recorded::{Recorded, Track};

/// Ends of a cycle further apart than this meet badly, in body heights: 9 cm of 1.8 m.
pub const MEETS: f32 = 0.05;
/// Members further from each other than this at the same phase do something else, in body heights: 22 cm of 1.8 m.
pub const UNLIKE: f32 = 0.12;
/// A cycle that turns less than this goes straight on, in radians.
const STRAIGHT: f32 = 0.35;
/// A cycle whose way is shorter is a step on the spot, in body heights.
const GOES: f32 = 0.2;
/// What a family spans at least: speeds, turns, heights and lengths, in their units.
const SPANS: [f32; 4] = [0.25, 0.25, 0.04, 0.1];
/// Turns belong together whose speeds differ by less than this part.
const LIKE: f32 = 0.4;

/// What was found in a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Index of the sequence.
    pub sequence: usize,
    /// Its frames within the sequence: the first one, and the one that does the same again, or that ends the jump.
    pub frames: (u32, u32),
    /// Whether it jumps; otherwise it steps.
    pub jumps: bool,
    /// Metres a second; of a jump 0.
    pub speed: f32,
    /// Radians a metre; of a jump 0.
    pub turn: f32,
    /// How far the centre of mass rises, of a jump above the ends of its flight, in metres; of steps 0.
    pub height: f32,
    /// How far a jump leads, in metres; of steps 0.
    pub length: f32,
    /// How far its ends are apart, in metres; of a jump 0.
    pub apart: f32,
    /// Whether its ends meet well enough to be proposed.
    pub meets: bool,
}

/// A family that could be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Its name: `gait`, `turn`, `jump`.
    pub name: &'static str,
    /// What makes it.
    pub wanted: Wanted,
}

/// What cycles in the sequences of a capture, in their order: the best steps of each, the steps that turn most, and all jumps.
#[must_use]
pub fn found(recorded: &Recorded) -> Vec<Found> {
    let mut all = Vec::new();
    for (sequence, own) in recorded.timeline.sequences().iter().enumerate() {
        let track = recorded.track(sequence);
        let first = track.own().start;
        let within = |at: usize| (at - first) as u32;
        for parameter in [Parameter::Speed, Parameter::Turn] {
            let Some(cycle) = best_steps(recorded, &track, parameter) else { continue };
            let seconds = cycle.frames() as f32 / recorded.timeline.fps();
            let turn = if cycle.way > 0.0 { cycle.twist.turn / cycle.way } else { 0.0 };
            let goes = cycle.way > GOES * recorded.body();
            let steps = Found {
                sequence,
                frames: (within(cycle.from), within(cycle.to)),
                jumps: false,
                speed: cycle.way / seconds,
                turn: if goes { turn } else { 0.0 },
                height: 0.0,
                length: 0.0,
                apart: cycle.apart,
                meets: goes && cycle.apart < MEETS * recorded.body(),
            };
            // The same cycle need not be told twice.
            if !all.contains(&steps) {
                all.push(steps);
            }
        }
        for jump in jumps(recorded, &track) {
            let centre = |at: usize| centre(recorded, &track, at);
            let (off, land) = (centre(jump.off), centre(jump.land));
            let last = own.frame_count - 1;
            let (before, after) = (jump.around.0 - 1, jump.around.1 - 1);
            all.push(Found {
                sequence,
                frames: (within(jump.off - before.min(jump.off - first)), within(jump.land + after).min(last)),
                jumps: true,
                speed: 0.0,
                turn: 0.0,
                height: jump.rise,
                length: (land - off).with_y(0.0).length(),
                apart: 0.0,
                meets: true,
            });
        }
    }
    all
}

fn best_steps(recorded: &Recorded, track: &Track, parameter: Parameter) -> Option<Cycle> {
    let feet = 0..recorded.feet.count();
    let best = feet.filter_map(|foot| best_cycle(recorded, track, foot, parameter, None));
    best.min_by(|a, b| a.apart.total_cmp(&b.apart))
}

fn centre(recorded: &Recorded, track: &Track, at: usize) -> Vec3 {
    centre_of_mass(&track.pose(recorded, at), recorded.topology.weights())
}

/// The families that lie in what was found.
#[must_use]
pub fn proposals(recorded: &Recorded, found: &[Found]) -> Vec<Proposal> {
    let steps = |is: &dyn Fn(&Found) -> bool| -> Vec<Found> {
        found.iter().copied().filter(|one| !one.jumps && one.meets && is(one)).collect()
    };
    let straight = steps(&|one| (one.turn * one.speed).abs() < STRAIGHT);
    let all = steps(&|_| true);
    // Those that are about as fast as what turns most.
    let sharpest = all.iter().copied().max_by(|a, b| a.turn.abs().total_cmp(&b.turn.abs()));
    let like: Vec<Found> = all
        .into_iter()
        .filter(|one| sharpest.is_some_and(|other| (one.speed / other.speed - 1.0).abs() < LIKE))
        .collect();
    let flights: Vec<Found> = found.iter().copied().filter(|one| one.jumps).collect();
    let candidates: [(&'static str, Parameter, Vec<Found>); 4] = [
        ("gait", Parameter::Speed, straight),
        ("turn", Parameter::Turn, like),
        ("jump height", Parameter::Height, flights.clone()),
        ("jump length", Parameter::Length, flights),
    ];
    let made = candidates.into_iter().zip(SPANS);
    made.filter_map(|((name, parameter, list), span)| {
        let wanted = Wanted { parameter, sequences: spread(recorded, list, parameter, span) };
        let alike = |wanted: &Wanted| how_unlike(recorded, wanted).is_ok_and(|far| far < UNLIKE * recorded.body());
        (wanted.sequences.len() > 1 && alike(&wanted)).then_some(Proposal { name, wanted })
    })
    .collect()
}

fn value(one: &Found, parameter: Parameter) -> f32 {
    match parameter {
        Parameter::Speed => one.speed,
        Parameter::Turn => one.turn,
        Parameter::Height => one.height,
        Parameter::Length => one.length,
    }
}

/// Of what is about as large only what meets best, in order; of steps one a sequence.
fn spread(recorded: &Recorded, mut list: Vec<Found>, parameter: Parameter, span: f32) -> Vec<Part> {
    list.sort_by(|a, b| value(a, parameter).total_cmp(&value(b, parameter)));
    let mut kept: Vec<Found> = Vec::new();
    for one in list {
        let near = kept.last().is_some_and(|last| value(&one, parameter) - value(last, parameter) < span);
        let again = !one.jumps && kept.iter().any(|other| other.sequence == one.sequence);
        match kept.last_mut() {
            Some(last) if near && one.apart < last.apart => *last = one,
            _ if near || again => {}
            _ => kept.push(one),
        }
    }
    let named = |one: &Found| {
        // Where a sequence has one jump, it is found again by itself; steps are the best ones in any case.
        let again = !one.jumps || jumps(recorded, &recorded.track(one.sequence)).len() == 1;
        (one.sequence, (!again).then_some(one.frames))
    };
    kept.iter().map(named).collect()
}
