//! Frames as they were scanned: which of them is shown in place of the registered mesh, and which will be wanted soon.
//!
//! The player knows no scanned mesh: a page fetches groups of them, and the stage draws what has come in time.

use bundle::{BundleError, ScannedHead, ScannedIndex};
use synthesis::{FrameKind, Step};

use super::Player;
use super::loading::Origin;
use super::produce::ShownFrame;
use crate::brought::Brought;

/// Steps ahead that are looked at for what will be wanted.
const AHEAD: usize = 48;
/// Frames over which a scan gives way to the registered mesh before the last one of it is shown, and comes back after the first.
pub(super) const FADE: u32 = 6;
/// Bytes of the graphics device's memory that scanned frames may take, more or less.
const ROOM: u64 = 192 << 20;
/// Groups that are held at least and at most, whatever their size.
const HELD: (u64, u64) = (3, 16);

/// A scanned frame that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanShown {
    /// Its group, and which of its frames it is.
    pub place: (u32, u32),
    /// The recorded frame.
    pub frame: u32,
    /// How it is brought to where it is shown.
    pub brought: Brought,
    /// How much of it is seen, the rest being another one or the registered mesh in the same pose.
    pub share: f32,
}

/// A step that is to come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Coming {
    /// A recorded frame.
    Recorded(u32),
    /// Within a transition of the graph.
    Node,
    /// Made elsewhere.
    Made,
}

impl Player {
    /// Which scanned frames the actor has; `None` where it has none, or they have not been told yet.
    #[must_use]
    pub fn scans(&self) -> Option<&ScannedIndex> {
        self.loading.reader()?.scanned()
    }

    /// The scanned frames that stand for what is shown: that of the nearer frame, where that is a recorded one and not driven, carried by
    /// the registered mesh where it was edited or varied; within a transition those of its two ends, carried from the one to the other.
    #[must_use]
    pub fn scan(&self) -> [Option<ScanShown>; 2] {
        let Some(nearer) = self.nearer() else { return [None; 2] };
        if let FrameKind::Synthetic { transition, .. } = nearer.kind {
            return self.carried_scans(transition);
        }
        let brought = match nearer.origin {
            Origin::Changed => Brought::Changed(nearer.placement),
            _ => Brought::Placed(nearer.number, nearer.placement),
        };
        let shown = self.scan_of(nearer);
        [shown.map(|(frame, place)| ScanShown { place, frame, brought, share: self.scan_share() }), None]
    }

    /// The scans of both ends of `transition`, by as much of each as the blend has of its pose.
    fn carried_scans(&self, transition: u32) -> [Option<ScanShown>; 2] {
        let Some(picture) = self.picture() else { return [None; 2] };
        let lambda = |shown: &ShownFrame, at_end: f32| match shown.kind {
            FrameKind::Synthetic { transition: of, lambda, .. } if of == transition => lambda,
            _ => at_end,
        };
        let (from, to) = (lambda(picture.before, 0.0), lambda(picture.after, 1.0));
        let lambda = (to - from).mul_add(picture.weight as f32, from);
        let Some(ends) = self.ends_of(transition) else { return [None; 2] };
        let brought = Brought::Blended;
        let shown = |frame: u32, share: f32| Some(ScanShown { place: self.scan_at(frame)?, frame, brought, share });
        [shown(ends[0], 1.0 - lambda), shown(ends[1], lambda)]
    }

    /// The frames that `transition` of the graph leaves and arrives at.
    fn ends_of(&self, transition: u32) -> Option<[u32; 2]> {
        let graph = self.loading.graph.as_ref()?;
        graph.transitions().get(transition as usize).map(|transition| [transition.from, transition.to])
    }

    /// Where the scan of recorded frame `frame` is, if it has one.
    fn scan_at(&self, frame: u32) -> Option<(u32, u32)> {
        self.scans()?.place_of(frame)
    }

    /// The recorded frame that `shown` is, and where its scan is, where there is one.
    fn scan_of(&self, shown: &ShownFrame) -> Option<(u32, (u32, u32))> {
        let FrameKind::Recorded { frame } = shown.kind else { return None };
        (shown.origin != Origin::Made).then_some((frame, self.scan_at(frame)?))
    }

    /// How much of the scan is seen: less the nearer the frames are that have none, on both sides; but a transition carries it. What was
    /// jumped over does not count, and where the actor stands the scan is seen as it is.
    fn scan_share(&self) -> f32 {
        let Some(picture) = self.picture().filter(|_| self.playing) else { return 1.0 };
        // The one gives way to the other halfway between two frames.
        let weight = picture.weight as f32;
        let coming = self.coming(FADE as usize + 1);
        let gone = |frame: &Coming| !matches!(frame, Coming::Recorded(frame) if self.scan_at(*frame).is_some());
        let ahead = match coming.iter().position(gone) {
            Some(steps) if !matches!(coming[steps], Coming::Node) => steps as f32 + 0.5 - weight,
            _ => FADE as f32,
        };
        let behind = self.scans_behind as f32 - 0.5 + weight;
        (ahead.min(behind) / FADE as f32).clamp(0.0, 1.0)
    }

    /// Takes note that `last` is what the picture comes from now: after what came before it, or jumped to.
    pub(super) fn note_scan(&mut self, jumped: bool) {
        let Some(last) = &self.last else { return };
        let carried = match last.kind {
            FrameKind::Synthetic { transition, .. } => {
                self.ends_of(transition).is_some_and(|[_, to]| self.scan_at(to).is_some())
            }
            FrameKind::Recorded { .. } => false,
        };
        self.scans_behind = match (self.scan_of(last).is_some(), jumped || carried) {
            (_, true) if carried => FADE + 1,
            (false, _) => 0,
            (true, true) => FADE + 1,
            (true, false) => self.scans_behind.saturating_add(1),
        };
    }

    /// The groups that are shown and will be on the route, the most urgent first: at most as many as are held.
    #[must_use]
    pub fn scans_ahead(&self) -> Vec<u32> {
        let Some(index) = self.scans() else { return Vec::new() };
        let most = held(&index.groups) as usize;
        let mut groups: Vec<u32> = Vec::new();
        let mut want = |frame: u32| {
            let group = index.place_of(frame).map(|(group, _)| group);
            groups.extend(group.filter(|group| !groups.contains(group)));
            groups.len() < most
        };
        let carried = self.scan().into_iter().flatten().map(|scan| scan.frame);
        let shown = carried.chain(self.nearer().map(|shown| shown.kind.frame()));
        let coming = self.coming(AHEAD).into_iter().filter_map(|frame| match frame {
            Coming::Recorded(frame) => Some(frame),
            _ => None,
        });
        for frame in shown.chain(coming) {
            if !want(frame) {
                break;
            }
        }
        groups
    }

    /// What comes after the frame that the picture comes from, at most `most` steps: those of the route, and behind its end frames of the
    /// recording.
    fn coming(&self, most: usize) -> Vec<Coming> {
        let Some(actor) = &self.loading.actor else { return Vec::new() };
        let told = |shown: &ShownFrame| match shown.kind {
            FrameKind::Recorded { frame } => Coming::Recorded(frame),
            FrameKind::Synthetic { transition, .. } if self.ends_of(transition).is_some() => Coming::Node,
            FrameKind::Synthetic { .. } => Coming::Made,
        };
        let mut frames: Vec<Coming> = self.next.iter().map(told).collect();
        frames.extend(
            self.given.iter().map(|shown| if shown.origin == Origin::Made { Coming::Made } else { told(shown) }),
        );
        let (Some(walker), Some(graph)) = (self.producer.walker(), self.graph(actor)) else { return frames };
        let mut walker = walker.clone();
        while let (Some(step), true) = (walker.next(&actor.timeline), frames.len() < most) {
            walker.take(&graph, &actor.timeline);
            frames.push(match step {
                Step::Forward(frame) | Step::Back(frame) => Coming::Recorded(frame),
                // The last node of a transition is the frame that it arrives at.
                Step::Node { transition, .. } => match self.ends_of(transition) {
                    Some([_, to]) if walker.inside().is_none() => Coming::Recorded(to),
                    _ => Coming::Node,
                },
            });
        }
        let end = walker.departure(&graph);
        let on = std::iter::successors(actor.timeline.next(end), |&frame| actor.timeline.next(frame));
        frames.extend(on.take(most.saturating_sub(frames.len())).map(Coming::Recorded));
        frames
    }

    /// The first byte and the bytes of group `ordinal` in the bundle; those of the first one say where all of them begin.
    #[must_use]
    pub fn scan_section(&self, ordinal: u32) -> Option<(u64, u64)> {
        self.loading.reader()?.header()?.scanned_group(ordinal)
    }

    /// What the index tells of group `ordinal`, once `bytes` are found to be its section: what the module needs that reads it.
    ///
    /// # Errors
    /// They are not, or are damaged.
    pub fn scan_head(&self, ordinal: u32, bytes: &[u8]) -> Result<Vec<u32>, BundleError> {
        let (Some(reader), Some(index)) = (self.loading.reader(), self.scans()) else { return Ok(Vec::new()) };
        reader.check_scanned_group(ordinal, bytes)?;
        Ok(index.groups.get(ordinal as usize).map_or(Vec::new(), |head| head.words().collect()))
    }
}

/// How many groups are held: as many as there is room for.
fn held(groups: &[ScannedHead]) -> u64 {
    let largest = groups.iter().map(bytes_of).max().unwrap_or(1).max(1);
    (ROOM / largest).clamp(HELD.0, HELD.1)
}

/// Bytes of a group while it is held: its mesh, its poses and what carries them, its images with their smaller levels.
fn bytes_of(head: &ScannedHead) -> u64 {
    let texels: u64 = head.images.iter().map(|&(_, width, height)| u64::from(width) * u64::from(height)).sum();
    let poses = u64::from(head.vertices) * u64::from(head.frames);
    texels * 16 / 3 + u64::from(head.corners) * 16 + u64::from(head.triangles) * 24 + poses * 36
}
