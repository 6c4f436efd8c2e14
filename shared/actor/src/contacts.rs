//! What stands on the ground: the parts of the surface that rest on it for a while (soles, toes, hands), in every frame.
//!
//! Not in the papers, whose blends follow the centre of mass alone: where the feet of both sides stand elsewhere below it,
//! they slide while the weight moves from one to the other. [`crate::blend::Blend`] keeps still what stands in both.

use glam::Vec2;

use crate::timeline::Timeline;

/// Points are whole multiples of this many metres.
pub const POINT_STEP: f32 = 1.0 / 32768.0;
/// Weights are whole multiples of this.
pub const WEIGHT_STEP: f32 = 1.0 / 255.0;
/// Parts that are told apart at most.
pub const MOST_PARTS: usize = 8;

/// One part of the surface in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Where it is along (X, Z), in metres as the frame was recorded; a multiple of [`POINT_STEP`], zero where it does not
    /// stand.
    pub point: Vec2,
    /// How firmly it stands, from 0 (not at all) to 1; a multiple of [`WEIGHT_STEP`].
    pub weight: f32,
}

impl Contact {
    /// As it is stored.
    #[must_use]
    pub fn rounded(point: Vec2, weight: f32) -> Self {
        let weight = (weight.clamp(0.0, 1.0) / WEIGHT_STEP).round() * WEIGHT_STEP;
        if weight > 0.0 { Self { point: (point / POINT_STEP).round() * POINT_STEP, weight } } else { Self::default() }
    }
}

/// Which contacts a blend keeps still.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Held {
    /// All that stand on both sides, from node to node: the rule of actors packed before format 1.9, whose transitions were
    /// placed by it.
    Alike,
    /// The one that has least time to step; the others land where they have to.
    #[default]
    WhatCannotStep,
}

/// The contacts of all frames of a capture, of the same parts of the surface in the same order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    parts: usize,
    held: Held,
    /// Frame after frame.
    contacts: Vec<Contact>,
}

impl Contacts {
    /// Contacts of `parts` parts in every frame of `timeline`, frame after frame. `None` where their number is not that,
    /// or a number is not finite or out of its range.
    #[must_use]
    pub fn new(parts: usize, contacts: Vec<Contact>, timeline: &Timeline) -> Option<Self> {
        let holds = |contact: &Contact| contact.point.is_finite() && (0.0..=1.0).contains(&contact.weight);
        let fits = parts <= MOST_PARTS && contacts.len() == parts.checked_mul(timeline.frame_count() as usize)?;
        (fits && contacts.iter().all(holds)).then_some(Self { parts, held: Held::default(), contacts })
    }

    /// The same, by another rule.
    #[must_use]
    pub fn held(self, held: Held) -> Self {
        Self { held, ..self }
    }

    /// Whether they say where a transition leads, and not only how it goes on from node to node.
    #[must_use]
    pub fn steers(&self) -> bool {
        self.parts > 0 && self.held == Held::WhatCannotStep
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// The contacts of `frame`; none where nothing is known of it.
    #[must_use]
    pub fn of(&self, frame: u32) -> &[Contact] {
        let start = (frame as usize).saturating_mul(self.parts);
        self.contacts.get(start..start.saturating_add(self.parts)).unwrap_or_default()
    }
}

/// Which way the parts of [`Contacts`] point in every frame: what the builder needs to know beside where they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facings {
    parts: usize,
    /// Radians about +Y from a direction of the part's own, frame after frame.
    facings: Vec<f32>,
}

impl Facings {
    /// Facings of `parts` parts in radians about +Y, each from a direction of its own, frame after frame.
    #[must_use]
    pub fn new(parts: usize, facings: Vec<f32>) -> Self {
        Self { parts, facings }
    }

    /// Which way a part points in `frame`; 0 where nothing is known of it.
    #[must_use]
    pub fn of(&self, frame: u32, part: usize) -> f32 {
        let at = (frame as usize).saturating_mul(self.parts).saturating_add(part);
        if part < self.parts { self.facings.get(at).copied().unwrap_or(0.0) } else { 0.0 }
    }
}
