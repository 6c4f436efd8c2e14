//! Walking and running along any path: a phase that the speed drives, footfalls taken from it, and the body above.
//!
//! One stride is one turn of the phase: the left foot lands at 0, the right foot at a half. Numbers for normal adults
//! are those of the gait literature (stance 60 % at 1.3 m/s, 35 % at 3 m/s, stride 1.4 m at 1.3 m/s).

use std::f32::consts::TAU;

use glam::{Quat, Vec3};

use super::curve::Curve;
use super::feet::{FootTrack, Plant, Swing};
use super::skeleton::{BodyState, Channel, Controls};
use geometry::sdf::smoothstep;
use kernels::random::{mix, noise1};

/// Samples a second of the path.
const RATE: f32 = 200.0;
/// The path is known this long before and after the sequence.
const MARGIN: f32 = 4.0;

/// What to walk.
pub struct Route {
    /// Speed in m/s over seconds.
    pub speed: Curve,
    /// Rate of turning to the left in degrees a second over seconds.
    pub turn: Curve,
    /// How long it lasts, in seconds.
    pub seconds: f32,
    /// Whether it ends standing; the phase then ends where both feet are down.
    pub stops: bool,
    /// Whether it begins standing.
    pub starts: bool,
    /// Seed of what tells one stride from the next.
    pub seed: u64,
}

/// A route walked: the path, its phase and the footfalls.
pub struct Gait {
    places: Vec<Vec3>,
    headings: Vec<f32>,
    phases: Vec<f32>,
    speeds: Vec<f32>,
    turns: Vec<f32>,
    feet: [FootTrack; 2],
    seed: u64,
}

impl Gait {
    /// Walks `route`.
    #[must_use]
    pub fn new(route: &Route) -> Self {
        let count = ((route.seconds + 2.0 * MARGIN) * RATE) as usize;
        let mut gait = Self {
            places: Vec::with_capacity(count),
            headings: Vec::with_capacity(count),
            phases: Vec::with_capacity(count),
            speeds: Vec::with_capacity(count),
            turns: Vec::with_capacity(count),
            feet: Default::default(),
            seed: route.seed,
        };
        let (mut place, mut heading, mut phase) = (Vec3::ZERO, 0.0_f32, 0.0_f32);
        for k in 0..count {
            let t = k as f32 / RATE - MARGIN;
            let speed = route.speed.at(t).max(0.0) * (1.0 + 0.04 * noise1(mix(route.seed, 1), t * 0.9));
            let turn = route.turn.at(t).to_radians();
            gait.places.push(place);
            gait.headings.push(heading);
            gait.phases.push(phase);
            gait.speeds.push(speed);
            gait.turns.push(turn);
            heading += turn / RATE;
            place += Quat::from_rotation_y(heading) * Vec3::Z * (speed / RATE);
            phase += (0.566 + 0.28 * speed) * smoothstep(0.01, 0.22, speed) / RATE;
        }
        gait.align_phase(route);
        gait.feet = [gait.track(0), gait.track(1)];
        gait
    }

    /// Shifts the phase so that standing happens with both feet down.
    fn align_phase(&mut self, route: &Route) {
        let standing = 0.05;
        let shift = if route.starts {
            0.11
        } else if route.stops {
            let last = self.phases.last().copied().unwrap_or(0.0);
            standing - last.rem_euclid(0.5) + if noise1(route.seed, 0.3) > 0.0 { 0.5 } else { 0.0 }
        } else {
            noise1(mix(route.seed, 2), 0.5)
        };
        // Counting strides from a large whole number keeps phases positive.
        for phase in &mut self.phases {
            *phase += shift + 10.0;
        }
        let start = self.index(0.0);
        let origin = self.places[start];
        let turn = Quat::from_rotation_y(-self.headings[start]);
        let heading = self.headings[start];
        for place in &mut self.places {
            *place = turn * (*place - origin);
        }
        for other in &mut self.headings {
            *other -= heading;
        }
    }

    fn index(&self, t: f32) -> usize {
        (((t + MARGIN) * RATE).max(0.0) as usize).min(self.phases.len() - 1)
    }

    fn sample(&self, values: &[f32], t: f32) -> f32 {
        let x = ((t + MARGIN) * RATE).clamp(0.0, values.len() as f32 - 1.001);
        let k = x as usize;
        values[k] + (values[k + 1] - values[k]) * (x - k as f32)
    }

    /// The time at which the phase reaches `phase`; infinities beyond the path.
    fn time_of(&self, phase: f32) -> f32 {
        let k = self.phases.partition_point(|&p| p < phase);
        if k == 0 {
            return f32::NEG_INFINITY;
        }
        if k == self.phases.len() {
            return f32::INFINITY;
        }
        let (a, b) = (self.phases[k - 1], self.phases[k]);
        (k as f32 - 1.0 + (phase - a) / (b - a).max(1e-9)) / RATE - MARGIN
    }

    fn track(&self, side: usize) -> FootTrack {
        let offset = side as f32 * 0.5;
        let (Some(&first), Some(&last)) = (self.phases.first(), self.phases.last()) else {
            return FootTrack::default();
        };
        let outwards = if side == 0 { 1.0 } else { -1.0 };
        let mut plants = Vec::new();
        for stride in (first - offset).floor() as i64 - 1..=(last - offset).ceil() as i64 {
            let landing = stride as f32 + offset;
            let land = self.time_of(landing);
            let speed = self.sample(&self.speeds, land.clamp(-MARGIN, 1e3));
            let stance = stance_share(speed);
            let lift = self.time_of(landing + stance);
            if land == f32::INFINITY || lift == f32::NEG_INFINITY {
                continue;
            }
            // Over the foot when half of the stance has passed, or where the body stood meanwhile.
            let middle = self.resting_time(land, lift).unwrap_or_else(|| self.time_of(landing + stance * 0.5));
            let k = self.index(middle);
            let (speed_there, heading) = (self.speeds[k], self.headings[k]);
            let running = smoothstep(1.6, 2.6, speed_there);
            let wide = 0.1 + (0.062 - 0.1) * smoothstep(0.1, 0.9, speed_there) - 0.03 * running;
            let wobble = 0.008 * noise1(mix(self.seed, 20 + side as u64), landing * 1.7);
            let aside = Vec3::new(outwards * wide + wobble, 0.0, -0.012 + 0.02 * running);
            plants.push(Plant {
                from: land.max(-100.0),
                to: lift.min(100.0),
                place: self.places[k] + Quat::from_rotation_y(heading) * aside,
                yaw: heading + outwards * 0.12,
                roll: roll(land, lift, speed, self.sample(&self.speeds, lift.clamp(-MARGIN, 1e3))),
                swing: swing(self.sample(&self.speeds, lift.clamp(-MARGIN, 1e3))),
            });
        }
        FootTrack { plants }
    }

    /// A moment between `land` and `lift` when the body stands still.
    fn resting_time(&self, land: f32, lift: f32) -> Option<f32> {
        let range = self.index(land.max(-MARGIN))..=self.index(lift.min(1e3));
        let slowest = range.min_by(|&a, &b| self.speeds[a].total_cmp(&self.speeds[b]))?;
        (self.speeds[slowest] < 0.02).then(|| slowest as f32 / RATE - MARGIN)
    }

    /// The body at time `t`, and which feet are down.
    #[must_use]
    pub fn at(&self, t: f32) -> (BodyState, [bool; 2]) {
        let x = ((t + MARGIN) * RATE).clamp(0.0, self.places.len() as f32 - 1.001);
        let k = x as usize;
        let root = self.places[k].lerp(self.places[k + 1], x - k as f32);
        let heading = self.sample(&self.headings, t);
        let (left, right) = (self.feet[0].at(t), self.feet[1].at(t));
        let state = BodyState { root, heading, controls: self.controls(t), feet: [left.0, right.0] };
        (state, [left.1, right.1])
    }

    fn controls(&self, t: f32) -> Controls {
        // Muscles do not change their minds at once: speed and turn are averaged over 0.3 s.
        let average =
            |values: &[f32]| (0..7).map(|k| self.sample(values, t + (k as f32 - 3.0) * 0.05)).sum::<f32>() / 7.0;
        let (speed, turn) = (average(&self.speeds), average(&self.turns));
        let ahead = self.sample(&self.speeds, t + 0.25) - self.sample(&self.speeds, t - 0.25);
        let phase = self.sample(&self.phases, t);
        let going = smoothstep(0.05, 0.9, speed);
        let running = smoothstep(1.5, 2.7, speed);
        let wave = |shift: f32| (TAU * (phase - shift)).cos();
        let twice = |shift: f32| (2.0 * TAU * (phase - shift)).cos();
        let mut c = Controls::default();
        let vary = |stream: u64| 1.0 + 0.13 * noise1(mix(self.seed, stream), t * 0.8);
        let walk_height = 0.019 * twice(0.3) - 0.03;
        let run_height = 0.034 * twice(0.43) - 0.062;
        c[Channel::Up] += going * (walk_height + (run_height - walk_height) * running);
        // Into the turn, as the sum of gravity and centrifugal force asks.
        let lean = (speed * turn / 9.81).atan() * 0.85;
        c[Channel::Left] = going * (0.021 - 0.011 * running) * wave(0.3) * vary(3) + lean.sin() * 0.9;
        c[Channel::Forward] = 0.012 * ahead.clamp(-1.0, 1.5) + 0.03 * running;
        c[Channel::PelvisYaw] = -going * (4.5 + 3.0 * running) * wave(0.02) * vary(4);
        c[Channel::PelvisRoll] = going * 3.6 * wave(0.22) - lean.to_degrees() * 0.7;
        c[Channel::PelvisPitch] = going * (2.0 + 6.0 * running) + 2.5 * ahead.clamp(-1.2, 2.0);
        c[Channel::TrunkYaw] = going * (9.5 + 9.0 * running) * wave(0.03) * vary(5) + turn.to_degrees() * 0.08;
        c[Channel::TrunkRoll] = -going * 3.0 * wave(0.22) - lean.to_degrees() * 0.15;
        c[Channel::TrunkPitch] =
            going * (1.0 + 5.0 * running) + 1.0 * going * twice(0.08) + 2.0 * ahead.clamp(-1.2, 2.0);
        c[Channel::HeadYaw] = -going * 4.5 * wave(0.03)
            + turn.to_degrees().clamp(-90.0, 90.0) * 0.26
            + 4.0 * noise1(mix(self.seed, 6), t * 0.5);
        c[Channel::HeadPitch] = -going * (1.5 + 8.0 * running) - 1.2 * going * twice(0.15);
        c[Channel::HeadRoll] = lean.to_degrees() * 0.6;
        for side in 0..2 {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let arm = |channel: Channel| channel as usize + side * 6;
            let reach = (22.0 + 15.0 * running) * vary(7 + side as u64);
            let swing = sign * wave(0.04);
            c.0[arm(Channel::FlexL)] += going * (reach * swing + 3.0 - 8.0 * running);
            c.0[arm(Channel::ElbowL)] +=
                going * (6.0 + 10.0 * swing.max(-0.5) + 66.0 * running + 8.0 * running * swing);
            c.0[arm(Channel::SpreadL)] += going * (-3.0 + 4.0 * running);
            c.0[arm(Channel::TwistL)] += going * (8.0 + 22.0 * running * (0.5 + 0.5 * swing));
        }
        c
    }
}

/// Share of the stride during which a foot is down.
fn stance_share(speed: f32) -> f32 {
    0.62 - 0.27 * smoothstep(1.2, 3.0, speed)
}

/// Heel strike, flat, heel off: pitch in degrees over seconds since landing.
fn roll(land: f32, lift: f32, speed: f32, leaving: f32) -> Curve {
    let mut keys = Vec::new();
    let stance = (lift - land).min(4.0);
    if land.is_finite() {
        let strike = -strike_angle(speed);
        keys.extend([(0.0, strike), (0.16 * stance.min(0.8), 0.0)]);
    }
    if lift.is_finite() {
        let seconds = (lift - land.max(-100.0)).min(200.0);
        let off = off_angle(leaving);
        keys.extend([
            (seconds - 0.62 * stance.min(0.8), 0.0),
            (seconds - 0.25 * stance.min(0.8), 0.26 * off),
            (seconds, off),
        ]);
    }
    Curve::new(&keys)
}

fn strike_angle(speed: f32) -> f32 {
    17.0 * smoothstep(0.2, 1.0, speed) * (1.0 - 0.75 * smoothstep(1.6, 2.6, speed))
}

fn off_angle(speed: f32) -> f32 {
    (12.0 + 26.0 * smoothstep(0.1, 1.0, speed)) + 12.0 * smoothstep(1.6, 2.6, speed)
}

fn swing(speed: f32) -> Swing {
    let running = smoothstep(1.6, 2.8, speed);
    let off = off_angle(speed);
    let strike = -strike_angle(speed);
    let back = 0.035 + 0.21 * running;
    Swing {
        height: Curve::new(&[
            (0.0, 0.0),
            (0.32 + 0.06 * running, back + 0.02),
            (0.72, 0.022 + 0.07 * running),
            (1.0, 0.0),
        ]),
        pitch: Curve::new(&[
            (0.0, off),
            (0.14, off * 1.18 + 12.0 * running),
            (0.5, 8.0 + 32.0 * running),
            (0.86, strike * 1.1),
            (1.0, strike),
        ]),
        left: Curve::default(),
        forward: Curve::default(),
        ballistic: false,
    }
}
