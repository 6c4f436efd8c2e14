//! What is round may be found turned by another angle on each side: a skirt with dots lies dot on dot, and is stretched on one side and
//! squeezed on the other. Turning it as a whole ([`super::round`]) does not mend that. So it is cut into sectors by bearing, and each of
//! them is turned by an angle of its own along the surface that was found. Of all combinations the one is taken by which colours differ
//! least and the distances from sector to sector are most like the template's own; these depend on angles of neighbours alone, so that it
//! is found exactly ([`super::cycle`]).

use glam::Vec3;
use rayon::prelude::*;

use super::cycle::Cycle;
use super::flare::flare;
use super::round::Round;
use super::surface::Surface;
use super::track::Target;

/// Sectors around the axis.
const SECTORS: usize = 16;
/// Turns that are tried of each, degrees to both sides, one by one.
const MOST: usize = 40;
const LABELS: usize = 2 * MOST + 1;
/// The difference of colours beyond which one counts for little.
const COLOUR_WIDTH: f32 = 0.15;
/// Sectors that would come nearer to each other than so many degrees would lie on each other, and what that costs.
const NEAREST: f32 = 2.0;
const FOLDED: f32 = 4.0;
/// What takes so much part in a turn goes with its sector as a whole.
const WHOLE: f32 = 0.9;
/// What the largest turn costs by itself: of two ways to mend a side the one that turns less of the part.
const TURNED: f32 = 0.02;
/// What takes less part than this is not asked for its colour.
const PART: f32 = 0.5;

/// What flares is no skirt where it is less of the surface. The performer's is 0.34 to 0.38 of it, as a template of any of 26 frames; folds and
/// legs of a dancer in trousers are up to 0.22.
const LEAST_AREA: f32 = 0.3;

/// A vertex that takes part.
#[derive(Clone, Debug)]
struct Member {
    vertex: usize,
    /// It lies between the middles of this sector and of the next, of which it has this share.
    sector: usize,
    next: f32,
    /// How much it takes part.
    part: f32,
    /// The triangle of the template, and the point of it, that it comes to lie on by each turn.
    points: Vec<Option<(u32, Vec3)>>,
}

impl Member {
    /// The turn that it has, where sectors have `labels`, as a label that need not be whole.
    fn label(&self, labels: [usize; 2]) -> f32 {
        let [own, next] = labels.map(|label| label as f32);
        own + (next - own) * self.next
    }

    /// `values` of a pose of the template, where the vertex comes to lie by the turn `label`.
    fn at(&self, label: usize, posed: &Surface, values: &[Vec3]) -> Vec3 {
        self.points[label]
            .map_or(values[self.vertex], |(triangle, weights)| posed.interpolated(values, triangle, weights))
    }
}

/// Turns, by bearing, of the part of a template that is round and flares.
#[derive(Clone, Debug)]
pub struct Twists {
    members: Vec<Member>,
    /// From the middle of each sector to that of the next, on the template, metres.
    rest: Vec<f32>,
}

/// A point of each sector.
type Ring = [Vec3; SECTORS];

impl Twists {
    /// Of `round` on the template's `surface`; `scale` as [`super::template::Template::scale`]. `None` where there are no colours, little flares, or nothing is
    /// in a sector.
    #[must_use]
    pub fn new(round: &Round, surface: &Surface, scale: f32) -> Option<Self> {
        surface.colours.as_ref()?;
        let parts = flare(round, surface, scale);
        let area: f32 = parts.iter().zip(&surface.areas).map(|(part, area)| part * area).sum();
        if area < LEAST_AREA * surface.area() {
            return None;
        }
        let of = |vertex: usize| {
            let at = round.bearing(surface.mesh.positions[vertex]) / std::f32::consts::TAU * SECTORS as f32;
            let part = parts[vertex];
            let point = |label: usize| {
                let found = round.under(surface, vertex, part * turn_of(label).to_radians())?;
                Some((found.triangle, found.weights))
            };
            let points = (0..LABELS).map(point).collect();
            Member { vertex, sector: at as usize % SECTORS, next: at.fract(), part, points }
        };
        let taking: Vec<usize> = (0..parts.len()).filter(|&vertex| parts[vertex] > 0.0).collect();
        let members: Vec<Member> = taking.into_par_iter().map(of).collect();
        let mut twists = Self { members, rest: Vec::new() };
        let middles = twists.middles(surface)?;
        twists.rest = (0..SECTORS).map(|sector| length(&middles, sector, [MOST; 2])).collect();
        twists.rest.iter().all(|&rest| rest > 0.0).then_some(twists)
    }

    /// `posed`, a pose of the template `surface` that was found on `target`, with each sector turned as is cheapest: once for each of
    /// `weights`, so many times as much strain counts as colours.
    #[must_use]
    pub fn turned(&self, surface: &Surface, posed: &Surface, target: &Target, weights: &[f32]) -> Vec<Vec<Vec3>> {
        let (Some(middles), Some(colours)) = (self.middles(posed), self.colours(surface, posed, target)) else {
            return Vec::new();
        };
        let cheapest = |&weight: &f32| {
            let cost = |sector: usize, own: usize, next: usize| {
                let colour = colours[(sector * LABELS + own) * LABELS + next];
                let turn = turn_of(own) / MOST as f32;
                colour + weight * self.strain(&middles, sector, [own, next]) + TURNED * turn * turn
            };
            self.posed(posed, &Cycle::new(SECTORS, LABELS, cost).cheapest())
        };
        weights.par_iter().map(cheapest).collect()
    }

    /// Where the middles of sectors come to lie on a pose, by each turn; `None` where there is nothing in a sector.
    fn middles(&self, posed: &Surface) -> Option<Vec<Ring>> {
        let of = |label: usize| -> Option<Ring> {
            let mut sums = [(Vec3::ZERO, 0.0_f32); SECTORS];
            for member in self.members.iter().filter(|member| member.part > WHOLE) {
                let (area, place) = (posed.areas[member.vertex], member.at(label, posed, &posed.mesh.positions));
                let after = (member.sector + 1) % SECTORS;
                for (sector, share) in [(member.sector, 1.0 - member.next), (after, member.next)] {
                    sums[sector].0 += place * (area * share);
                    sums[sector].1 += area * share;
                }
            }
            let is_full = sums.iter().all(|&(_, area)| area > 0.0);
            is_full.then(|| sums.map(|(sum, area)| sum / area))
        };
        let by_label: Vec<Option<Ring>> = (0..LABELS).into_par_iter().map(of).collect();
        by_label.into_iter().collect()
    }

    /// How much longer or shorter than on the template it is from the middle of `sector` to that of the next, turned by `labels`: the square
    /// of the logarithm.
    fn strain(&self, middles: &[Ring], sector: usize, [own, next]: [usize; 2]) -> f32 {
        if 360.0 / SECTORS as f32 + turn_of(next) - turn_of(own) < NEAREST {
            return FOLDED;
        }
        (length(middles, sector, [own, next]) / self.rest[sector]).max(1e-3).ln().powi(2)
    }

    /// How much colours differ between the middles of a sector and of the next, from 0 to 1, by the sector, its label and that of the next.
    fn colours(&self, surface: &Surface, posed: &Surface, target: &Target) -> Option<Vec<f32>> {
        let (own, others) = (surface.colours.as_ref()?, target.surface.colours.as_ref()?);
        let members: Vec<&Member> = self.members.iter().filter(|member| member.part > PART).collect();
        let of = |member: &&Member| -> Vec<f32> {
            let differs = |label: usize| {
                let place = member.at(label, posed, &posed.mesh.positions);
                let normal = member.at(label, posed, &posed.normals).normalize_or(posed.normals[member.vertex]);
                let Some(found) = target.closest(place, normal) else { return 1.0 };
                let colour = target.surface.interpolated(others, found.triangle, found.weights);
                let square = colour.distance_squared(own[member.vertex]);
                square / (square + COLOUR_WIDTH * COLOUR_WIDTH)
            };
            (0..LABELS).map(differs).collect()
        };
        let differences: Vec<Vec<f32>> = members.par_iter().map(of).collect();
        let of_sector = |sector: usize| {
            let within = || members.iter().zip(&differences).filter(move |(member, _)| member.sector == sector);
            let area: f32 = within().map(|(member, _)| surface.areas[member.vertex]).sum();
            let pair = |own: usize, next: usize| {
                let differs = |(member, by_label): (&&Member, &Vec<f32>)| {
                    surface.areas[member.vertex] * by_label[(member.label([own, next]) + 0.5) as usize]
                };
                within().map(differs).sum::<f32>() / area.max(1e-9)
            };
            (0..LABELS)
                .flat_map(|own| (0..LABELS).map(move |next| (own, next)))
                .map(|(own, next)| pair(own, next))
                .collect()
        };
        let by_sector: Vec<Vec<f32>> = (0..SECTORS).into_par_iter().map(of_sector).collect();
        Some(by_sector.concat())
    }

    /// `posed` with sectors turned by `labels`.
    fn posed(&self, posed: &Surface, labels: &[usize]) -> Vec<Vec3> {
        let mut pose = posed.mesh.positions.clone();
        for member in &self.members {
            let label = member.label([labels[member.sector], labels[(member.sector + 1) % SECTORS]]);
            let [below, above] =
                [label.floor(), label.ceil()].map(|label| member.at(label as usize, posed, &posed.mesh.positions));
            pose[member.vertex] = below.lerp(above, label.fract());
        }
        pose
    }
}

/// From the middle of `sector` to that of the next, turned by `labels`.
fn length(middles: &[Ring], sector: usize, [own, next]: [usize; 2]) -> f32 {
    middles[own][sector].distance(middles[next][(sector + 1) % SECTORS])
}

/// The turn of a label, degrees.
fn turn_of(label: usize) -> f32 {
    label as f32 - MOST as f32
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;
    use glam::Quat;

    use super::*;
    use crate::template::Template;

    /// A skirt about the vertical, with a stripe every 20 degrees, under a trunk.
    fn skirt(cell: f32) -> Surface {
        let distance = |p: Vec3| {
            let across = p.x.hypot(p.z);
            let cone = ((across - (0.12 + 0.5 * (0.4 - p.y))) * 0.9).max(-0.1 - p.y).max(p.y - 0.4);
            let trunk = (Vec3::new(p.x, p.y - p.y.clamp(0.4, 1.0), p.z) / Vec3::new(1.3, 1.0, 0.8)).length() - 0.12;
            cone.min(trunk * 0.8)
        };
        let mesh = polygonise(Vec3::new(-0.6, -0.3, -0.6), Vec3::new(0.62, 1.3, 0.61), cell, distance);
        let colour =
            |p: &Vec3| Vec3::splat(0.5 + 0.4 * (18.0 * p.x.atan2(p.z)).sin() * (p.x.hypot(p.z) / 0.2).min(1.0));
        let colours = mesh.positions.iter().map(colour).collect();
        Surface::new(mesh, Some(colours))
    }

    /// By how much a skirt's side is turned at a bearing of so many degrees: one stripe behind, nothing at the sides and in front.
    fn slipped(bearing: f32) -> f32 {
        20.0 * (1.0 - (((bearing - 180.0).abs() - 30.0) / 60.0).clamp(0.0, 1.0))
    }

    #[test]
    fn a_side_that_is_a_stripe_off_is_turned_back() {
        let template = Template::new(skirt(0.025)).unwrap();
        let (surface, target) = (&template.surface, Target::new(skirt(0.023), 1.0));
        let neighbours = surface.mesh.neighbours();
        let round = Round::new(&template, &neighbours).unwrap();
        let twists = Twists::new(&round, surface, template.scale).unwrap();
        let twisted = |p: &Vec3| {
            let share = ((0.4 - p.y) / 0.2).clamp(0.0, 1.0);
            let bearing = p.x.atan2(p.z).to_degrees().rem_euclid(360.0);
            Quat::from_rotation_y((share * slipped(bearing)).to_radians()) * *p
        };
        let truth = &surface.mesh.positions;
        let found = surface.posed(truth.iter().map(twisted).collect());
        let hem: Vec<usize> =
            (0..truth.len()).filter(|&v| truth[v].y < 0.2 && truth[v].z < -2.0 * truth[v].x.abs()).collect();
        let off = |pose: &[Vec3]| hem.iter().map(|&v| pose[v].distance(truth[v])).sum::<f32>() / hem.len() as f32;
        let turned = twists.turned(surface, &found, &target, &[1.0]);
        let (before, after) = (off(&found.mesh.positions), off(&turned[0]));
        assert!(before > 0.06 && after < 0.3 * before, "{before} and {after}");
        // What lies right stays, and so does the trunk.
        let kept = twists.turned(surface, &surface.posed(truth.clone()), &target, &[1.0]);
        assert!(off(&kept[0]) < 0.01, "{}", off(&kept[0]));
        let trunk = (0..truth.len()).filter(|&v| truth[v].y > 0.6);
        assert!(trunk.map(|v| turned[0][v].distance(found.mesh.positions[v])).fold(0.0, f32::max) < 1e-3);
        // Strain alone, the plain sum over what was found, is no more than what it was.
        let sum = |pose: &Surface| {
            let middles = twists.middles(pose).unwrap();
            (0..SECTORS).map(|sector| twists.strain(&middles, sector, [MOST, MOST])).sum::<f32>()
        };
        assert!(sum(&surface.posed(turned[0].clone())) < 0.5 * sum(&found));
    }

    #[test]
    fn without_colours_there_are_no_twists() {
        let template = Template::new(Surface::new(skirt(0.05).mesh, None)).unwrap();
        let round = Round::new(&template, &template.surface.mesh.neighbours()).unwrap();
        assert!(Twists::new(&round, &template.surface, template.scale).is_none());
    }
}
