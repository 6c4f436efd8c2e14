//! Which frame is drawn by what, and what is fetched ahead.

use actor::files::Files;
use bundle::{BundleInput, Extras, ScannedCorner, ScannedFrames, ScannedGroup, code_group, encode_with_extras};
use glam::{Vec2, Vec3};
use synthesis::FrameKind;

use super::loading::{Loading, Phase};
use super::scanned::ScanShown;
use super::tests::capture;
use super::{Player, PlayerError};
use crate::brought::Brought;

/// Two sequences, of which frame 7 was lost and frames 20 and 21 are one mesh; a transition leads from 4 to 26.
fn bundle() -> Vec<u8> {
    let (capture, graph) = capture(&[(20, false), (12, false)], &[(4, 26)]);
    let mut scanned = ScannedFrames::default();
    let mut frame = 0;
    while frame < 32 {
        let count = if frame == 20 { 2 } else { 1 };
        let poses = (frame..frame + count).map(|frame| capture.poses.frame(frame).to_vec()).collect();
        let corners = (0..4).map(|vertex| ScannedCorner { vertex, uv: [0.0; 2] }).collect();
        let triangles = capture.topology.triangles().to_vec();
        let group = ScannedGroup { first_frame: frame, corners, triangles, poses, ..ScannedGroup::default() };
        if frame != 7 {
            scanned.push(code_group(&group, 1e-4).unwrap());
        }
        frame += count;
    }
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    let mut extras = Extras::default();
    extras.scanned = Some(&scanned);
    encode_with_extras(&input, &[], &Files::default(), &extras).unwrap().0
}

/// A player that has got all but the groups.
fn player() -> (Player, Vec<u8>) {
    let bytes = bundle();
    let mut player = Player::new(Loading::default(), || 0.0);
    player.push(&bytes[..2000.min(bytes.len() / 2)]).unwrap();
    let (start, _) = player.scan_section(0).unwrap();
    let mut player = Player::new(Loading::default(), || 0.0);
    player.push(&bytes[..start as usize - 1]).unwrap();
    assert_ne!(player.loading().phase(), Phase::Complete);
    player.push(&bytes[start as usize - 1..start as usize]).unwrap();
    assert_eq!(player.loading().phase(), Phase::Complete);
    player.loading().finish().unwrap();
    (player, bytes)
}

/// The frame that is shown as it was scanned.
fn scan_of(player: &Player) -> Option<u32> {
    stands(player).map(|scan| scan.frame)
}

fn stands(player: &Player) -> Option<ScanShown> {
    player.scan()[0].filter(|scan| matches!(scan.brought, Brought::Placed(..)))
}

/// The frame that the changed mesh of the same frame carries.
fn changed(player: &Player) -> Option<u32> {
    let scan = player.scan()[0].filter(|scan| matches!(scan.brought, Brought::Changed(_)))?;
    Some(scan.frame)
}

/// Frames that the registered mesh carries, and how much is seen of each.
fn carried(player: &Player) -> Vec<(u32, f32)> {
    let carried = player.scan().into_iter().flatten().filter(|scan| scan.brought == Brought::Blended);
    carried.map(|scan| (scan.frame, scan.share)).collect()
}

#[test]
fn recorded_frames_are_shown_as_scanned_where_they_stand() {
    let (mut player, bytes) = player();
    player.stand(5, Vec2::new(2.0, -1.0), 0.7).unwrap();
    let scan = stands(&player).unwrap();
    assert_eq!((scan.frame, scan.place), (5, (5, 0)));
    // The scan, moved as the registered pose is, lies on it: here both are the same body.
    let (start, length) = player.scan_section(5).unwrap();
    let section = &bytes[start as usize..(start + length) as usize];
    let words: Vec<u32> = player.scans().unwrap().groups[5].words().collect();
    assert_eq!(player.scan_head(5, section).unwrap(), words);
    let mut pose = player.scans().unwrap().read(5, section).unwrap().poses.remove(0);
    let Brought::Placed(_, placement) = scan.brought else { panic!("{scan:?}") };
    placement.apply_all(&mut pose);
    let shown = player.picture().unwrap().pose();
    let near = |p: &Vec3| shown.iter().any(|q| p.distance(*q) < 5e-4);
    assert!(pose.iter().all(near), "{pose:?} {shown:?}");
    assert!(player.scan_head(5, &section[1..]).is_err());
    // A lost frame, and one of a group.
    player.seek(7.0).unwrap();
    assert_eq!(scan_of(&player), None);
    player.seek(21.0).unwrap();
    assert_eq!(stands(&player).map(|scan| scan.place), Some((19, 1)));
    // Between two frames the nearer one is shown.
    player.seek(10.25).unwrap();
    assert_eq!(scan_of(&player), Some(10));
    player.seek(10.75).unwrap();
    assert_eq!(scan_of(&player), Some(11));
}

#[test]
fn what_is_edited_carries_its_scan_what_is_driven_shows_the_mesh_and_transitions_carry_both_ends() {
    let (mut player, _) = player();
    player.seek(5.0).unwrap();
    let pose = player.recorded_pose(5).unwrap();
    player.set_edited(5, Some(pose.clone())).unwrap();
    assert_eq!((scan_of(&player), changed(&player)), (None, Some(5)));
    player.set_edited(5, None).unwrap();
    assert_eq!((scan_of(&player), changed(&player)), (Some(5), None));
    // Through the transition: its nodes are made, all frames before and behind are scanned.
    player.seek(0.0).unwrap();
    player.go_to(30).unwrap();
    let (mut made, mut scanned, mut lambda) = (0, 0, 0.0);
    while player.playing() {
        player.tick(1.0 / 100.0);
        let picture = player.picture().unwrap();
        let nearer = if picture.weight < 0.5 { picture.before } else { picture.after };
        match nearer.kind {
            FrameKind::Recorded { frame } => {
                scanned += 1;
                assert_eq!((scan_of(&player), stands(&player).unwrap().share), (Some(frame), 1.0));
                assert!(carried(&player).is_empty());
            }
            FrameKind::Synthetic { .. } => {
                made += 1;
                let [(from, less), (to, more)] = carried(&player)[..] else { panic!("{:?}", player.scan()) };
                assert!((from, to) == (4, 26) && (less + more - 1.0).abs() < 1e-6 && more >= lambda);
                lambda = more;
            }
        }
    }
    assert!(made > 2 && scanned > 10 && lambda > 0.6, "{made} {scanned} {lambda}");
    // Where an end was edited, its scan is carried as well.
    player.seek(4.0).unwrap();
    player.set_edited(26, Some(pose.clone())).unwrap();
    player.go_to(30).unwrap();
    while !player.nearer().unwrap().kind.is_synthetic() {
        player.tick(1.0 / 100.0);
    }
    assert!(matches!(carried(&player)[..], [(4, _), (26, _)]), "{:?}", player.scan());
    player.set_edited(26, None).unwrap();
    player.cancel();
    while player.playing() && player.nearer().unwrap().kind.is_synthetic() {
        player.tick(1.0 / 100.0);
    }
    // A clip's frames are none of the actor's own, whatever they look like.
    player.expect(3, kernels::align::Placement::IDENTITY, 1).unwrap();
    player.give(pose, [3, 3], 0.0, 0.0);
    player.tick(1.0 / 20.0);
    while player.picture().unwrap().after.kind.frame() != 3 {
        player.tick(1.0 / 100.0);
    }
    assert_eq!(player.scan()[0].filter(|scan| scan.frame == 3), None);
}

#[test]
fn what_comes_next_is_fetched_first() {
    let (mut player, _) = player();
    player.seek(2.0).unwrap();
    // As many as are held; a frame that was lost is passed over.
    let ahead = player.scans_ahead();
    assert_eq!(ahead.len(), 16);
    assert_eq!(ahead[..7], [2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(player.scans().unwrap().groups[7].first_frame, 8);
    // On a walk through the transition from frame 4 to 26: what lies behind is not wanted.
    player.go_to(30).unwrap();
    let frames: Vec<u32> =
        player.scans_ahead().iter().map(|&group| player.scans().unwrap().groups[group as usize].first_frame).collect();
    assert_eq!(frames[..3], [2, 3, 4]);
    assert!(frames.contains(&30) && !frames.contains(&12), "{frames:?}");
    assert_eq!(player.scan_section(99), None);
    assert_eq!(player.seek(3.0), Ok::<(), PlayerError>(()));
}

/// All shares while the player plays, a twentieth of a frame's time after the other: of what stands, and of what is carried.
fn shares(player: &mut Player) -> Vec<[f32; 2]> {
    let mut shares = Vec::new();
    for _ in 0..2000 {
        if !player.playing() {
            break;
        }
        let all: f32 = carried(player).iter().map(|(_, share)| share).sum();
        shares.push([stands(player).map_or(0.0, |scan| scan.share), all]);
        player.tick(1.0 / 25.0 / 20.0);
        let _ = player.take_events();
    }
    shares
}

#[test]
fn a_scan_gives_way_little_by_little() {
    let (mut player, _) = player();
    // Frame 7 was lost: the mesh comes before it and goes after it.
    player.seek(0.0).unwrap();
    player.play();
    let mut seen = Vec::new();
    while player.nearer().unwrap().kind.frame() < 14 {
        seen.push(stands(&player).map_or(0.0, |scan| scan.share));
        player.tick(1.0 / 25.0 / 20.0);
    }
    assert!(seen.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02), "{seen:?}");
    assert!(seen.contains(&0.0) && seen.contains(&1.0), "{seen:?}");
    // Frames that were edited need no such thing.
    let pose = player.recorded_pose(17).unwrap();
    player.set_edited(17, Some(pose)).unwrap();
    while player.nearer().unwrap().kind.frame() < 18 {
        let frame = player.nearer().unwrap().kind.frame();
        let shown = player.scan()[0].unwrap();
        assert_eq!((shown.frame, shown.share), (frame, if frame > 13 { 1.0 } else { shown.share }));
        player.tick(1.0 / 25.0 / 20.0);
    }
    // Where it stands nothing is mixed, nor where it was set down.
    player.pause();
    player.seek(6.0).unwrap();
    assert_eq!(stands(&player).map(|scan| scan.share), Some(1.0));
    player.play();
    assert!(stands(&player).unwrap().share < 0.2);
}

#[test]
fn transitions_carry_scans_so_that_nothing_has_to_give_way() {
    let (mut player, _) = player();
    // On the way back from 14 to the transition at 4 lies the lost frame; from 0 there is none.
    player.seek(0.0).unwrap();
    player.go_to(30).unwrap();
    let seen = shares(&mut player);
    assert!(seen.iter().all(|&[stands, carried]| (stands + carried - 1.0).abs() < 1e-5), "{seen:?}");
    assert!(seen.iter().filter(|[stands, _]| *stands == 0.0).count() > 10, "{seen:?}");
}

#[test]
fn nothing_pops_where_nobody_foresaw_the_transition() {
    let (mut player, _) = player();
    player.seek(0.0).unwrap();
    player.play();
    while player.nearer().unwrap().kind.frame() < 4 {
        player.tick(1.0 / 100.0);
    }
    // It leaves with the very next frame.
    player.go_to(30).unwrap();
    let seen = shares(&mut player);
    assert!(seen.iter().all(|&[stands, carried]| (stands + carried - 1.0).abs() < 1e-5), "{seen:?}");
}

#[test]
fn other_actors_have_none() {
    let (capture, graph) = capture(&[(20, false)], &[]);
    let player = Player::of_capture(capture, graph);
    assert!(player.scans().is_none() && player.scan() == [None; 2] && player.scans_ahead().is_empty());
    assert_eq!(player.scan_section(0), None);
}
