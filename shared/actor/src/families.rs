//! Families of an actor's sequences: members that do the same, each with the number by which it is asked for, such as walks by
//! their speed (Tejera, Casas and Hilton 2013, section IV). As JSON they lie in bundles, and go to pages.

use serde::Serialize;

use crate::json::{Fields, Json, Unread, each, number, whole, wrong};

/// Members that do the same, more or less of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Family {
    /// Its name.
    pub name: String,
    /// What its members are asked by: `speed`, `turn`, `height` or `length`.
    pub parameter: String,
    /// The unit of that, such as `m/s`.
    pub unit: String,
    /// Its members; of those that are as good as each other, the first one is taken.
    pub members: Vec<FamilyMember>,
}

/// A member of a family.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FamilyMember {
    /// The name of its sequence.
    pub sequence: String,
    /// Its first and its last frame, counted over the whole capture.
    pub frames: [u32; 2],
    /// The family's parameter, measured.
    pub value: f32,
}

impl Family {
    /// Families as JSON.
    #[must_use]
    pub fn to_json(families: &[Self]) -> String {
        // All fields are plain: there is nothing that could fail.
        serde_json::to_string(families).unwrap_or_default()
    }

    /// The families that a document holds. Whether an actor has them [`Timeline::with_families`] checks.
    ///
    /// # Errors
    /// What is missing or of another kind.
    ///
    /// [`Timeline::with_families`]: crate::timeline::Timeline::with_families
    pub fn of_json(document: &Json) -> Result<Vec<Self>, Unread> {
        each(document, "families", |family| {
            let fields = Fields::new(family, "a family")?;
            let (name, parameter, unit) = (fields.text("name")?, fields.text("parameter")?, fields.text("unit")?);
            Ok(Self { name, parameter, unit, members: each(fields.need("members")?, "members", member)? })
        })
    }
}

fn member(value: &Json) -> Result<FamilyMember, Unread> {
    let fields = Fields::new(value, "a member")?;
    let frames = each(fields.need("frames")?, "frames", |frame| whole(frame, "a frame"))?;
    let &[first, last] = frames.as_slice() else { return Err(wrong(&["a member has not two frames"])) };
    Ok(FamilyMember {
        sequence: fields.text("sequence")?,
        frames: [first, last],
        value: number(fields.need("value")?, "value")? as f32,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_read_as_they_were_written() {
        let member = |sequence: &str, frames, value| FamilyMember { sequence: sequence.into(), frames, value };
        let families = vec![Family {
            name: "gait".into(),
            parameter: "speed".into(),
            unit: "m/s".into(),
            members: vec![member("gait 1.57 m/s", [90, 140], 1.571_3), member("walk", [3, 40], 0.93)],
        }];
        let text = Family::to_json(&families);
        assert_eq!(Family::of_json(&Json::read(&text).unwrap()), Ok(families));
        for (part, by, says) in [
            (r#""value":0.93"#, r#""value":"much""#, "number"),
            ("[3,40]", "[3]", "two frames"),
            (r#""unit":"m/s","#, "", "unit"),
            (r#""sequence":"walk","#, "", "sequence"),
        ] {
            let refused = Family::of_json(&Json::read(&text.replace(part, by)).unwrap()).unwrap_err();
            assert!(refused.to_string().contains(says), "{refused}");
        }
    }
}
