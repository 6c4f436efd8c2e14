//! What a joint of a skeleton is in a human body.

use serde::{Deserialize, Serialize};

/// A joint of a human body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Where both legs hang.
    Pelvis,
    /// Where both arms hang.
    Chest,
    /// What the head turns with.
    Head,
    /// The left leg's first joint.
    HipL,
    /// The left knee.
    KneeL,
    /// The left ankle.
    AnkleL,
    /// Where the left foot's toes begin.
    BallL,
    /// The right leg's first joint.
    HipR,
    /// The right knee.
    KneeR,
    /// The right ankle.
    AnkleR,
    /// Where the right foot's toes begin.
    BallR,
    /// The left upper arm's first joint.
    ShoulderL,
    /// The left elbow.
    ElbowL,
    /// The left wrist.
    WristL,
    /// The right upper arm's first joint.
    ShoulderR,
    /// The right elbow.
    ElbowR,
    /// The right wrist.
    WristR,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::Pelvis,
        Self::Chest,
        Self::Head,
        Self::HipL,
        Self::KneeL,
        Self::AnkleL,
        Self::BallL,
        Self::HipR,
        Self::KneeR,
        Self::AnkleR,
        Self::BallR,
        Self::ShoulderL,
        Self::ElbowL,
        Self::WristL,
        Self::ShoulderR,
        Self::ElbowR,
        Self::WristR,
    ];
    /// Hip, knee, ankle and ball of the left leg, and of the right one.
    pub const LEGS: [[Self; 4]; 2] =
        [[Self::HipL, Self::KneeL, Self::AnkleL, Self::BallL], [Self::HipR, Self::KneeR, Self::AnkleR, Self::BallR]];
    /// Shoulder, elbow and wrist of the left arm, and of the right one.
    pub const ARMS: [[Self; 3]; 2] =
        [[Self::ShoulderL, Self::ElbowL, Self::WristL], [Self::ShoulderR, Self::ElbowR, Self::WristR]];

    /// Its name in mapping files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pelvis => "pelvis",
            Self::Chest => "chest",
            Self::Head => "head",
            Self::HipL => "hip_l",
            Self::KneeL => "knee_l",
            Self::AnkleL => "ankle_l",
            Self::BallL => "ball_l",
            Self::HipR => "hip_r",
            Self::KneeR => "knee_r",
            Self::AnkleR => "ankle_r",
            Self::BallR => "ball_r",
            Self::ShoulderL => "shoulder_l",
            Self::ElbowL => "elbow_l",
            Self::WristL => "wrist_l",
            Self::ShoulderR => "shoulder_r",
            Self::ElbowR => "elbow_r",
            Self::WristR => "wrist_r",
        }
    }
}
