//! The times as a table, and as JSON.

use bundle::Textures;
use serde_json::{Value, json};
use web::gpu::appearance::Setting;
use web::gpu::context::SAMPLES;

use crate::moments::Walk;
use crate::options::Options;
use crate::rounds::{Clock, Round};

/// What is printed.
pub struct Report<'a> {
    /// Where the times were taken.
    pub adapter: &'a wgpu::AdapterInfo,
    /// Whether passes were timed by the GPU's clock.
    pub timestamps: bool,
    /// What was shown.
    pub walk: &'a Walk,
    /// How.
    pub options: &'a Options,
    /// The times.
    pub rounds: &'a [Round],
}

impl Report<'_> {
    /// A table for people.
    pub fn table(&self) -> String {
        let [width, height] = self.options.size;
        let mut text = format!("adapter  {}\nactor    {}\n", self.device(), self.actor());
        text += &format!("picture  {width} x {height}, {SAMPLES} samples a pixel\n");
        if !self.timestamps {
            text += "\nThis adapter has no timestamp queries: single passes cannot be timed. What follows is the processor's \
                     clock,\nfrom the first command until the device had done all of them.\n";
        }
        text += &format!(
            "\n{:<36}{:<9}{:<11}{:>6}{:>12}{:>10}\n",
            "pass", "setting", "clock", "frames", "median ms", "95 % ms"
        );
        for round in self.rounds {
            for row in &round.rows {
                text += &format!(
                    "{:<36}{:<9}{:<11}{:>6}{:>12.3}{:>10.3}\n",
                    row.name,
                    word(round.setting),
                    row.clock.word(),
                    row.times.len(),
                    percentile(&row.times, 50),
                    percentile(&row.times, 95)
                );
            }
        }
        text
    }

    /// The same for programs.
    pub fn json(&self) -> Value {
        let rows = self.rounds.iter().flat_map(|round| {
            round.rows.iter().map(|row| {
                json!({
                    "pass": row.name,
                    "setting": round.setting.map(Setting::word),
                    "clock": row.clock.word(),
                    "frames": row.times.len(),
                    "median_ms": percentile(&row.times, 50),
                    "p95_ms": percentile(&row.times, 95),
                })
            })
        });
        let adapter = json!({
            "name": self.adapter.name,
            "backend": self.adapter.backend.to_str(),
            "software": software(self.adapter),
            "driver": self.adapter.driver,
            "driver_info": self.adapter.driver_info,
        });
        let [width, height] = self.options.size;
        json!({
            "adapter": adapter,
            "actor": self.walk.player.info(),
            "picture": { "width": width, "height": height, "samples": SAMPLES },
            "timestamp_queries": self.timestamps,
            "rows": rows.collect::<Vec<_>>(),
        })
    }

    fn device(&self) -> String {
        let wgpu::AdapterInfo { name, driver, driver_info, backend, .. } = self.adapter;
        let software = if software(self.adapter) { "; in software: its times say nothing about a GPU" } else { "" };
        let driver = format!("{driver} {driver_info}");
        let driver = match driver.trim() {
            "" => String::new(),
            driver => format!(", driver {driver}"),
        };
        format!("{name}, {backend}{driver}{software}")
    }

    fn actor(&self) -> String {
        let player = &self.walk.player;
        let Some(actor) = player.actor() else { return String::new() };
        let shape = format!(
            "{}, {} frames, {} vertices, {} triangles",
            actor.name,
            actor.timeline.frame_count(),
            actor.topology.vertex_count(),
            actor.topology.triangles().len()
        );
        match player.appearance(Textures::Aligned) {
            Some(appearance) => {
                let full = appearance.mask.full();
                let [colours, warps] = [0, 1].map(|layer| appearance.layers[layer].mode_count());
                let size = format!("{} x {}", full.width, full.height);
                format!("{shape}, texture of {size} from {colours} colour and {warps} warp modes")
            }
            None => format!("{shape}; it has no texture modes, so that none is rebuilt"),
        }
    }
}

impl Clock {
    fn word(self) -> &'static str {
        match self {
            Self::Gpu => "gpu",
            Self::Processor => "processor",
            Self::Wall => "wall",
        }
    }
}

fn word(setting: Option<Setting>) -> &'static str {
    setting.map_or("", Setting::word)
}

fn software(adapter: &wgpu::AdapterInfo) -> bool {
    adapter.device_type == wgpu::DeviceType::Cpu
}

/// The smallest of `times` that `percent` of them do not exceed; 0 where there are none.
fn percentile(times: &[f64], percent: usize) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (times.len() * percent).div_ceil(100);
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::percentile;

    #[test]
    fn percentiles_are_times_that_were_taken() {
        let times: Vec<f64> = (1..=20).rev().map(f64::from).collect();
        assert_eq!([percentile(&times, 50), percentile(&times, 95)], [10.0, 19.0]);
        assert_eq!([percentile(&times[..1], 50), percentile(&times[..1], 95)], [20.0, 20.0]);
        assert_eq!(percentile(&[], 50), 0.0);
    }
}
