//! Rates, poses before the motion, and what is refused.

use super::*;

fn clip(xs: &[f32]) -> Result<Clip, ClipError> {
    let joints = vec![ClipJoint { name: "a".into(), parent: None }, ClipJoint { name: "b".into(), parent: Some(0) }];
    let stance = |&x: &f32| Stance {
        positions: vec![Vec3::ZERO, Vec3::new(x, 1.0, 0.0)],
        rotations: vec![Quat::from_rotation_y(x); 2],
    };
    Clip::new(joints, 10.0, xs.iter().map(stance).collect(), None)
}

#[test]
fn motion_between_frames_is_on_the_line() {
    let clip = clip(&[0.0, 1.0, 2.0]).unwrap();
    let twice = clip.resampled(20.0).unwrap();
    assert_eq!(twice.len(), 5);
    assert!((twice.positions(1)[1].x - 0.5).abs() < 1e-6);
    assert!(twice.rotations(3)[1].angle_between(Quat::from_rotation_y(1.5)) < 1e-3);
    assert_eq!(clip.resampled(10.0).unwrap(), clip);
    assert_eq!(clip.resampled(1e9), Err(ClipError::TooMany { what: "frames", count: 200_000_001, most: MOST_FRAMES }));
}

#[test]
fn what_is_no_clip_is_refused() {
    assert_eq!(clip(&[]), Err(ClipError::Empty("frame")));
    assert_eq!(clip(&[0.0, f32::NAN]), Err(ClipError::Position { frame: 1, joint: "a".into() }));
    assert_eq!(clip(&[1e20]), Err(ClipError::Position { frame: 0, joint: "b".into() }));
}

#[test]
fn a_pose_before_the_motion_is_seen() {
    assert!(clip(&[3.0, 0.0, 0.1, 0.2, 0.3]).unwrap().begins_with_pose());
    assert!(!clip(&[0.0, 0.1, 0.2, 0.3, 0.4]).unwrap().begins_with_pose());
}
