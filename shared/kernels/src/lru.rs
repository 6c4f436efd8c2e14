//! A cache of a handful of things by frame, of which the least recently used gives way.

/// Up to a number of things, each of a frame.
#[derive(Clone)]
pub struct LruCache<T> {
    slots: Vec<Slot<T>>,
    most: usize,
    clock: u64,
}

#[derive(Clone)]
struct Slot<T> {
    frame: u32,
    used: u64,
    thing: T,
}

impl<T: Default> LruCache<T> {
    /// Room for `most` things.
    pub fn new(most: usize) -> Self {
        Self { slots: Vec::new(), most, clock: 0 }
    }

    /// Slot of the thing of `frame`.
    pub fn find(&mut self, frame: u32) -> Option<usize> {
        let index = self.slots.iter().position(|slot| slot.frame == frame)?;
        self.touch(index);
        Some(index)
    }

    /// Slot of the thing whose frame is nearest.
    pub fn nearest(&mut self, frame: u32) -> Option<usize> {
        let index = (0..self.slots.len()).min_by_key(|&index| self.slots[index].frame.abs_diff(frame))?;
        self.touch(index);
        Some(index)
    }

    /// A slot for `frame`, which has none yet: a new one, or that of the thing used longest ago, to be overwritten.
    pub fn claim(&mut self, frame: u32) -> usize {
        let index = if self.slots.len() < self.most {
            self.slots.push(Slot { frame, used: 0, thing: T::default() });
            self.slots.len() - 1
        } else {
            (0..self.slots.len()).min_by_key(|&index| self.slots[index].used).unwrap_or(0)
        };
        self.slots[index].frame = frame;
        self.touch(index);
        index
    }

    /// The thing in a slot.
    pub fn get(&self, index: usize) -> &T {
        &self.slots[index].thing
    }

    /// The thing in a slot.
    pub fn get_mut(&mut self, index: usize) -> &mut T {
        &mut self.slots[index].thing
    }

    /// Frees a slot. The last slot takes its number.
    pub fn forget(&mut self, index: usize) {
        self.slots.swap_remove(index);
    }

    fn touch(&mut self, index: usize) {
        self.clock += 1;
        self.slots[index].used = self.clock;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_longest_ago_gives_way() {
        let mut cache = LruCache::<u32>::new(2);
        for frame in [10, 20] {
            let slot = cache.claim(frame);
            *cache.get_mut(slot) = 7 * frame;
        }
        assert!(cache.find(10).is_some());
        let slot = cache.claim(30);
        assert_eq!(*cache.get(slot), 140, "the slot of frame 20, to be overwritten");
        assert_eq!(cache.find(20), None);
        assert_eq!(cache.nearest(31), Some(slot));
        // Being found or near counts as use: frame 10 has not been since.
        let slot = cache.claim(40);
        assert_eq!(*cache.get(slot), 70);
        cache.forget(slot);
        assert_eq!(cache.find(40), None);
        assert!(cache.find(30).is_some());
    }
}
