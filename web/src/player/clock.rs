//! Real time into frames: the capture's rate, the speed, and how far the picture is between two frames.

/// Longest stretch of real time that one tick makes up for, seconds: a page in the background does not race ahead.
const LONGEST_TICK: f64 = 0.25;

/// The player's clock.
#[derive(Clone, Debug)]
pub struct Clock {
    fps: f64,
    speed: f64,
    /// Part of the way from the frame before to the frame after, 0 to 1.
    weight: f64,
    /// Seconds played since the beginning, in the capture's time.
    played: f64,
}

impl Clock {
    /// At the beginning, for a capture of `fps` frames per second.
    #[must_use]
    pub fn new(fps: f32) -> Self {
        Self { fps: f64::from(fps), speed: 1.0, weight: 0.0, played: 0.0 }
    }

    /// Counts `fps` frames per second from now on; the speed stays.
    pub fn set_fps(&mut self, fps: f32) {
        self.fps = f64::from(fps);
    }

    /// Plays `speed` times as fast; between 0 and 8.
    pub fn set_speed(&mut self, speed: f64) {
        if speed.is_finite() {
            self.speed = speed.clamp(0.0, 8.0);
        }
    }

    /// Frames per second of the capture.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// Frames that `seconds` of real time make.
    #[must_use]
    pub fn frames_in(&self, seconds: f64) -> f64 {
        if seconds.is_finite() { seconds.clamp(0.0, LONGEST_TICK) * self.fps * self.speed } else { 0.0 }
    }

    /// Goes on by `frames`, at most to the next frame; gives back what is left.
    pub fn advance(&mut self, frames: f64) -> f64 {
        let step = frames.min(1.0 - self.weight);
        self.weight += step;
        self.played += step / self.fps;
        // Rounding must not leave a sliver before the frame.
        if self.weight > 1.0 - 1e-9 {
            self.weight = 1.0;
        }
        frames - step
    }

    /// Whether the frame after has been reached.
    #[must_use]
    pub fn at_next_frame(&self) -> bool {
        self.weight >= 1.0
    }

    /// Part of the way from the frame before to the frame after.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// Stands `weight` of the way between two frames.
    pub fn set_weight(&mut self, weight: f64) {
        self.weight = weight.clamp(0.0, 1.0);
    }

    /// Seconds played since the beginning.
    #[must_use]
    pub fn played(&self) -> f64 {
        self.played
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_add_up_to_frames() {
        let mut clock = Clock::new(25.0);
        clock.set_speed(2.0);
        let mut frames = 0;
        for _ in 0..600 {
            let mut left = clock.frames_in(1.0 / 60.0);
            while left > 0.0 {
                left = clock.advance(left);
                if clock.at_next_frame() {
                    clock.set_weight(0.0);
                    frames += 1;
                }
            }
        }
        assert!((499..=500).contains(&frames), "{frames}");
        assert!((clock.played() - 20.0).abs() < 1e-6);
    }

    #[test]
    fn odd_times_do_nothing() {
        let mut clock = Clock::new(25.0);
        clock.set_speed(f64::NAN);
        assert_eq!(clock.frames_in(f64::NAN), 0.0);
        assert_eq!(clock.frames_in(-1.0), 0.0);
        assert_eq!(clock.frames_in(1e9), LONGEST_TICK * 25.0);
    }
}
