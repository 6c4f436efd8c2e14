//! ASF: the skeleton that AMC files move.
//!
//! A bone's rotation is given in axes of its own: C R C^-1 turns it against its parent, where C is made of the bone's `axis`
//! and R of its degrees of freedom, the first of them done first. A joint is where a bone begins; bones without children end
//! in a joint of their own.

use std::collections::{BTreeMap, HashMap};

use driving::ClipJoint;
use driving::clip::MOST_JOINTS;
use glam::{DQuat, DVec3};

use crate::bvh::about;
use crate::error::MocapError;
use crate::words::{lines, number, syntax, text};

/// A bone as the file has it.
#[derive(Clone, Debug, Default)]
struct Bone {
    direction: DVec3,
    length: f64,
    axis: DQuat,
    /// Axes of rotation, in the order of the numbers.
    dof: Vec<usize>,
}

/// What one number of the root is: 0 to 2 a coordinate, 3 to 5 an angle.
type RootDof = usize;

/// A skeleton.
pub struct Asf {
    /// Joints; the root is the first.
    pub joints: Vec<ClipJoint>,
    /// Their offsets from their parents, in the file's unit.
    pub offsets: Vec<DVec3>,
    /// The axes of each joint's bone.
    pub axes: Vec<DQuat>,
    /// The axes that the numbers of each joint's bone turn about.
    pub dofs: Vec<Vec<usize>>,
    /// What the root's numbers are.
    pub root: Vec<RootDof>,
    /// Where the root is before it moves, and how it is turned.
    pub origin: (DVec3, DQuat),
    /// Joint by its bone's name.
    pub by_name: HashMap<String, usize>,
    /// Whether angles are in degrees.
    pub degrees: bool,
    /// What `length` of the units says; 1 where nothing.
    pub length: f64,
}

#[derive(Default)]
struct File {
    bones: BTreeMap<String, Bone>,
    children: HashMap<String, Vec<String>>,
    root: Vec<RootDof>,
    root_axis: DQuat,
    position: DVec3,
    orientation: DVec3,
    degrees: bool,
    length: f64,
}

/// Reads a skeleton.
pub fn read(source: &str, bytes: &[u8]) -> Result<Asf, MocapError> {
    let text = text(bytes);
    let mut file = File { degrees: true, length: 1.0, ..File::default() };
    let mut section = "";
    let mut bone: Option<(String, Bone)> = None;
    for (line, text) in lines(&text) {
        let mut words = text.split_whitespace();
        let first = words.next().unwrap_or_default();
        if first.starts_with(':') {
            section = first;
            continue;
        }
        let rest: Vec<&str> = words.collect();
        match section {
            ":units" => units(source, line, first, &rest, &mut file)?,
            ":root" => root(source, line, first, &rest, &mut file)?,
            ":bonedata" => bonedata(source, line, (first, &rest), &mut bone, &mut file)?,
            ":hierarchy" if first != "begin" && first != "end" => {
                let children = file.children.entry(first.to_owned()).or_default();
                children.extend(rest.iter().map(|&child| child.to_owned()));
            }
            _ => {}
        }
    }
    if bone.is_some() {
        return Err(MocapError::Truncated { file: source.into(), what: "a bone".into() });
    }
    assemble(source, file)
}

fn vector(source: &str, line: usize, words: &[&str]) -> Result<DVec3, MocapError> {
    let [x, y, z, ..] = words else { return Err(syntax(source, line, "three numbers are missing")) };
    Ok(DVec3::new(number(source, line, x)?, number(source, line, y)?, number(source, line, z)?))
}

/// Angles about axes in the order that `order` says, as `XYZ`: the first is done first.
fn turn(source: &str, line: usize, angles: DVec3, order: &str, degrees: bool) -> Result<DQuat, MocapError> {
    let mut turn = DQuat::IDENTITY;
    if order.len() != 3 {
        return Err(syntax(source, line, format!("{order:?} is no order of three axes")));
    }
    for (k, letter) in order.bytes().enumerate() {
        let axis = match letter.to_ascii_lowercase() {
            b'x' => 0,
            b'y' => 1,
            b'z' => 2,
            _ => return Err(syntax(source, line, format!("{order:?} is no order of axes"))),
        };
        let angle = if degrees { angles[k].to_radians() } else { angles[k] };
        turn = about(axis, angle) * turn;
    }
    Ok(turn)
}

fn units(source: &str, line: usize, first: &str, rest: &[&str], file: &mut File) -> Result<(), MocapError> {
    match (first, rest) {
        ("length", [word, ..]) => {
            file.length = number(source, line, word)?;
            if file.length.is_nan() || file.length <= 1e-9 {
                return Err(syntax(source, line, "a length of none has no unit"));
            }
        }
        ("angle", [word, ..]) => file.degrees = !word.to_ascii_lowercase().starts_with("rad"),
        _ => {}
    }
    Ok(())
}

fn root(source: &str, line: usize, first: &str, rest: &[&str], file: &mut File) -> Result<(), MocapError> {
    match first {
        "order" => {
            for word in rest {
                let names = ["tx", "ty", "tz", "rx", "ry", "rz"];
                let at = names.iter().position(|name| name.eq_ignore_ascii_case(word));
                file.root.push(at.ok_or_else(|| syntax(source, line, format!("{word:?} moves no root")))?);
            }
            if file.root.len() > 6 {
                return Err(syntax(source, line, "a root has up to six numbers"));
            }
        }
        // Which order the orientation's angles have; an axis alone turns nothing.
        "axis" => {
            let order = rest.first().copied().unwrap_or("XYZ");
            turn(source, line, DVec3::ZERO, order, true)?;
        }
        "position" => file.position = vector(source, line, rest)?,
        "orientation" => {
            file.orientation = vector(source, line, rest)?;
            file.root_axis = turn(source, line, file.orientation, "XYZ", file.degrees)?;
        }
        _ => {}
    }
    Ok(())
}

fn bonedata(
    source: &str,
    line: usize,
    (first, rest): (&str, &[&str]),
    open: &mut Option<(String, Bone)>,
    file: &mut File,
) -> Result<(), MocapError> {
    match first {
        "begin" => *open = Some(Default::default()),
        "end" => {
            let Some((name, bone)) = open.take() else { return Err(syntax(source, line, "no bone begins here")) };
            if name.is_empty() || name == "root" {
                return Err(syntax(source, line, "the bone that ends here has no name of its own"));
            }
            if file.bones.len() >= MOST_JOINTS {
                return Err(syntax(source, line, format!("there are more than {MOST_JOINTS} bones")));
            }
            if file.bones.insert(name.clone(), bone).is_some() {
                return Err(syntax(source, line, format!("two bones are called {name:?}")));
            }
        }
        _ => {
            let Some((name, bone)) = open else { return Ok(()) };
            match first {
                "name" => *name = rest.first().copied().unwrap_or_default().to_owned(),
                "direction" => bone.direction = vector(source, line, rest)?.normalize_or_zero(),
                "length" => {
                    let word = rest.first().ok_or_else(|| syntax(source, line, "the length is missing"))?;
                    bone.length = number(source, line, word)?;
                }
                "axis" => {
                    let order = rest.get(3).copied().unwrap_or("XYZ");
                    bone.axis = turn(source, line, vector(source, line, rest)?, order, file.degrees)?;
                }
                "dof" => {
                    for word in rest {
                        let at = ["rx", "ry", "rz"].iter().position(|name| name.eq_ignore_ascii_case(word));
                        let wrong = || syntax(source, line, format!("bones that move by {word:?} are not read"));
                        bone.dof.push(at.ok_or_else(wrong)?);
                    }
                    if bone.dof.len() > 3 {
                        return Err(syntax(source, line, "a bone turns about three axes at most"));
                    }
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// The joints, parents first, each where its bone begins.
fn assemble(source: &str, file: File) -> Result<Asf, MocapError> {
    let wrong = |reason: String| MocapError::Syntax { file: source.into(), line: 1, reason };
    if file.root.is_empty() {
        return Err(wrong("the root has no order of numbers (:root order TX TY TZ RX RY RZ)".into()));
    }
    let mut asf = Asf {
        joints: vec![ClipJoint { name: "root".into(), parent: None }],
        offsets: vec![DVec3::ZERO],
        axes: vec![DQuat::IDENTITY],
        dofs: vec![Vec::new()],
        root: file.root,
        origin: (file.position, file.root_axis),
        by_name: HashMap::from([("root".to_owned(), 0)]),
        degrees: file.degrees,
        length: file.length,
    };
    let mut due: Vec<(String, usize, DVec3)> = Vec::new();
    let children = |name: &str| file.children.get(name).map_or(&[][..], Vec::as_slice);
    due.extend(children("root").iter().rev().map(|child| (child.clone(), 0, DVec3::ZERO)));
    while let Some((name, parent, offset)) = due.pop() {
        let Some(bone) = file.bones.get(&name) else {
            return Err(wrong(format!("the hierarchy names the bone {name:?}, which is not described")));
        };
        let joint = asf.joints.len();
        if asf.by_name.insert(name.clone(), joint).is_some() {
            return Err(wrong(format!("the bone {name:?} hangs in two places")));
        }
        asf.push(ClipJoint { name: name.clone(), parent: Some(parent) }, offset, bone.axis, bone.dof.clone());
        let end = bone.direction * bone.length;
        if children(&name).is_empty() {
            let end_joint = ClipJoint { name: format!("{name} end"), parent: Some(joint) };
            asf.push(end_joint, end, DQuat::IDENTITY, Vec::new());
        }
        due.extend(children(&name).iter().rev().map(|child| (child.clone(), joint, end)));
    }
    if asf.joints.len() == 1 {
        return Err(wrong("nothing hangs on the root".into()));
    }
    Ok(asf)
}

impl Asf {
    fn push(&mut self, joint: ClipJoint, offset: DVec3, axis: DQuat, dof: Vec<usize>) {
        self.joints.push(joint);
        self.offsets.push(offset);
        self.axes.push(axis);
        self.dofs.push(dof);
    }
}
