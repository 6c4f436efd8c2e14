//! Plans that are kept: a pose that is looked at, then clicked, is planned once.

use std::rc::Rc;

use actor::walk::Walk;
use kernels::align::Placement;

/// Most plans that are kept: those of the poses that are suggested around the actor, and some more.
const KEPT: usize = 64;

/// Plans by where they begin and end.
#[derive(Default)]
pub(super) struct Plans {
    kept: Vec<Plan>,
    searches: u64,
}

/// The way from one frame to another.
struct Plan {
    from: u32,
    to: u32,
    /// `None` where there is none.
    walk: Option<Rc<Walk>>,
    /// A placement at which it was begun, and the one at which it arrives then.
    arrival: Option<[Placement; 2]>,
}

impl Plans {
    /// Searches so far.
    pub fn searches(&self) -> u64 {
        self.searches
    }

    /// What `search` finds, counted.
    pub fn search(&mut self, search: impl FnOnce() -> Option<Walk>) -> Option<Rc<Walk>> {
        self.searches += 1;
        search().map(Rc::new)
    }

    /// The walk between two frames, by `search` unless it is known.
    pub fn walk(&mut self, from: u32, to: u32, search: impl FnOnce() -> Option<Walk>) -> Option<Rc<Walk>> {
        match self.find(from, to) {
            Some(plan) => plan.walk.clone(),
            None => {
                let walk = self.search(search);
                self.keep(from, to, walk.clone());
                walk
            }
        }
    }

    /// Keeps a walk; the oldest one makes room where there are too many.
    pub fn keep(&mut self, from: u32, to: u32, walk: Option<Rc<Walk>>) {
        if self.find(from, to).is_some() {
            return;
        }
        if self.kept.len() == KEPT {
            self.kept.remove(0);
        }
        self.kept.push(Plan { from, to, walk, arrival: None });
    }

    /// Keeps none of them.
    pub fn forget(&mut self) {
        self.kept.clear();
    }

    /// Where a walk that is kept arrives, begun at `start`; `None` where that is not known.
    pub fn arrival(&mut self, from: u32, to: u32, start: Placement) -> Option<Placement> {
        let [begun, arrival] = self.find(from, to)?.arrival?;
        (begun == start).then_some(arrival)
    }

    /// Keeps where a walk arrives: the placement at which it begins, and that at which it ends.
    pub fn keep_arrival(&mut self, from: u32, to: u32, arrival: [Placement; 2]) {
        if let Some(plan) = self.find(from, to) {
            plan.arrival = Some(arrival);
        }
    }

    fn find(&mut self, from: u32, to: u32) -> Option<&mut Plan> {
        self.kept.iter_mut().find(|plan| (plan.from, plan.to) == (from, to))
    }
}
