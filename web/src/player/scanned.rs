//! Frames as they were scanned: which of them is shown in place of the registered mesh, and which will be wanted soon.
//!
//! The player knows no scanned mesh: a page fetches groups of them, and the stage draws what has come in time.

use bundle::{BundleError, ScannedHead, ScannedIndex};
use kernels::align::Placement;
use synthesis::{FrameKind, Step};

use super::Player;
use super::produce::ShownFrame;

/// Steps ahead that are looked at for what will be wanted.
const AHEAD: usize = 48;
/// Frames over which a scan gives way to the registered mesh before the last one of it is shown, and comes back after the first.
pub(super) const FADE: u32 = 6;
/// Bytes of the graphics device's memory that scanned frames may take, more or less.
const ROOM: u64 = 192 << 20;
/// Groups that are held at least and at most, whatever their size.
const HELD: (u64, u64) = (3, 16);

/// A scanned frame where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanShown {
    /// Its group, and which of its frames it is.
    pub place: (u32, u32),
    /// The recorded frame.
    pub frame: u32,
    /// Equal numbers are equal poses.
    pub number: u64,
    /// The world from the scan.
    pub placement: Placement,
    /// How much of it is seen, the rest being the registered mesh in the same pose: 1 but near where one gives way to the other.
    pub share: f32,
}

impl Player {
    /// Which scanned frames the actor has; `None` where it has none, or they have not been told yet.
    #[must_use]
    pub fn scans(&self) -> Option<&ScannedIndex> {
        self.loading.reader()?.scanned()
    }

    /// The scanned frame that stands for what is shown: that of the nearer frame, where that is a recorded one that was neither edited
    /// nor varied, nor driven.
    #[must_use]
    pub fn scan(&self) -> Option<ScanShown> {
        let nearer = self.nearer()?;
        let (frame, place) = self.scan_of(nearer)?;
        Some(ScanShown { place, frame, number: nearer.number, placement: nearer.placement, share: self.scan_share() })
    }

    /// The recorded frame that `shown` is as it was recorded, and where its scan is, where there is one.
    fn scan_of(&self, shown: &ShownFrame) -> Option<(u32, (u32, u32))> {
        let FrameKind::Recorded { frame } = shown.kind else { return None };
        let place = self.scans()?.place_of(frame).filter(|_| shown.as_recorded)?;
        Some((frame, place))
    }

    /// How much of the scan is seen: less the nearer the frames are that have none, on both sides. What was jumped over does not count,
    /// and where the actor stands the scan is seen as it is.
    fn scan_share(&self) -> f32 {
        let Some(picture) = self.picture().filter(|_| self.playing) else { return 1.0 };
        let has_scan = |frame: &Option<u32>| {
            frame.is_some_and(|frame| {
                self.loading.source.as_recorded(frame)
                    && self.scans().is_some_and(|scans| scans.place_of(frame).is_some())
            })
        };
        // The one gives way to the other halfway between two frames.
        let weight = picture.weight as f32;
        let coming = self.coming(FADE as usize + 1);
        let ahead =
            coming.iter().position(|frame| !has_scan(frame)).map_or(FADE as f32, |steps| steps as f32 + 0.5 - weight);
        let behind = self.scans_behind as f32 - 0.5 + weight;
        (ahead.min(behind) / FADE as f32).clamp(0.0, 1.0)
    }

    /// Takes note that `last` is what the picture comes from now: after what came before it, or jumped to.
    pub(super) fn note_scan(&mut self, jumped: bool) {
        let scanned = self.last.as_ref().is_some_and(|last| self.scan_of(last).is_some());
        self.scans_behind = match (scanned, jumped) {
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
        let shown = self.nearer().map(|shown| shown.kind.frame());
        for frame in shown.into_iter().chain(self.coming(AHEAD).into_iter().flatten()) {
            if !want(frame) {
                break;
            }
        }
        groups
    }

    /// What comes after the frame that the picture comes from, at most `most` steps: recorded frames of the route, nothing where one is made,
    /// and behind its end those of the recording.
    fn coming(&self, most: usize) -> Vec<Option<u32>> {
        let Some(actor) = &self.loading.actor else { return Vec::new() };
        let recorded = |kind: FrameKind| (!kind.is_synthetic()).then(|| kind.frame());
        let mut frames: Vec<Option<u32>> = self.next.iter().map(|shown| recorded(shown.kind)).collect();
        frames.extend(self.given.iter().map(|shown| recorded(shown.kind).filter(|_| shown.as_recorded)));
        let (Some(walker), Some(graph)) = (self.producer.walker(), self.graph(actor)) else { return frames };
        let mut walker = walker.clone();
        while let (Some(step), true) = (walker.next(&actor.timeline), frames.len() < most) {
            let transitions = graph.transitions();
            walker.take(&graph, &actor.timeline);
            frames.push(match step {
                Step::Forward(frame) | Step::Back(frame) => Some(frame),
                // The last node of a transition is the frame that it arrives at.
                Step::Node { transition, .. } if walker.inside().is_none() => {
                    transitions.get(transition as usize).map(|transition| transition.to)
                }
                Step::Node { .. } => None,
            });
        }
        let end = walker.departure(&graph);
        let on = std::iter::successors(actor.timeline.next(end), |&frame| actor.timeline.next(frame));
        frames.extend(on.take(most.saturating_sub(frames.len())).map(Some));
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

/// Bytes of a group while it is held: its mesh, its poses, its images with their smaller levels.
fn bytes_of(head: &ScannedHead) -> u64 {
    let texels: u64 = head.images.iter().map(|&(_, width, height)| u64::from(width) * u64::from(height)).sum();
    let poses = u64::from(head.vertices) * u64::from(head.frames);
    texels * 16 / 3 + u64::from(head.corners) * 16 + u64::from(head.triangles) * 24 + poses * 12
}
