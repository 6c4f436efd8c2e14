//! A rig as a TOML file: what was found, to be read, changed and given back.

use editing::rig::NO_BONE;
use editing::{Bone, INFLUENCES, Influences, Rig};
use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::estimate::{Estimate, RigError};

/// What a rig file says: an entry for each bone that was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigFile {
    /// Whether it is the skeleton of the capture's file, or estimated from the motion of the surface; the file's where it has one, unless
    /// `parts` are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<RigOrigin>,
    /// Rigid parts that the surface is split into at most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parts: Option<usize>,
    /// The bones, by the names under which they were found.
    #[serde(default)]
    pub bone: Vec<Correction>,
}

/// Where a rig comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RigOrigin {
    /// The skeleton that the capture's file brings.
    File,
    /// The motion of the surface.
    Motion,
}

/// What is said of one bone. What is left out stays as it was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correction {
    /// Its name as it was found.
    pub found: String,
    /// Its name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The bone that it hangs on, by its name as it was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// Where it meets its parent, in metres, in the rest pose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<[f32; 3]>,
    /// Whether it is taken into its parent.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub merge: bool,
}

impl RigFile {
    /// All that was found.
    #[must_use]
    pub fn of(estimate: &Estimate) -> Self {
        let bones = estimate.rig.bones();
        let entry = |(index, bone): (usize, &Bone)| Correction {
            found: bone.name.clone(),
            name: None,
            parent: (index > 0).then(|| bones[bone.parent].name.clone()),
            joint: Some(bone.joint.to_array()),
            merge: false,
        };
        let (from, parts) = match estimate.is_given {
            true => (Some(RigOrigin::File), None),
            false => (None, Some(estimate.parts)),
        };
        Self { from, parts, bone: bones.iter().enumerate().map(entry).collect() }
    }

    /// The rig with what the file says of its bones.
    ///
    /// # Errors
    /// A bone that was not found, a parent that hangs on its own child, a root that is merged, names that are not unique.
    pub fn correct(&self, rig: &Rig) -> Result<Rig, RigError> {
        let mut bones = rig.bones().to_vec();
        let mut merged = vec![false; bones.len()];
        let find = |name: &str| rig.bones().iter().position(|bone| bone.name == name);
        let refuse = |name: &str, reason: String| Err(RigError::Correction { name: name.into(), reason });
        for one in &self.bone {
            let Some(index) = find(&one.found) else {
                let names: Vec<&str> = rig.bones().iter().map(|bone| bone.name.as_str()).collect();
                return refuse(
                    &one.found,
                    format!("no bone was found under this name; there are: {}", names.join(", ")),
                );
            };
            if let Some(name) = &one.name {
                bones[index].name.clone_from(name);
            }
            if let Some(joint) = one.joint {
                bones[index].joint = Vec3::from(joint);
            }
            if let Some(parent) = &one.parent {
                match find(parent) {
                    _ if index == 0 => {
                        return refuse(&one.found, "the root hangs on nothing: leave its parent out".into());
                    }
                    Some(parent) => bones[index].parent = parent,
                    None => return refuse(&one.found, format!("its parent {parent:?} was not found")),
                }
            }
            if one.merge && index == 0 {
                return refuse(&one.found, "the root cannot be merged: it has no parent".into());
            }
            merged[index] = one.merge;
        }
        let order = parents_first(&bones)?;
        rebuilt(rig, bones, &merged, &order)
    }
}

/// The bones' indices, parents before children.
fn parents_first(bones: &[Bone]) -> Result<Vec<usize>, RigError> {
    let mut order = vec![0];
    loop {
        let next = (1..bones.len()).find(|index| !order.contains(index) && order.contains(&bones[*index].parent));
        match next {
            Some(index) => order.push(index),
            None if order.len() == bones.len() => return Ok(order),
            None => {
                let left = (1..bones.len()).find(|index| !order.contains(index)).unwrap_or_default();
                let reason = "it hangs on one of its own children".into();
                return Err(RigError::Correction { name: bones[left].name.clone(), reason });
            }
        }
    }
}

/// The rig of `bones` in this order, without those that are merged into their parents.
fn rebuilt(rig: &Rig, bones: Vec<Bone>, merged: &[bool], order: &[usize]) -> Result<Rig, RigError> {
    let kept: Vec<usize> = order.iter().copied().filter(|&index| !merged[index]).collect();
    let into = |mut index: usize| {
        while merged[index] {
            index = bones[index].parent;
        }
        kept.iter().position(|&kept| kept == index).unwrap_or_default()
    };
    let new = kept.iter().enumerate().map(|(at, &index)| {
        let parent = if at == 0 { 0 } else { into(bones[index].parent) };
        Bone { parent, ..bones[index].clone() }
    });
    let influences = rig.influences().iter().map(|old| {
        let mut shares: Vec<(usize, f32)> = Vec::new();
        for (&bone, &weight) in old.joints.iter().zip(&old.weights) {
            let bone = into(bone as usize);
            match shares.iter_mut().find(|(other, _)| *other == bone) {
                Some((_, share)) => *share += weight,
                None => shares.push((bone, weight)),
            }
        }
        let mut own = Influences::default();
        for k in 0..INFLUENCES {
            let (bone, weight) = shares.get(k).copied().unwrap_or((shares[0].0, 0.0));
            (own.joints[k], own.weights[k]) = (bone as u8, weight);
        }
        own
    });
    let core = rig.core().iter().map(|&bone| if bone == NO_BONE { NO_BONE } else { into(bone as usize) as u8 });
    Ok(Rig::new(new.collect(), influences.collect(), core.collect(), rig.rest().to_vec())?)
}

#[cfg(test)]
mod tests {
    use glam::Mat3;

    use super::*;

    fn rig() -> Rig {
        let bone = |name: &str, parent| Bone {
            name: name.into(),
            parent,
            joint: Vec3::ZERO,
            limb: 0,
            range: [Vec3::ZERO; 2],
            spread: Mat3::ZERO,
            gap: 0.0,
        };
        let influences = Influences { joints: [0, 1, 2, 0], weights: [0.2, 0.3, 0.5, 0.0] };
        let bones = vec![bone("a", 0), bone("b", 0), bone("c", 1)];
        Rig::new(bones, vec![influences; 3], vec![0, 1, 2], vec![Vec3::ZERO; 3]).unwrap()
    }

    fn correct(text: &str) -> Result<Rig, RigError> {
        toml::from_str::<RigFile>(text).unwrap().correct(&rig())
    }

    #[test]
    fn bones_are_renamed_moved_and_merged() {
        let same = correct("").unwrap();
        assert_eq!(same, rig());
        let changed = correct(
            "[[bone]]\nfound = \"b\"\nmerge = true\n[[bone]]\nfound = \"c\"\nname = \"tail\"\njoint = [1.0, 2.0, 3.0]",
        )
        .unwrap();
        let names: Vec<&str> = changed.bones().iter().map(|bone| bone.name.as_str()).collect();
        assert_eq!(
            (names, changed.bones()[1].parent, changed.bones()[1].joint),
            (vec!["a", "tail"], 0, Vec3::new(1.0, 2.0, 3.0))
        );
        assert_eq!(changed.influences()[0], Influences { joints: [0, 1, 0, 0], weights: [0.5, 0.5, 0.0, 0.0] });
        let turned =
            correct("[[bone]]\nfound = \"b\"\nparent = \"c\"\n[[bone]]\nfound = \"c\"\nparent = \"a\"").unwrap();
        assert_eq!(turned.bones().iter().map(|bone| bone.name.as_str()).collect::<Vec<_>>(), ["a", "c", "b"]);
        assert_eq!(turned.influences()[0].joints[..3], [0, 2, 1]);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let error = |text: &str| correct(text).unwrap_err().to_string();
        assert!(error("[[bone]]\nfound = \"x\"").contains("there are: a, b, c"));
        assert!(error("[[bone]]\nfound = \"a\"\nmerge = true").contains("root"));
        assert!(error("[[bone]]\nfound = \"b\"\nparent = \"c\"").contains("children"));
        assert!(error("[[bone]]\nfound = \"b\"\nname = \"a\"").contains("two bones"));
        assert!(toml::from_str::<RigFile>("[[bone]]\nfond = 1").is_err());
    }
}
