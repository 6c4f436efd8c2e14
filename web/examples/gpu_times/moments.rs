//! What the player shows of an actor that plays on, moment by moment: the same for every round.

use std::path::Path;
use std::rc::Rc;
use std::sync::OnceLock;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use bundle::Textures;
use glam::{Vec2, Vec3};
use web::gpu::appearance::Weights;
use web::gpu::pose::Numbered;
use web::gpu::scene;
use web::player::Player;
use web::player::loading::Loading;
use web::player::produce::ShownFrame;

/// Seconds between two pictures: those of a usual display.
const STEP: f64 = 1.0 / 60.0;

/// Most moments that are kept, poses and all; rounds of more frames begin again.
const MOST: usize = 600;

/// The player, and what it showed.
pub struct Walk {
    /// The player, after the last moment.
    pub player: Player,
    /// Moments, in order.
    pub moments: Vec<Moment>,
}

/// What a picture shows.
pub struct Moment {
    before: Rc<Posed>,
    after: Rc<Posed>,
    weight: f32,
    synthetic: f32,
    /// Where the actor is on the ground (X, Z), metres.
    pub ground: Vec2,
    /// Weights of the texture's colours and warps, where the bundle has modes.
    pub weights: Option<Weights>,
}

/// A frame's pose, kept once for all moments beside it.
struct Posed {
    number: u64,
    pose: Vec<Vec3>,
}

impl Posed {
    fn numbered(&self) -> Numbered<'_> {
        Numbered { number: self.number, pose: &self.pose }
    }
}

impl Moment {
    /// As the stage is given it.
    pub fn on_stage(&self) -> scene::Moment<'_> {
        scene::Moment {
            before: self.before.numbered(),
            after: self.after.numbered(),
            weight: self.weight,
            synthetic: self.synthetic,
            ground: self.ground,
            scans: [None; 2],
        }
    }
}

/// Loads the bundle at `path` and lets its actor play on for `count` pictures, at most ten seconds of them.
///
/// # Errors
/// A file that cannot be read, or a bundle that is not whole.
pub fn walk(path: &Path, count: usize) -> Result<Walk> {
    let name = path.display();
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {name}"))?;
    let mut player = Player::new(Loading::default(), milliseconds);
    player.push(&bytes).with_context(|| format!("{name} is not a bundle that can be shown"))?;
    player.loading().finish().with_context(|| format!("{name} is not whole"))?;
    while player.refine(f64::INFINITY).with_context(|| format!("{name}: its textures cannot be read"))? {}
    player.play();
    let mut moments: Vec<Moment> = Vec::new();
    for _ in 0..count.min(MOST) {
        player.tick(STEP);
        let Some(moment) = moment(&player, moments.last()) else { bail!("{name} has no pose") };
        moments.push(moment);
    }
    Ok(Walk { player, moments })
}

fn moment(player: &Player, last: Option<&Moment>) -> Option<Moment> {
    let picture = player.picture()?;
    let posed = |frame: &ShownFrame| {
        let known = last.map(|last| [&last.before, &last.after]).into_iter().flatten();
        let same = known.filter(|posed| posed.number == frame.number).map(Rc::clone).next();
        same.unwrap_or_else(|| Rc::new(Posed { number: frame.number, pose: frame.pose.clone() }))
    };
    let appearance = player.appearance(Textures::Aligned);
    let modes = player.modes(Textures::Aligned);
    Some(Moment {
        before: posed(picture.before),
        after: posed(picture.after),
        weight: picture.weight as f32,
        synthetic: picture.synthetic(),
        ground: picture.ground(),
        weights: appearance
            .filter(|_| !modes[0].is_empty())
            .map(|appearance| [0, 1].map(|layer| picture.weights(&appearance.layers[layer]))),
    })
}

/// The player's clock.
pub fn milliseconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64() * 1000.0
}
