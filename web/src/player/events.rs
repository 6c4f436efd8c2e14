//! What happened since the page last asked.

use serde::Serialize;

/// Something that the page may want to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Event {
    /// The first synthesised frame of a transition is shown.
    TransitionStart {
        /// Frame that it leaves from.
        from: u32,
        /// Frame that it arrives at.
        to: u32,
    },
    /// The transition is over.
    TransitionEnd {
        /// Frame that it left from.
        from: u32,
        /// Frame that it arrived at.
        to: u32,
    },
    /// The target is reached; the actor stands in it.
    Arrive {
        /// The target.
        frame: u32,
    },
    /// The next frame has not been loaded: the actor waits. Said once per wait.
    Stall {
        /// The frame it waits for.
        frame: u32,
    },
    /// The recording ends here, and nothing goes on.
    End {
        /// The last frame.
        frame: u32,
    },
}

/// Most events kept for a page that never asks.
const MOST: usize = 1024;

/// Events in order.
#[derive(Clone, Debug, Default)]
pub struct Events(Vec<Event>);

impl Events {
    /// Adds `event`; the oldest makes room where too many wait.
    pub fn push(&mut self, event: Event) {
        if self.0.len() == MOST {
            self.0.remove(0);
        }
        self.0.push(event);
    }

    /// All of them, once.
    pub fn take(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_reads_them_as_json() {
        let events = [Event::TransitionStart { from: 1, to: 2 }, Event::Arrive { frame: 2 }];
        let json = serde_json::to_string(&events).unwrap();
        assert_eq!(json, r#"[{"type":"transitionstart","from":1,"to":2},{"type":"arrive","frame":2}]"#);
    }
}
