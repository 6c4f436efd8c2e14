//! The rig section: bones, joints and weights, by which edits move the body. Optional: without it edits move the surface alone.

use editing::rig::{MOST_BONES, NO_BONE};
use editing::stored::WEIGHT_STEPS;
use editing::{Bone, INFLUENCES, StoredRig};
use glam::{Mat3, Vec3};
use postcard::{take_from_bytes, to_extend};
use serde::{Deserialize, Serialize};

use super::entropy::binary::{Bit, Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;

/// The frame of the rest pose and the bones, before the stream of weights.
#[derive(Serialize, Deserialize)]
struct Head {
    rest_frame: u32,
    bones: Vec<StoredBone>,
}

#[derive(Serialize, Deserialize)]
struct StoredBone {
    name: String,
    parent: u8,
    limb: u32,
    joint: [f32; 3],
    /// Least and largest rotation vector.
    range: [[f32; 3]; 2],
    /// Column by column.
    spread: [f32; 9],
    gap: f32,
}

/// What has been learnt about the weights.
#[derive(Default)]
struct Models {
    /// How many bones a vertex has, by how many the one before had.
    count: [Number; INFLUENCES + 1],
    /// Whether a bone is that of the vertex before in the same place.
    same: [Bit; INFLUENCES],
    bone: Number,
    weight: [Number; INFLUENCES],
    /// Whether a vertex belongs to its first bone as one rigid piece, by whether the one before did.
    is_first: [Bit; 2],
    core: Number,
}

/// The section's bytes; `None` for more bones, or more of a vertex, than a rig may have.
pub(super) fn encode(rig: &StoredRig) -> Option<Vec<u8>> {
    let bones = rig.bones.iter().map(|bone| {
        Some(StoredBone {
            name: bone.name.clone(),
            parent: u8::try_from(bone.parent).ok()?,
            limb: bone.limb,
            joint: bone.joint.to_array(),
            range: bone.range.map(|end| end.to_array()),
            spread: bone.spread.to_cols_array(),
            gap: bone.gap,
        })
    });
    let head = Head { rest_frame: rig.rest_frame, bones: bones.collect::<Option<_>>()? };
    let (mut encoder, mut models) = (Encoder::default(), Models::default());
    let (mut before, mut was_first): (&[(u8, u8)], bool) = (&[], true);
    for (own, &core) in rig.influences.iter().zip(&rig.core) {
        if own.len() > INFLUENCES {
            return None;
        }
        models.count[before.len()].encode(&mut encoder, own.len() as u32);
        for (k, &(bone, weight)) in own.iter().enumerate() {
            let expected = before.get(k).map(|&(bone, _)| bone);
            if expected.is_some() {
                encoder.bit(&mut models.same[k], expected == Some(bone));
            }
            if expected != Some(bone) {
                models.bone.encode(&mut encoder, bone.into());
            }
            // The last weight is what is left.
            if k + 1 < own.len() {
                models.weight[k].encode(&mut encoder, weight.into());
            }
        }
        let is_first = own.first().is_some_and(|&(bone, _)| bone == core);
        encoder.bit(&mut models.is_first[usize::from(was_first)], is_first);
        if !is_first {
            models.core.encode(&mut encoder, (NO_BONE - core).into());
        }
        (before, was_first) = (own, is_first);
    }
    let mut bytes = to_extend(&head, Vec::new()).ok()?;
    bytes.extend(encoder.finish());
    Some(bytes)
}

/// Reads the section. Whether bones and weights make a rig is seen once its rest pose is there ([`StoredRig::rig`]).
///
/// # Errors
/// The reason where it holds no rig of this many vertices over this many frames.
pub fn decode(bytes: &[u8], vertex_count: usize, frame_count: u32) -> Result<StoredRig, &'static str> {
    let (head, rest): (Head, &[u8]) = take_from_bytes(bytes).map_err(|_| "does not begin with bones")?;
    if head.bones.is_empty() || head.bones.len() > MOST_BONES {
        return Err("has no bone, or too many");
    }
    if head.rest_frame >= frame_count {
        return Err("rests in a frame that does not exist");
    }
    if vertex_count > rest.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("is too short for its vertices");
    }
    let bones = head.bones.into_iter().map(|bone| Bone {
        name: bone.name,
        parent: bone.parent.into(),
        joint: Vec3::from(bone.joint),
        limb: bone.limb,
        range: bone.range.map(Vec3::from),
        spread: Mat3::from_cols_array(&bone.spread),
        gap: bone.gap,
    });
    let bones: Vec<Bone> = bones.collect();
    let (mut decoder, mut models) = (Decoder::new(rest), Models::default());
    let mut influences: Vec<Vec<(u8, u8)>> = Vec::with_capacity(vertex_count);
    let mut core = Vec::with_capacity(vertex_count);
    let mut was_first = true;
    for _ in 0..vertex_count {
        let before = influences.last().map_or(&[][..], Vec::as_slice);
        let count = models.count[before.len()].decode(&mut decoder) as usize;
        if !(1..=INFLUENCES).contains(&count) {
            return Err("has a vertex without bones, or with too many");
        }
        let (mut own, mut left) = (Vec::with_capacity(count), WEIGHT_STEPS);
        for k in 0..count {
            let bone = match before.get(k) {
                Some(&(bone, _)) if decoder.bit(&mut models.same[k]) => u32::from(bone),
                _ => models.bone.decode(&mut decoder),
            };
            let weight = if k + 1 < count { models.weight[k].decode(&mut decoder) } else { left.into() };
            if bone as usize >= bones.len() || weight > left.into() {
                return Err("has a bone that does not exist, or weights of more than all");
            }
            left -= weight as u8;
            own.push((bone as u8, weight as u8));
        }
        let is_first = decoder.bit(&mut models.is_first[usize::from(was_first)]);
        let own_core =
            if is_first { own[0].0.into() } else { u32::from(NO_BONE).wrapping_sub(models.core.decode(&mut decoder)) };
        if own_core != u32::from(NO_BONE) && own_core as usize >= bones.len() {
            return Err("has a piece of a bone that does not exist");
        }
        if decoder.exhausted() {
            return Err("ends too early");
        }
        core.push(own_core as u8);
        influences.push(own);
        was_first = is_first;
    }
    if !decoder.at_end() {
        return Err("has bytes left over, or too few");
    }
    Ok(StoredRig { rest_frame: head.rest_frame, bones, influences, core })
}
