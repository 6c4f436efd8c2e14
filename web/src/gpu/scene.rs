//! Everything that a picture shows, and the passes that draw it, in order.

use actor::surface::Surface;
use glam::{Vec2, Vec3};

use super::appearance::TextureRebuild;
use super::context::Gpu;
use super::frame::{FrameGroup, Look};
use super::ghosts::Ghosts;
use super::grid::Grid;
use super::marks::Marks;
use super::mesh::Mesh;
use super::mix::Mix;
use super::pose::{ActorUniform, Numbered, PoseGroup, pose_layout};
use super::scans::{Carrier, Scans, Wanted};
use super::shadow::{Shadow, Square};
use super::target::Target;
use super::trail::Trail;
use crate::camera::{Subject, View};
use crate::trail::{TrailPoint, ribbon};

/// What the actor shows at a moment.
pub struct Moment<'a> {
    /// The frame before the moment.
    pub before: Numbered<'a>,
    /// The frame after it.
    pub after: Numbered<'a>,
    /// 0 is the one, 1 the other.
    pub weight: f32,
    /// 0 where recorded, 1 where synthesised, between them while it changes.
    pub synthetic: f32,
    /// Where the actor's centre of mass is on the ground (X, Z).
    pub ground: Vec2,
    /// The scanned frames that are to be drawn in its place, if they are there.
    pub scans: [Option<Wanted>; 2],
}

/// The actor's measures, from its first pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Height of the ground, metres.
    pub floor: f32,
    /// Height above the ground, metres.
    pub height: f32,
    /// Widest extent on the ground, metres.
    pub width: f32,
}

impl Measures {
    /// Of `pose`. The ground is at 0, where captures have it, unless the pose stands clearly elsewhere.
    #[must_use]
    pub fn of(pose: &[Vec3]) -> Self {
        let low = pose.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
        let high = pose.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
        if !(low.is_finite() && high.is_finite()) {
            return Self { floor: 0.0, height: 1.8, width: 1.0 };
        }
        let body = (high.y - low.y).max(1e-3);
        let floor = if low.y.abs() < 0.15 * body { 0.0 } else { low.y };
        let width = Vec2::new(high.x - low.x, high.z - low.z).length().max(1e-3);
        Self { floor, height: (high.y - floor).max(body * 0.5).max(width * 0.6), width }
    }

    /// What a camera frames where the actor stands as in `pose`.
    #[must_use]
    pub fn subject(&self, pose: &[Vec3]) -> Subject {
        let low = pose.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
        let high = pose.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
        let middle = (low + high) / 2.0;
        let ground = Vec2::new(middle.x, middle.z);
        Subject { ground, floor: self.floor, height: self.height, width: self.width }
    }
}

/// The scene on one device.
pub struct Scene {
    /// The device.
    pub gpu: Gpu,
    /// How it looks.
    pub look: Look,
    /// The mesh with its materials.
    pub mesh: Mesh,
    /// The texture that is rebuilt from modes, where the actor has one: from aligned ones, and from naive ones.
    pub looks: [Option<TextureRebuild>; 2],
    /// Poses shown translucent.
    pub ghosts: Ghosts,
    /// What tools mark on the ground.
    pub marks: Marks,
    /// The actor's measures.
    pub measures: Measures,
    /// Layout of pose groups.
    pub pose_layout: wgpu::BindGroupLayout,
    /// Triangles of the topology.
    pub triangles: Vec<[u32; 3]>,
    /// Scanned frames.
    pub scans: Scans,
    mix: Option<Mix>,
    frame: FrameGroup,
    actor: PoseGroup,
    shadow: Shadow,
    grid: Grid,
    trail: Trail,
    square: Square,
    shadow_due: bool,
    ground: Vec2,
}

impl Scene {
    /// Uploads what stays the same for all frames.
    #[must_use]
    pub fn new(gpu: Gpu, surface: &Surface, triangles: Vec<[u32; 3]>, first: &[Vec3]) -> Self {
        let frame = FrameGroup::new(&gpu);
        let pose_layout = pose_layout(&gpu);
        let actor = PoseGroup::new(&gpu, &pose_layout, first.len());
        let mesh = Mesh::new(&gpu, surface, &frame.layout, &pose_layout);
        let shadow = Shadow::new(&gpu, &frame.layout, &pose_layout);
        let grid = Grid::new(&gpu, &frame.layout, &shadow);
        let trail = Trail::new(&gpu, &frame.layout);
        let marks = Marks::new(&gpu, &frame.layout);
        let ghosts = Ghosts::new(&gpu, &frame.layout, &pose_layout);
        let measures = Measures::of(first);
        let square = Square::around([], measures.height);
        let look = Look::default();
        let ground = Vec2::ZERO;
        Self {
            gpu,
            look,
            mesh,
            looks: [None, None],
            ghosts,
            marks,
            measures,
            pose_layout,
            triangles,
            scans: Scans::default(),
            mix: None,
            frame,
            actor,
            shadow,
            grid,
            trail,
            square,
            shadow_due: true,
            ground,
        }
    }

    /// Uploads what changed in the actor.
    pub fn show(&mut self, moment: &Moment<'_>) {
        let [tint, parts] = [self.look.tint, self.look.parts].map(|on| f32::from(u8::from(on)));
        let uniform = ActorUniform { tint, synthetic: moment.synthetic, parts, ..Default::default() };
        let wanted = if self.look.parts { [None; 2] } else { moment.scans };
        let Moment { before, after, weight, .. } = *moment;
        let carrier = Carrier { triangles: &self.triangles, before, after, weight };
        let (scan, changed) = self.scans.show(&self.gpu, &self.pose_layout, wanted, carrier, uniform);
        // Beside a scan, which is that of the nearer frame, the mesh stands as that does.
        let weight = if scan.is_some() { weight.round() } else { weight };
        let uniform = ActorUniform { weight, ..uniform };
        let moved = self.actor.write(&self.gpu, &self.triangles, moment.before, moment.after, uniform);
        if moved || changed {
            let poses = [scan.as_deref().unwrap_or(moment.before.pose), scan.as_deref().unwrap_or(moment.after.pose)];
            self.square = Square::around(poses, self.measures.height);
            self.shadow_due = true;
        }
        self.ground = moment.ground;
    }

    /// Uploads the path walked so far, at the player's time `now`.
    pub fn show_trail<'a>(&mut self, points: impl IntoIterator<Item = &'a TrailPoint>, now: f64) {
        let strip = if self.look.path { ribbon(points, now, self.measures.height * 0.02) } else { Vec::new() };
        self.trail.write(&self.gpu, &strip);
    }

    /// Draws a picture of what `view` sees.
    pub fn draw(&mut self, view: &View, target: &Target) {
        let reach = self.measures.height * 4.2;
        let mut uniform = self.look.uniform(view, self.measures.floor, self.ground, reach);
        uniform.shadow_origin = self.square.origin.to_array();
        uniform.shadow_size = self.square.side;
        self.frame.write(&self.gpu, &uniform);
        let mut encoder = self.gpu.encoder("reprise.picture.commands");
        let layers = self.layers();
        if std::mem::take(&mut self.shadow_due) {
            let most = layers.iter().copied().reduce(|most, layer| if layer.1 > most.1 { layer } else { most });
            let own = (self.mesh.shape(), self.actor.group());
            let scan = most.and_then(|(scan, _)| self.scans.drawn(scan?));
            let (shape, pose) = scan.map_or(own, |(shape, pose, _)| (shape, pose));
            self.shadow.draw(&self.gpu, &mut encoder, &self.frame, pose, shape, self.square);
        }
        let mix = self.mix.take().filter(|mix| mix.fits(target));
        self.mix = if layers.len() > 1 { mix.or_else(|| Some(Mix::new(&self.gpu, target))) } else { mix };
        let mut covered = 0.0;
        for (number, &(layer, share)) in layers.iter().enumerate() {
            let over = self.mix.as_ref().filter(|_| number > 0);
            self.paint(&mut encoder, target, layer, over.map(|mix| (mix, covered / (covered + share))));
            covered += share;
            if let Some(mix) = self.mix.as_ref().filter(|_| number + 1 < layers.len()) {
                mix.keep(&mut encoder, target);
            }
        }
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// What is seen of the actor, and how much of each: the registered mesh (`None`), and scanned frames.
    fn layers(&self) -> Vec<(Option<usize>, f32)> {
        let shares = self.scans.shares();
        let rest = 1.0 - shares.iter().sum::<f32>();
        let scans = shares.into_iter().enumerate().map(|(number, share)| (Some(number), share));
        let layers: Vec<_> = std::iter::once((None, rest)).chain(scans).filter(|(_, share)| *share > 1e-3).collect();
        if layers.is_empty() { vec![(None, 1.0)] } else { layers }
    }

    /// Draws all, with the actor as `layer` says, and a share of what was kept over it.
    fn paint(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        layer: Option<usize>,
        over: Option<(&Mix, f32)>,
    ) {
        let mut pass = target.begin(&self.gpu, encoder, "reprise.picture.pass", self.look.clear());
        pass.set_bind_group(0, &self.frame.group, &[]);
        self.grid.draw(&mut pass, &self.shadow);
        self.marks.draw(&mut pass);
        self.trail.draw(&mut pass);
        match layer.and_then(|number| self.scans.drawn(number)) {
            Some((shape, pose, worn)) => {
                pass.set_bind_group(1, pose, &[]);
                self.mesh.draw_scan(&mut pass, shape, worn);
            }
            None => {
                pass.set_bind_group(1, self.actor.group(), &[]);
                self.mesh.draw(&mut pass);
            }
        }
        self.ghosts.draw(&mut pass, &self.mesh);
        if let Some((mix, share)) = over {
            mix.draw(&mut pass, share);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_find_the_ground() {
        let standing = [Vec3::new(-0.3, 0.02, 0.0), Vec3::new(0.3, 1.8, 0.0)];
        let measures = Measures::of(&standing);
        assert_eq!((measures.floor, measures.height), (0.0, 1.8));
        let elsewhere = standing.map(|p| p + Vec3::Y * 5.0);
        assert!((Measures::of(&elsewhere).floor - 5.02).abs() < 1e-5);
        assert_eq!(Measures::of(&[]).floor, 0.0);
    }
}
