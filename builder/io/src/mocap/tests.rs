//! Readers of motion capture: what they agree on, and what they refuse.

