//! The page and a film of the same route show the same frames, bit for bit, however often its mind was changed on the way.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use actor::walk::Walk;
use bundle::BundleReader;
use fixtures::Random;
use glam::Vec3;
use job::Job;
use performer::{PerformerOptions, write_performer};
use reprise::pack::{PackOptions, pack};
use search::{main_component, plan_walk};
use synthesis::Synthesiser;
use web::player::Player;
use web::player::loading::Loading;
use web::player::produce::ShownFrame;

/// Seconds of a tick: half a frame of the performer's.
const TICK: f64 = 0.01;

/// What the page showed, and the routes it was given: after so many frames these walks.
#[derive(Default)]
struct Shown {
    frames: Vec<ShownFrame>,
    routes: Vec<(usize, Walk)>,
    turned_inside: usize,
}

impl Shown {
    /// Keeps what the page has made since.
    fn look(&mut self, player: &Player) {
        let picture = player.picture().unwrap();
        for frame in [picture.before, picture.after] {
            if self.frames.last().is_none_or(|last| last.number < frame.number) {
                self.frames.push(frame.clone());
            }
        }
    }

    fn route(&mut self, walk: Walk) {
        self.turned_inside += usize::from(self.frames.last().unwrap().kind.is_synthetic());
        self.routes.push((self.frames.len(), walk));
    }
}

/// Sends the actor of a bundle here and there, stops it, and looks at poses in between.
fn page(bytes: &[u8], start: u32, targets: &[u32]) -> Shown {
    let reader = BundleReader::from_bytes(bytes).unwrap();
    let (timeline, graph) = (reader.timeline().unwrap().clone(), reader.graph().unwrap().clone());
    let mut player = Player::new(Loading::default(), || 0.0);
    player.push(bytes).unwrap();
    player.seek(f64::from(start)).unwrap();
    let mut shown = Shown::default();
    shown.look(&player);
    // The pose that it stood in before.
    shown.frames.drain(..shown.frames.len() - 1);
    let mut random = Random::new(7);
    let some = |random: &mut Random| targets[random.below(targets.len())];
    for _ in 0..4000 {
        match random.below(120) {
            0 => {
                player.cancel();
                shown.route(Walk::default());
            }
            1..4 => {
                let to = some(&mut random);
                let from = player.leaves().unwrap().0;
                let mut walk = plan_walk(&graph, &timeline, from, &[to]).unwrap();
                if random.below(2) == 0 && !walk.legs.is_empty() {
                    walk.bend =
                        (0..walk.steps(&graph)).map(|step| [0.002, 0.003, -0.001].map(|a| a * step as f32)).collect();
                    player.follow(from, &walk).unwrap();
                } else {
                    assert_eq!(player.go_to(to).unwrap().cost, walk.cost);
                }
                shown.route(walk);
            }
            4..10 => {
                player.arrival(some(&mut random)).unwrap();
            }
            10 => player.pause(),
            11..20 if player.state().unwrap().target.is_some() => player.play(),
            _ => {}
        }
        player.tick(TICK);
        shown.look(&player);
    }
    shown
}

/// The same routes as a film.
fn film(bytes: &[u8], shown: &Shown) -> Vec<Vec<Vec3>> {
    let mut reader = BundleReader::from_bytes(bytes).unwrap();
    let (topology, timeline, graph) =
        (reader.topology().unwrap().clone(), reader.timeline().unwrap().clone(), reader.graph().unwrap().clone());
    let mut synthesiser = Synthesiser::new(&topology, reader.order()).unwrap();
    let first = &shown.frames[0];
    synthesiser.begin_walk(&graph, &timeline, (first.kind.frame(), first.placement), &Walk::default()).unwrap();
    let mut routes = shown.routes.iter().peekable();
    let mut frames: Vec<Vec<Vec3>> = Vec::new();
    for wanted in &shown.frames {
        while let Some((_, walk)) = routes.next_if(|(after, _)| *after == frames.len()) {
            synthesiser.retarget_bent(&graph, &timeline, &walk.legs, &walk.bend).unwrap();
        }
        let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
        let info = synthesiser.next_frame(&graph, &timeline, &mut reader, &mut pose).unwrap().unwrap();
        assert_eq!((info.kind, info.placement), (wanted.kind, wanted.placement), "frame {}", frames.len());
        frames.push(pose);
    }
    frames
}

#[test]
fn the_page_shows_what_a_film_shows() {
    let folder = tempfile::tempdir().unwrap();
    let small = PerformerOptions { frames: 300, vertices: 1_500, texture_size: 128, ..PerformerOptions::default() };
    write_performer(&small, folder.path(), &|_| {}).unwrap();
    let inputs = [folder.path().to_str().unwrap().to_owned()];
    let (bytes, _) = pack(&inputs, &PackOptions::default(), &Job::silent()).unwrap();
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let (timeline, graph) = (reader.timeline().unwrap(), reader.graph().unwrap());
    let main = main_component(graph, timeline).main;
    let targets: Vec<u32> = (0..).zip(&main).filter(|&(_, &main)| main).map(|(frame, _)| frame).step_by(7).collect();

    let shown = page(&bytes, targets[3], &targets);
    let film = film(&bytes, &shown);
    let bent = shown.routes.iter().filter(|(_, walk)| !walk.bend.is_empty()).count();
    assert!(bent > 5, "{bent} bent walks");
    let synthetic = shown.frames.iter().filter(|frame| frame.kind.is_synthetic()).count();
    assert!(synthetic > 200 && shown.turned_inside > 5, "{synthetic} nodes, {} turns inside", shown.turned_inside);
    // The pose that it was put in was moved there after it was placed: the same but for rounding.
    assert!(shown.frames[0].pose.iter().zip(&film[0]).all(|(a, b)| a.distance(*b) < 1e-6));
    for (step, (frame, filmed)) in shown.frames.iter().zip(&film).enumerate().skip(1) {
        let bits = |point: &Vec3| point.to_array().map(f32::to_bits);
        assert!(frame.pose.iter().map(bits).eq(filmed.iter().map(bits)), "frame {step}: {:?}", frame.kind);
    }
}
