//! How a drag comes to rest: for documents all at once, on a page a step at a time, with other work between.

use glam::Vec3;

use crate::descent::Descent;
use crate::error::EditError;
use crate::grab::{By, Editor, FIRST_STEPS, Grab};

/// Local and global steps of as-rigid-as-possible surfaces, at most.
const MOST_ITERATIONS: usize = 80;
/// The same once a surface has been stopped at the ground.
const AGAIN: usize = 20;

/// A grab on its way to rest.
pub struct Settling {
    grab: Grab,
    to: Vec<Vec3>,
    notes: Vec<String>,
    stage: Stage,
}

/// What is done next.
enum Stage {
    Begin,
    /// The surface alone: so many iterations are left.
    Relax(usize),
    Descend(Box<Descent>),
}

impl Stage {
    /// How a surface begins to come to rest.
    fn of(grab: &mut Grab) -> Self {
        match &mut grab.by {
            By::Modes { learned, .. } => Self::Descend(Box::new(Descent::new(learned, grab.pose.len()))),
            _ if grab.rounds > 0 => Self::Relax(AGAIN),
            _ => Self::Relax(MOST_ITERATIONS),
        }
    }
}

impl Settling {
    /// `grab` will come to rest with its handles at `to`, in metres, one place for each.
    #[must_use]
    pub fn new(grab: Grab, to: &[Vec3]) -> Self {
        Self { grab, to: to.to_vec(), notes: Vec::new(), stage: Stage::Begin }
    }

    /// One step by the editor that grabbed it: whether it is at rest.
    ///
    /// # Errors
    /// As [`Editor::drag`].
    pub fn step(&mut self, editor: &mut Editor) -> Result<bool, EditError> {
        let Self { grab, to, notes, stage } = self;
        let is_still = match stage {
            Stage::Begin => {
                let to = &grab.allowed(to, notes);
                if !editor.aim(grab, to)? {
                    return Ok(true);
                }
                match &grab.by {
                    By::Bones(_) => editor.pull_bones(grab, to, FIRST_STEPS, notes)?,
                    _ => *stage = Stage::of(grab),
                }
                matches!(grab.by, By::Bones(_))
            }
            Stage::Relax(left) => {
                *left -= 1;
                editor.relax(grab, *left == 0)?
            }
            Stage::Descend(descent) => {
                let wanted = grab.held_wanted();
                let By::Modes { learned, .. } = &mut grab.by else { return Ok(true) };
                match descent.step(learned, &mut editor.deformer, &grab.held, (&grab.pose, &wanted))? {
                    Some(displacements) => {
                        grab.displacements = displacements;
                        true
                    }
                    None => false,
                }
            }
        };
        if is_still && (editor.draw_in(grab) || editor.hold_above(grab)?) {
            *stage = Stage::of(grab);
            return Ok(false);
        }
        if is_still {
            let anchor = grab.held.anchor();
            editor.soften(grab)?;
            editor.lift(grab, anchor)?;
            if !matches!(grab.by, By::Bones(_)) {
                let to = grab.allowed(to, &mut Vec::new());
                grab.shortfalls(&to, notes);
            }
        }
        grab.is_first &= !is_still;
        Ok(is_still)
    }

    /// What came of it, and what is not as it was wanted, in sentences.
    #[must_use]
    pub fn into_parts(self) -> (Grab, Vec<String>) {
        (self.grab, self.notes)
    }
}

impl Editor {
    /// As [`Self::drag`], until nothing moves any more; the grab is let go. What is not as it was wanted comes beside, in sentences.
    ///
    /// # Errors
    /// As there.
    pub fn settle(&mut self, grab: Grab, to: &[Vec3]) -> Result<(Grab, Vec<String>), EditError> {
        let mut settling = Settling::new(grab, to);
        while !settling.step(self)? {}
        Ok(settling.into_parts())
    }
}
