//! The estimated rig against the skeleton that moved the surface, where that is known.

use actor::capture::Capture;
use editing::Rig;

use crate::document::{Cell, Table};
use crate::truth::Truth;

/// Bones that begin in a joint of the truth of the same name, and the mark in millimetres.
const JOINTS: [(&str, f64); 10] = [
    ("foot_l", 10.0),
    ("foot_r", 10.0),
    ("shin_l", 10.0),
    ("shin_r", 10.0),
    ("thigh_l", 30.0),
    ("thigh_r", 30.0),
    ("upper_arm_l", 30.0),
    ("upper_arm_r", 30.0),
    ("forearm_l", 30.0),
    ("forearm_r", 30.0),
];

/// How far each joint is off on average, and whether all marks are met; `None` where the rig is no human's.
pub fn against_truth(capture: &Capture, rig: &Rig, truth: &Truth) -> Option<(Table, bool)> {
    let columns = ["joint", "off mm", "most mm", "mark mm", "met"];
    let caption = "Joints of the rig against those of the skeleton that moved the surface, over all frames";
    let mut table = Table::new("editing_rig", caption, &columns);
    let bones: Option<Vec<usize>> =
        JOINTS.iter().map(|(name, _)| rig.bones().iter().position(|bone| bone.name == *name)).collect();
    let bones = bones?;
    let count = capture.poses.len();
    let mut offs = vec![Vec::with_capacity(count); bones.len()];
    for (frame, pose) in capture.poses.iter().enumerate() {
        let joints = rig.joints(&rig.fit(pose));
        for ((off, &bone), (name, _)) in offs.iter_mut().zip(&bones).zip(JOINTS) {
            off.push(1e3 * f64::from(joints[bone].distance(truth.position(frame, name)?)));
        }
    }
    let mut all = true;
    for (off, (name, mark)) in offs.iter().zip(JOINTS) {
        let mean = off.iter().sum::<f64>() / count.max(1) as f64;
        all &= mean <= mark;
        table.rows.push(vec![
            name.into(),
            Cell::Number(mean, 1),
            Cell::Number(off.iter().copied().fold(0.0, f64::max), 1),
            Cell::Number(mark, 0),
            if mean <= mark { "yes" } else { "no" }.into(),
        ]);
    }
    Some((table, all))
}
