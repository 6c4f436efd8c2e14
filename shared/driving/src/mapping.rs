//! Which joint of a clip is which of a human body: from the skeleton's shape and how it stands, names as hints.
//!
//! The ends of the skeleton say what is what: the two lowest that are equally far from where they meet are feet, of the others
//! two that are alike hang from arms, and the highest is the head. On each way the joints are taken that divide it as human
//! limbs are divided (shares of the height: Drillis and Contini 1966). Left is to the left of where the feet point.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::clip::Clip;
use crate::find::{above as add_above, found, four_legs};
use crate::role::Role;

/// Joints of a clip by what they are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mapping {
    joints: BTreeMap<Role, usize>,
}

/// A mapping as files have it: the name of the joint for each role.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MappingFile {
    /// Names of joints; "" where the skeleton has none.
    #[serde(default)]
    pub joints: BTreeMap<Role, String>,
}

/// Why joints cannot be told.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MappingError {
    /// No two legs.
    #[error(
        "the skeleton has no two legs that can be told: say in a mapping file (--mapping) which joints pelvis, hip_l, knee_l, ankle_l and \
         those of the right leg are; {0} is missing"
    )]
    NoLegs(&'static str),
    /// A body on four legs.
    #[error(
        "the skeleton stands on four legs ({hand:?} is one beside {foot:?}): only what walks on two can drive an actor; where it does, say which \
         joint is which (--mapping)"
    )]
    FourLegs {
        /// The end of one that is none of the two that were found.
        hand: String,
        /// The end of one of those.
        foot: String,
    },
    /// A joint that the skeleton lacks.
    #[error("{role}: the skeleton has no joint {name:?}; it has: {known}")]
    Unknown {
        /// What it should be.
        role: &'static str,
        /// Its name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// One joint for two roles.
    #[error("{first} and {second} are both {name:?}")]
    Twice {
        /// A role.
        first: &'static str,
        /// Another one.
        second: &'static str,
        /// The joint.
        name: String,
    },
}

impl Mapping {
    /// The joint of `role`; `None` where the skeleton has none.
    #[must_use]
    pub fn joint(&self, role: Role) -> Option<usize> {
        self.joints.get(&role).copied()
    }

    /// What is found in `clip`, and as `file` says otherwise.
    ///
    /// # Errors
    /// A skeleton without two legs, or with four, names that it lacks.
    pub fn of(clip: &Clip, file: &MappingFile) -> Result<Self, MappingError> {
        // Whoever names both legs knows better: what is above them is found from there.
        let legs = Role::LEGS.iter().flat_map(|leg| &leg[..3]).chain([&Role::Pelvis]);
        let legs_are_named = legs.into_iter().all(|role| file.joints.get(role).is_some_and(|name| !name.is_empty()));
        let mut mapping = Self { joints: if legs_are_named { BTreeMap::new() } else { found(clip) } };
        for (&role, name) in &file.joints {
            mapping.joints.remove(&role);
            if name.is_empty() {
                continue;
            }
            let Some(joint) = clip.joints().iter().position(|joint| joint.name == *name) else {
                let known: Vec<&str> = clip.joints().iter().take(100).map(|joint| joint.name.as_str()).collect();
                return Err(MappingError::Unknown { role: role.name(), name: name.clone(), known: known.join(", ") });
            };
            mapping.joints.insert(role, joint);
        }
        if legs_are_named {
            let mut above = mapping.joints.clone();
            add_above(clip, &mut above);
            above.retain(|role, _| !file.joints.contains_key(role));
            mapping.joints.append(&mut above);
        }
        mapping.check(clip)?;
        let name = |joint: usize| clip.joints()[joint].name.clone();
        match four_legs(clip) {
            Some((hand, foot)) if file.joints.is_empty() => {
                Err(MappingError::FourLegs { hand: name(hand), foot: name(foot) })
            }
            _ => Ok(mapping),
        }
    }

    /// The names of what was found.
    #[must_use]
    pub fn file(&self, clip: &Clip) -> MappingFile {
        let name = |role: Role| self.joint(role).map_or(String::new(), |joint| clip.joints()[joint].name.clone());
        MappingFile { joints: Role::ALL.iter().map(|&role| (role, name(role))).collect() }
    }

    /// Roles that the skeleton has no joint for.
    #[must_use]
    pub fn missing(&self) -> Vec<Role> {
        Role::ALL.into_iter().filter(|&role| self.joint(role).is_none()).collect()
    }

    fn check(&self, clip: &Clip) -> Result<(), MappingError> {
        for legs in Role::LEGS {
            if let Some(role) = legs[..3].iter().find(|&&role| self.joint(role).is_none()) {
                return Err(MappingError::NoLegs(role.name()));
            }
        }
        if self.joint(Role::Pelvis).is_none() {
            return Err(MappingError::NoLegs("pelvis"));
        }
        // A trunk of one bone is pelvis and chest in one.
        let limbs: Vec<(Role, usize)> = self.joints.iter().map(|(&role, &joint)| (role, joint)).collect();
        for (k, &(first, joint)) in limbs.iter().enumerate() {
            for &(second, other) in &limbs[..k] {
                let is_trunk = [first, second].iter().all(|role| matches!(role, Role::Pelvis | Role::Chest));
                if joint == other && !is_trunk {
                    let name = clip.joints()[joint].name.clone();
                    return Err(MappingError::Twice { first: second.name(), second: first.name(), name });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
