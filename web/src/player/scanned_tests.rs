//! Which frame is drawn by what, and what is fetched ahead.

use actor::files::Files;
use bundle::{BundleInput, Extras, ScannedCorner, ScannedFrames, ScannedGroup, code_group, encode_with_extras};
use glam::{Vec2, Vec3};
use synthesis::FrameKind;

use super::loading::{Loading, Phase};
use super::tests::capture;
use super::{Player, PlayerError};

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

fn scan_of(player: &Player) -> Option<u32> {
    player.scan().map(|scan| scan.frame)
}

#[test]
fn recorded_frames_are_shown_as_scanned_where_they_stand() {
    let (mut player, bytes) = player();
    player.stand(5, Vec2::new(2.0, -1.0), 0.7).unwrap();
    let scan = player.scan().unwrap();
    assert_eq!((scan.frame, scan.place), (5, (5, 0)));
    // The scan, moved as the registered pose is, lies on it: here both are the same body.
    let (start, length) = player.scan_section(5).unwrap();
    let section = &bytes[start as usize..(start + length) as usize];
    let words: Vec<u32> = player.scans().unwrap().groups[5].words().collect();
    assert_eq!(player.scan_head(5, section).unwrap(), words);
    let mut pose = player.scans().unwrap().read(5, section).unwrap().poses.remove(0);
    scan.placement.apply_all(&mut pose);
    let shown = player.picture().unwrap().pose();
    let near = |p: &Vec3| shown.iter().any(|q| p.distance(*q) < 5e-4);
    assert!(pose.iter().all(near), "{pose:?} {shown:?}");
    assert!(player.scan_head(5, &section[1..]).is_err());
    // A lost frame, and one of a group.
    player.seek(7.0).unwrap();
    assert_eq!(scan_of(&player), None);
    player.seek(21.0).unwrap();
    assert_eq!(player.scan().map(|scan| scan.place), Some((19, 1)));
    // Between two frames the nearer one is shown.
    player.seek(10.25).unwrap();
    assert_eq!(scan_of(&player), Some(10));
    player.seek(10.75).unwrap();
    assert_eq!(scan_of(&player), Some(11));
}

#[test]
fn what_is_edited_driven_or_synthesised_is_shown_on_the_registered_mesh() {
    let (mut player, _) = player();
    player.seek(5.0).unwrap();
    let pose = player.recorded_pose(5).unwrap();
    player.set_edited(5, Some(pose.clone())).unwrap();
    assert_eq!(scan_of(&player), None);
    player.set_edited(5, None).unwrap();
    assert_eq!(scan_of(&player), Some(5));
    // Through the transition: its nodes are made, all frames before and behind are scanned.
    player.seek(0.0).unwrap();
    player.go_to(30).unwrap();
    let (mut made, mut scanned) = (0, 0);
    while player.playing() {
        player.tick(1.0 / 100.0);
        let picture = player.picture().unwrap();
        let nearer = if picture.weight < 0.5 { picture.before } else { picture.after };
        match nearer.kind {
            FrameKind::Recorded { frame } => {
                scanned += 1;
                assert_eq!(scan_of(&player), Some(frame));
            }
            FrameKind::Synthetic { .. } => {
                made += 1;
                assert_eq!(scan_of(&player), None);
            }
        }
    }
    assert!(made > 2 && scanned > 10, "{made} {scanned}");
    // A clip's frames are none of the actor's own, whatever they look like.
    player.expect(3, kernels::align::Placement::IDENTITY, 1).unwrap();
    player.give(pose, [3, 3], 0.0, 0.0);
    player.tick(1.0 / 20.0);
    while player.picture().unwrap().after.kind.frame() != 3 {
        player.tick(1.0 / 100.0);
    }
    assert_eq!(scan_of(&player).filter(|&frame| frame == 3), None);
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

#[test]
fn a_scan_gives_way_little_by_little() {
    let (mut player, _) = player();
    player.seek(14.0).unwrap();
    player.go_to(30).unwrap();
    player.play();
    let (mut before, mut least, mut made) = (1.0, 1.0_f32, 0);
    let mut shares = Vec::new();
    for _ in 0..2000 {
        if !player.playing() {
            break;
        }
        let share = player.scan().map_or(0.0, |scan| scan.share);
        made += u32::from(player.scan().is_none());
        shares.push(share);
        // A twentieth of a frame's time.
        player.tick(1.0 / 25.0 / 20.0);
        let _ = player.take_events();
        least = least.min(share);
        assert!((share - before).abs() < 0.02, "{before} and then {share}");
        before = share;
    }
    assert!(least == 0.0 && made > 20, "{shares:?}");
    assert!(shares.contains(&1.0), "{shares:?}");
    // Where it stands nothing is mixed, nor where it was set down.
    player.pause();
    player.seek(6.0).unwrap();
    assert_eq!(player.scan().map(|scan| scan.share), Some(1.0));
    player.play();
    assert!(player.scan().unwrap().share < 0.2);
}

#[test]
fn other_actors_have_none() {
    let (capture, graph) = capture(&[(20, false)], &[]);
    let player = Player::of_capture(capture, graph);
    assert!(player.scans().is_none() && player.scan().is_none() && player.scans_ahead().is_empty());
    assert_eq!(player.scan_section(0), None);
}
