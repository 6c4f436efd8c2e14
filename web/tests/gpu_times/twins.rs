//! The passes that rebuild a texture against their twins on the processor (`texture::dealign`, `texture::basis`).

use std::sync::{Arc, Mutex};

use bundle::{Appearance, Textures};
use libtest_mimic::{Completion, Failed};
use texture::basis::Mode;
use texture::dealign::Aligned;
use texture::mask::ACTIVE;
use web::gpu::appearance::{Setting, TextureRebuild, Wanted};
use web::gpu::readback::read;
use web::gpu::scene::Scene;
use web::gpu::timing::Lap;
use web::player::Player;
use web::player::loading::Loading;

use crate::actor;
use crate::open::{self, Opened};

pub fn textures_are_rebuilt() -> Result<Completion, Failed> {
    let Some(opened) = open::open(None)? else { return Ok(Completion::ignored_with(open::NO_ADAPTER)) };
    let Opened { gpu, adapter, stopwatch } = opened;
    let bytes = actor::bundle();
    let mut player = Player::new(Loading::default(), || 0.0);
    player.push(&bytes)?;
    while player.refine(f64::INFINITY)? {}
    let shown = player.actor().unwrap();
    let triangles = shown.topology.triangles().to_vec();
    let mut scene = Scene::new(gpu.clone(), &shown.surface, triangles, player.reference_pose());
    let appearance = player.appearance(Textures::Aligned).unwrap();
    let modes = player.modes(Textures::Aligned);
    let mut looks = TextureRebuild::new(&gpu, appearance, scene.mesh.textures(), false, || 1.0);
    looks.take(&gpu, modes);
    for (setting, most) in [(Setting::Half, 1), (Setting::Direct, 1), (Setting::Poisson, 2)] {
        for frame in [0, 7, actor::FRAMES - 1] {
            looks.keep(Some(setting));
            let what = format!("{}: {setting:?}, frame {frame}", adapter.name);
            let weights = [0, 1].map(|layer| appearance.layers[layer].weights(frame, frame, 0.0));
            assert!(looks.show(&gpu, &mut scene.mesh, Wanted::Interpolated(weights)), "{what}");
            let size = [looks.texture().width(), looks.texture().height()];
            let pixels = Arc::new(Mutex::new(None));
            let told = Arc::clone(&pixels);
            read(&gpu, looks.texture(), size, false, move |bytes| *told.lock().unwrap() = bytes);
            gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
            let pixels = pixels.lock().unwrap().take().expect("the texture comes back");
            compare(&pixels, &texture(appearance, modes, frame, setting), most, &what);
            // The times are those of this rebuild: it ends in one picture of the texture.
            let laps = stopwatch.as_ref().map(|stopwatch| stopwatch.laps(&gpu.device, &gpu.queue)).transpose()?;
            let ends = |laps: &Vec<Lap>| laps.iter().filter(|lap| lap.name == "reprise.texture.pass").count();
            assert!(laps.as_ref().is_none_or(|laps| laps.is_empty() || ends(laps) == 1), "{what}: {laps:?}");
        }
    }
    assert!(!gpu.lost());
    Ok(Completion::Completed)
}

/// Texels in sRGB, 0 to 255, of the texture of `frame` as the processor makes it; `None` where nothing is active.
fn texture(appearance: &Appearance, modes: &[Vec<Mode>; 2], frame: u32, setting: Setting) -> Vec<Option<[f32; 3]>> {
    let half = setting == Setting::Half;
    let rebuild = |layer: usize, side: usize| {
        let own = &appearance.layers[layer];
        own.rebuild(&appearance.mask, &modes[layer], &own.weights(frame, frame, 0.0), side)
    };
    let aligned = Aligned {
        texture: rebuild(0, if half { 8 } else { 16 }),
        warp: rebuild(1, 16),
        texel: if half { 2.0 } else { 1.0 },
        cell: (1 << appearance.layers[1].level) as f32,
        fill: [0.5; 3],
    };
    let level = &appearance.mask.levels[usize::from(half)];
    let colours = aligned.dealign(&appearance.mask, usize::from(setting == Setting::Poisson));
    let active = level.flags.iter().map(|flags| flags & ACTIVE != 0);
    let bytes = colours.iter().map(|colour| colour.map(|value| value.clamp(0.0, 1.0) * 255.0));
    active.zip(bytes).map(|(active, colour)| active.then_some(colour)).collect()
}

/// As strict as the browser's test of the same: where a warp ends between two texels of a chart's border, rounding decides
/// which of them is read.
fn compare(pixels: &[u8], wanted: &[Option<[f32; 3]>], most: u8, what: &str) {
    assert_eq!(pixels.len(), 4 * wanted.len(), "{what}");
    let (mut count, mut over, mut worst) = (0, 0, 0);
    for (pixel, wanted) in pixels.chunks_exact(4).zip(wanted) {
        for (own, wanted) in pixel.iter().zip(wanted.iter().flatten()) {
            let apart = own.abs_diff(wanted.round() as u8);
            (count, over, worst) = (count + 1, over + usize::from(apart > most), worst.max(apart));
        }
    }
    assert!(count > 1_000, "{what}: {count} values");
    assert!(over * 1_000 <= count && worst <= 16, "{what}: {over} of {count} values are off, at most {worst}");
}
