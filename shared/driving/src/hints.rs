//! What names of joints say: a hint where the skeleton's shape leaves a choice.

use crate::role::Role;

/// Which side a name says: left is 0, right 1.
#[must_use]
pub fn side(name: &str) -> Option<usize> {
    let lower = name.to_ascii_lowercase();
    if lower.contains("left") || lower.contains("right") {
        return Some(usize::from(lower.contains("right")));
    }
    let words = lower.split(|c: char| !c.is_ascii_alphanumeric());
    if let Some(word) = words.rev().find(|word| matches!(*word, "l" | "r")) {
        return Some(usize::from(word == "r"));
    }
    // "lfemur", "RHipJoint", "L_Thigh".
    let part = BODY.iter().filter_map(|word| lower.find(word)).min()?;
    match lower[..part].bytes().last() {
        Some(b'l') => Some(0),
        Some(b'r') => Some(1),
        _ => None,
    }
}

const BODY: [&str; 17] = [
    "hip", "femur", "thigh", "upleg", "knee", "tibia", "shin", "calf", "ankle", "foot", "toe", "humerus", "arm",
    "elbow", "radius", "wrist", "hand",
];

/// Whether `name` is of a part that helps animators and is none of the body: its targets and controls.
#[must_use]
pub fn is_helper(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    let has = ["control", "ctrl", "pole", "target", "slot"].iter().any(|word| lower.contains(word));
    has || name.contains("IK") || lower.split(|c: char| !c.is_ascii_alphabetic()).any(|word| word == "ik")
}

/// Whether `name` is of an arm or a hand.
#[must_use]
pub fn is_arm(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    ["arm", "hand", "finger", "palm", "wrist", "thumb", "elbow", "humerus"].iter().any(|word| lower.contains(word))
        && !lower.contains("armature")
}

/// How well `name` fits `role`, whatever the side: 1 where it says it, -1 where it says something else.
#[must_use]
pub fn fit(name: &str, role: Role) -> f32 {
    let lower = name.to_ascii_lowercase();
    let has = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    let (yes, no): (&[&str], &[&str]) = match role {
        Role::HipL | Role::HipR => (&["hip", "femur", "thigh", "upleg", "upperleg"], &["knee", "joint"]),
        Role::KneeL | Role::KneeR => (&["knee", "tibia", "shin", "calf", "leg"], &["upleg", "upperleg", "hip"]),
        Role::AnkleL | Role::AnkleR => (&["ankle", "foot"], &["toe", "ball"]),
        Role::BallL | Role::BallR => (&["toe", "ball"], &[]),
        Role::ShoulderL | Role::ShoulderR => (&["humerus", "arm", "shoulder"], &["clav", "collar", "fore", "lowerarm"]),
        Role::ElbowL | Role::ElbowR => (&["elbow", "radius", "forearm", "lowerarm"], &["twist"]),
        Role::WristL | Role::WristR => (&["wrist", "hand"], &["finger", "thumb"]),
        Role::Head => (&["head"], &["end", "top", "site"]),
        Role::Pelvis | Role::Chest => (&[], &[]),
    };
    if has(no) {
        -1.0
    } else if has(yes) {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_usual_names() {
        let left = ["lfemur", "LeftUpLeg", "thigh_l", "upperarm.l", "LHipJoint", "mixamorig:LeftArm", "L_Foot"];
        let right = ["rtibia", "RightHand", "Bip01 R Calf", "hand_r", "rhumerus"];
        left.iter().for_each(|name| assert_eq!(side(name), Some(0), "{name}"));
        right.iter().for_each(|name| assert_eq!(side(name), Some(1), "{name}"));
        ["root", "lowerback", "Spine", "head"].iter().for_each(|name| assert_eq!(side(name), None, "{name}"));
    }
}
