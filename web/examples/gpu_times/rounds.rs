//! Draws the same moments over and over, one kind of work a round, and takes the times of every pass.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use bundle::Textures;
use web::camera::Camera;
use web::gpu::appearance::{Setting, TextureRebuild, Wanted};
use web::gpu::scene::Scene;
use web::gpu::target::Target;

use crate::moments::{Moment, Walk, milliseconds};
use crate::open::Opened;
use crate::options::Options;

/// Fewest frames before those that count, and the part of a round's time that they take: pipelines are compiled, buffers
/// made, and the device has left its idle clock.
const WARM_UP: (usize, u32) = (3, 20);
/// Fewest frames that a median is taken of, unless fewer are asked for.
const FEWEST: usize = 10;

/// Which clock a time was taken with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The GPU's, at the beginning and the end of a pass.
    Gpu,
    /// The processor's, until the call came back.
    Processor,
    /// The processor's, until the GPU had done all of it.
    Wall,
}

/// Times of one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What took so long: the label of a pass, or what it says.
    pub name: &'static str,
    /// Which clock says so.
    pub clock: Clock,
    /// Milliseconds, one for each frame.
    pub times: Vec<f64>,
}

/// Times of the frames of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// How the texture is rebuilt; `None` for pictures.
    pub setting: Option<Setting>,
    /// Passes in the order in which they run, then what holds for all of them.
    pub rows: Vec<Row>,
}

/// A round for each setting, where the actor has modes, and one of pictures.
///
/// # Errors
/// A device that was lost, or that refuses what the page asks of it.
pub fn rounds(walk: &Walk, opened: &Opened, options: &Options) -> Result<Vec<Round>> {
    let mut stage = PageTwin::new(walk, opened, options)?;
    let mut rounds = Vec::new();
    if walk.moments.iter().all(|moment| moment.weights.is_some()) {
        for setting in Setting::ALL {
            rounds.push(stage.round(walk, options, Some(setting))?);
        }
    }
    rounds.push(stage.round(walk, options, None)?);
    Ok(rounds)
}

/// What the page's stage has, without a canvas.
struct PageTwin<'a> {
    opened: &'a Opened,
    scene: Scene,
    target: Target,
    camera: Camera,
}

impl<'a> PageTwin<'a> {
    fn new(walk: &Walk, opened: &'a Opened, options: &Options) -> Result<Self> {
        let (gpu, player) = (&opened.gpu, &walk.player);
        let actor = player.actor().context("the bundle has no actor")?;
        let reference = player.reference_pose();
        let triangles = actor.topology.triangles().to_vec();
        let mut scene = Scene::new(gpu.clone(), &actor.surface, triangles, reference);
        if let Some(appearance) = player.appearance(Textures::Aligned) {
            let mut looks = TextureRebuild::new(gpu, appearance, scene.mesh.textures(), false, milliseconds);
            looks.take(gpu, player.modes(Textures::Aligned));
            scene.looks[Textures::Aligned as usize] = Some(looks);
        }
        scene.show_trail(player.trail(), player.played());
        let mut camera = Camera::new(scene.measures.subject(reference));
        camera.set_aspect(options.size[0] as f32 / options.size[1] as f32);
        Ok(Self { opened, target: Target::new(gpu, options.size), scene, camera })
    }

    fn round(&mut self, walk: &Walk, options: &Options, setting: Option<Setting>) -> Result<Round> {
        let mut moments = walk.moments.iter().cycle();
        let mut frames = |fewest: usize, most: usize, time: Duration| -> Result<Vec<Row>> {
            let (mut rows, start) = (Vec::new(), Instant::now());
            for (done, moment) in moments.by_ref().take(most).enumerate() {
                if done >= fewest && start.elapsed() > time {
                    break;
                }
                self.frame(moment, setting, &mut rows)?;
            }
            Ok(rows)
        };
        frames(WARM_UP.0, usize::MAX, options.time / WARM_UP.1)?;
        Ok(Round { setting, rows: frames(FEWEST, options.frames, options.time)? })
    }

    /// Draws `moment`, or rebuilds its texture, and waits until the GPU has: one rebuild is under way at a time on the
    /// page, too.
    fn frame(&mut self, moment: &Moment, setting: Option<Setting>, rows: &mut Vec<Row>) -> Result<()> {
        let start = Instant::now();
        match setting {
            Some(setting) => self.rebuild(moment, setting)?,
            None => {
                self.scene.show(&moment.on_stage());
                note(rows, "pose: normals and upload", Clock::Processor, start.elapsed().as_secs_f64() * 1e3);
                self.camera.follow(moment.ground);
                self.camera.step(1.0 / 60.0);
                self.scene.draw(&self.camera.view(), &self.target);
            }
        }
        let gpu = &self.opened.gpu;
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the device does not finish")?;
        let wall = start.elapsed().as_secs_f64() * 1e3;
        if gpu.lost() {
            bail!("{} was lost, or refused what it was asked", self.opened.adapter.name);
        }
        if let Some(stopwatch) = &self.opened.stopwatch {
            let mut frame: Vec<(&'static str, f64)> = Vec::new();
            for lap in stopwatch.laps(&gpu.device, &gpu.queue)? {
                let milliseconds = lap.nanoseconds / 1e6;
                match frame.iter_mut().find(|(name, _)| *name == lap.name) {
                    Some((_, sum)) => *sum += milliseconds,
                    None => frame.push((lap.name, milliseconds)),
                }
            }
            if frame.is_empty() {
                return Ok(());
            }
            frame.push(("all of these", frame.iter().map(|(_, time)| time).sum()));
            frame.into_iter().for_each(|(name, time)| note(rows, name, Clock::Gpu, time));
        }
        note(rows, "from the first command to the end", Clock::Wall, wall);
        Ok(())
    }

    fn rebuild(&mut self, moment: &Moment, setting: Setting) -> Result<()> {
        let scene = &mut self.scene;
        let looks = scene.looks[Textures::Aligned as usize].as_mut().zip(moment.weights.as_ref());
        let (looks, weights) = looks.context("the actor has no modes")?;
        looks.keep(Some(setting));
        let wanted = Wanted::Interpolated(weights.clone());
        if looks.show(&scene.gpu, &mut scene.mesh, wanted.clone()) {
            return Ok(());
        }
        // An actor that stands still has one texture, which is not made twice unless it was taken off.
        looks.take_off();
        if looks.show(&scene.gpu, &mut scene.mesh, wanted) { Ok(()) } else { bail!("the texture was not rebuilt") }
    }
}

fn note(rows: &mut Vec<Row>, name: &'static str, clock: Clock, time: f64) {
    match rows.iter_mut().find(|row| row.name == name) {
        Some(row) => row.times.push(time),
        None => rows.push(Row { name, clock, times: vec![time] }),
    }
}
