//! Edits as a document: what is grabbed in which frame, where it goes, and how that spreads.

use actor::json::{Fields, Json, Unread, each, number, whole, wrong};
use actor::timeline::Timeline;
use glam::Vec3;
use kernels::sort::sort;
use serde::Serialize;

use crate::error::EditError;

/// Version of the document.
pub const VERSION: u32 = 1;
/// Bytes of a document at most.
pub const MOST_BYTES: usize = 4 << 20;
/// Edits of a document at most.
pub const MOST_EDITS: usize = 256;
/// Handles of an edit, and vertices that it pins, at most.
pub const MOST_HANDLES: usize = 4096;
/// Coordinates are at most this many metres.
pub const FARTHEST: f32 = 1e4;

/// A list of edits; see `docs/editing.md`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EditDocument {
    /// [`VERSION`].
    pub version: u32,
    /// The edits; where they overlap, their rotation vectors are added up, which has no order.
    pub edits: Vec<Edit>,
}

/// One edit of one frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Edit {
    /// Name of the sequence.
    pub sequence: String,
    /// The frame within the sequence, from 0.
    pub frame: u32,
    /// First and last frame, within the sequence, that it reaches; at both it has faded to nothing. A quarter of a second to
    /// both sides where not given. In a cyclic sequence the numbers may lie beyond its ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<[i64; 2]>,
    /// What is grabbed.
    pub handles: Vec<Handle>,
    /// What stays.
    pub pins: Pins,
    /// What may move.
    pub scope: Scope,
    /// How it moves.
    pub method: Method,
    /// How that spreads over the frames of the window.
    pub propagate: Propagation,
    /// Whether it is done.
    #[serde(skip_serializing_if = "is_yes")]
    pub on: bool,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_yes(on: &bool) -> bool {
    *on
}

/// A vertex and where it goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Handle {
    /// The vertex.
    pub vertex: u32,
    /// Where it goes, in metres, as the frame was recorded: edits turn with the actor.
    pub to: Vec3,
}

/// What stays where it is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Pins {
    /// Feet that stand; where no feet are known, what is lowest.
    #[default]
    Contacts,
    /// Nothing.
    None,
    /// These vertices.
    #[serde(untagged)]
    Vertices(Vec<u32>),
}

/// What may move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Scope {
    /// The whole body.
    #[default]
    Body,
    /// The limb that is grabbed; in the trunk, the trunk.
    Limb,
    /// What is near along the surface.
    #[serde(untagged)]
    #[allow(missing_docs)]
    Region {
        /// In metres.
        radius: f32,
    },
}

/// How the surface follows its handles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Bones turn, the surface follows in one solve.
    #[default]
    Rig,
    /// In the ways in which the capture was seen to move, as rigid as possible beyond them.
    Learned,
    /// As that, each part of the body for itself: what one does says nothing of the others.
    Parts,
    /// As rigid as possible.
    Arap,
    /// Differential coordinates as they are: for small moves.
    Laplace,
}

impl Edit {
    /// Whether the two do the same to the same frame, however far that reaches.
    pub(crate) fn does_as(&self, other: &Self) -> bool {
        let says = |edit: &Self| (edit.handles.clone(), edit.pins.clone(), edit.scope, edit.method);
        says(self) == says(other)
    }
}

impl Method {
    /// Whether it goes by the learned space.
    #[must_use]
    pub fn is_learned(self) -> bool {
        matches!(self, Self::Learned | Self::Parts)
    }
}

/// How an edit spreads over frames (Tejera et al. (2013), III-C).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Propagation {
    /// Rotations fade, and each frame is solved for.
    #[default]
    Nonlinear,
    /// Displacements fade: for small moves.
    Linear,
    /// The handles' displacements fade, and each frame is edited anew.
    Constraint,
}

impl EditDocument {
    /// Reads a document and checks all that can be checked without a capture.
    ///
    /// # Errors
    /// [`EditError::Json`] and others that say which edit.
    pub fn from_json(text: &str) -> Result<Self, EditError> {
        Self::parse(text, Json::read)
    }

    /// The same where `read` knows what JSON is: the browser.
    ///
    /// # Errors
    /// As there.
    pub fn parse(text: &str, read: impl FnOnce(&str) -> Option<Json>) -> Result<Self, EditError> {
        limit("bytes", text.len(), MOST_BYTES)?;
        let document = document(&Json::document(text, read)?)?;
        document.check_numbers()?;
        Ok(document)
    }

    /// Whether any of its edits goes by the learned space.
    #[must_use]
    pub fn wants_space(&self) -> bool {
        self.edits.iter().any(|edit| edit.method.is_learned())
    }

    /// The document as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        // All fields are plain: there is nothing that could fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    fn check_numbers(&self) -> Result<(), EditError> {
        limit("edits", self.edits.len(), MOST_EDITS)?;
        for (edit, one) in self.edits.iter().enumerate() {
            let refuse = |reason| Err(EditError::Edit { edit, reason });
            limit("handles of an edit", one.handles.len(), MOST_HANDLES)?;
            if one.handles.is_empty() {
                return refuse("it has no handle: say which vertex goes where");
            }
            let holds = |v: f32| v.is_finite() && v.abs() <= FARTHEST;
            if !one.handles.iter().all(|handle| handle.to.to_array().into_iter().all(holds)) {
                return refuse("a handle's place must be three numbers of at most 10,000 metres");
            }
            let mut vertices: Vec<u128> = one.handles.iter().map(|handle| handle.vertex.into()).collect();
            sort(&mut vertices);
            if vertices.windows(2).any(|pair| pair[0] == pair[1]) {
                return refuse("a vertex is a handle twice: it can go to one place only");
            }
            if let Pins::Vertices(pins) = &one.pins {
                limit("pins of an edit", pins.len(), MOST_HANDLES)?;
            }
            if let Scope::Region { radius } = one.scope
                && !(radius > 0.0 && radius <= FARTHEST)
            {
                return refuse("the radius of its scope must be a positive number of metres");
            }
            if let Some([first, last]) = one.window
                && !(first <= i64::from(one.frame) && i64::from(one.frame) <= last)
            {
                return refuse("its window must begin before its frame and end after it");
            }
        }
        Ok(())
    }

    /// Checks what needs the capture: sequences, frames and vertices. Frames over the whole capture, by edit.
    ///
    /// # Errors
    /// What does not exist, and in which edit.
    pub fn check(&self, timeline: &Timeline, vertex_count: usize) -> Result<Vec<u32>, EditError> {
        let mut frames = Vec::with_capacity(self.edits.len());
        for (edit, one) in self.edits.iter().enumerate() {
            let Some(sequence) = timeline.sequences().iter().find(|sequence| sequence.name == one.sequence) else {
                let known: Vec<&str> = timeline.sequences().iter().map(|sequence| sequence.name.as_str()).collect();
                return Err(EditError::Sequence { edit, name: one.sequence.clone(), known: known.join(", ") });
            };
            if one.frame >= sequence.frame_count {
                let (name, frame, count) = (one.sequence.clone(), one.frame, sequence.frame_count);
                return Err(EditError::Frame { edit, name, frame, count });
            }
            let pins: &[u32] = if let Pins::Vertices(pins) = &one.pins { pins } else { &[] };
            let vertices = one.handles.iter().map(|handle| handle.vertex).chain(pins.iter().copied());
            if let Some(vertex) = vertices.into_iter().find(|&vertex| vertex as usize >= vertex_count) {
                return Err(EditError::Vertex { edit, vertex, count: vertex_count });
            }
            frames.push(sequence.first_frame + one.frame);
        }
        Ok(frames)
    }
}

fn document(value: &Json) -> Result<EditDocument, EditError> {
    let fields = Fields::new(value, "the document")?;
    // A later version may have other fields: that is to be said first.
    let version = whole(fields.need("version")?, "the version")?;
    if version != VERSION {
        return Err(EditError::Version { found: version.into(), known: VERSION });
    }
    let fields = fields.only(&["version", "edits"])?;
    let Json::List(list) = fields.need("edits")? else { return Err(wrong(&["edits is no list"]).into()) };
    let edits = list.iter().enumerate().map(|(edit, value)| {
        self::edit(value).map_err(|Unread(reason)| EditError::Json(format!("edit {edit}: {reason}")))
    });
    Ok(EditDocument { version, edits: edits.collect::<Result<_, _>>()? })
}

fn edit(value: &Json) -> Result<Edit, Unread> {
    let known = ["sequence", "frame", "window", "handles", "pins", "scope", "method", "propagate", "on"];
    let fields = Fields::new(value, "it")?.only(&known)?;
    Ok(Edit {
        sequence: fields.text("sequence")?,
        frame: whole(fields.need("frame")?, "frame")?,
        window: fields.maybe("window").map(window).transpose()?,
        handles: each(fields.need("handles")?, "handles", handle)?,
        pins: match fields.maybe("pins") {
            Some(Json::List(list)) => {
                let pins = list.iter().map(|pin| whole(pin, "a pin"));
                Pins::Vertices(pins.collect::<Result<_, _>>()?)
            }
            word => one_of(word, "pins", &[("contacts", Pins::Contacts), ("none", Pins::None)])?,
        },
        scope: match fields.maybe("scope") {
            Some(region @ Json::Object(_)) => {
                let region = Fields::new(region, "scope")?.only(&["radius"])?;
                Scope::Region { radius: region.number("radius")? as f32 }
            }
            word => one_of(word, "scope", &[("body", Scope::Body), ("limb", Scope::Limb)])?,
        },
        method: {
            use Method::{Arap, Laplace, Learned, Parts, Rig};
            let known = [("rig", Rig), ("learned", Learned), ("parts", Parts), ("arap", Arap), ("laplace", Laplace)];
            one_of(fields.maybe("method"), "method", &known)?
        },
        propagate: {
            use Propagation::{Constraint, Linear, Nonlinear};
            let known = [("nonlinear", Nonlinear), ("linear", Linear), ("constraint", Constraint)];
            one_of(fields.maybe("propagate"), "propagate", &known)?
        },
        on: match fields.maybe("on") {
            None => true,
            Some(Json::Bool(on)) => *on,
            Some(_) => return Err(wrong(&["on is true or false"])),
        },
    })
}

fn handle(value: &Json) -> Result<Handle, Unread> {
    let fields = Fields::new(value, "a handle")?.only(&["vertex", "to"])?;
    let coordinate = |part: &Json| -> Result<f32, Unread> { Ok(number(part, "a coordinate")? as f32) };
    let to = each(fields.need("to")?, "to", coordinate)?;
    let &[x, y, z] = to.as_slice() else { return Err(wrong(&["a handle's place has three numbers"])) };
    Ok(Handle { vertex: whole(fields.need("vertex")?, "vertex")?, to: Vec3::new(x, y, z) })
}

fn window(value: &Json) -> Result<[i64; 2], Unread> {
    let frame = |part: &Json| match number(part, "window")? {
        // Farther than any capture.
        at if at.fract() == 0.0 && at.abs() <= f64::from(u32::MAX) => Ok(at as i64),
        _ => Err(wrong(&["a window has whole numbers"])),
    };
    match each(value, "window", frame)?.as_slice() {
        &[first, last] => Ok([first, last]),
        _ => Err(wrong(&["a window has a first and a last frame"])),
    }
}

/// What a word means; the first of them where there is none.
fn one_of<T: Clone>(word: Option<&Json>, name: &str, known: &[(&str, T)]) -> Result<T, Unread> {
    let found = match word {
        None => known.first(),
        Some(Json::Text(text)) => known.iter().find(|(word, _)| word == text),
        Some(_) => None,
    };
    let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
    found.map(|(_, meaning)| meaning.clone()).ok_or_else(|| wrong(&[name, " is none of ", &words.join(", ")]))
}

fn limit(what: &'static str, count: usize, limit: usize) -> Result<(), EditError> {
    if count > limit { Err(EditError::TooMany { what, count, limit }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use actor::timeline::Sequence;

    use super::*;

    fn text(edit: &str) -> String {
        format!(r#"{{"version":1,"edits":[{edit}]}}"#)
    }

    const PLAIN: &str = r#"{"sequence":"walk","frame":3,"handles":[{"vertex":2,"to":[0,1,2]}]}"#;

    #[test]
    fn documents_are_read_and_written() {
        let document = EditDocument::from_json(&text(PLAIN)).unwrap();
        let edit = &document.edits[0];
        assert_eq!((&edit.pins, edit.scope, edit.method), (&Pins::Contacts, Scope::Body, Method::Rig));
        assert!(edit.on && edit.propagate == Propagation::Nonlinear);
        assert_eq!(EditDocument::from_json(&document.to_json()).unwrap(), document);
        let full = r#"{"sequence":"walk","frame":3,"window":[-2,9],"handles":[{"vertex":2,"to":[0,1,2]}],"pins":[4,5],
            "scope":{"radius":0.2},"method":"arap","propagate":"linear","on":false}"#;
        let document = EditDocument::from_json(&text(full)).unwrap();
        assert_eq!(document.edits[0].pins, Pins::Vertices(vec![4, 5]));
        assert_eq!(document.edits[0].scope, Scope::Region { radius: 0.2 });
        assert_eq!(EditDocument::from_json(&document.to_json()).unwrap(), document);
    }

    #[test]
    fn bad_documents_are_refused_with_a_sentence() {
        let refused = |text: &str| EditDocument::from_json(text).unwrap_err().to_string();
        assert!(refused("[").contains("not a document of edits"));
        assert!(refused("{}").contains("version"));
        assert!(refused(r#"{"version":9,"edits":7}"#).contains("version 9"));
        assert!(refused(&text(&PLAIN.replace("frame", "farme"))).contains("farme"));
        assert!(refused(&text(&PLAIN.replace("[{\"vertex\":2,\"to\":[0,1,2]}]", "[]"))).contains("no handle"));
        assert!(refused(&text(&PLAIN.replace("[0,1,2]", "[0,1e9,2]"))).contains("10,000"));
        let twice = PLAIN.replace("[{", "[{\"vertex\":2,\"to\":[0,0,0]},{");
        assert!(refused(&text(&twice)).contains("twice"));
        let window = PLAIN.replace("\"frame\":3", "\"frame\":3,\"window\":[5,9]");
        assert!(refused(&text(&window)).contains("window"));
    }

    #[test]
    fn what_the_capture_lacks_is_named() {
        let sequence = Sequence { name: "walk".into(), labels: vec![], first_frame: 0, frame_count: 5, cyclic: false };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let of = |from: &str, to: &str| EditDocument::from_json(&text(&PLAIN.replace(from, to))).unwrap();
        assert_eq!(of("walk", "walk").check(&timeline, 3).unwrap(), [3]);
        let error = |document: EditDocument, count| document.check(&timeline, count).unwrap_err().to_string();
        assert!(error(of("walk", "run"), 3).contains("there are: walk"));
        assert!(error(of("3", "5"), 3).contains("no frame 5"));
        assert!(error(of("walk", "walk"), 2).contains("no vertex 2"));
    }
}
