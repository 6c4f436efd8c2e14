//! Gives a bundle made-up appearance, for the browser tests, and writes what some of its textures should be.
//!
//! `dress BUNDLE FOLDER SIZE`: writes `dressed.reprise`, and the RGBA of `half`, `direct`, `poisson` and `exact` for frame
//! 25 of it; `exact` is Poisson reconstruction to convergence. A fifth, `between`, lies 0.3 of the way from there to frame 60.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use shared::bundle::BundleReader;
use tests::dressed::{dress, texture};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [bundle, folder, size] = arguments.as_slice() else { bail!("usage: dress BUNDLE FOLDER SIZE") };
    let bytes = fs::read(bundle).with_context(|| format!("cannot read {bundle}"))?;
    let (dressed, _) = dress(&bytes, size.parse()?)?;
    let folder = Path::new(folder);
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let reader = BundleReader::from_bytes(&dressed)?;
    let still = (25, 25, 0.0);
    for (name, ends, half, cycles) in [
        ("half", still, true, 0),
        ("direct", still, false, 0),
        ("poisson", still, false, 1),
        ("exact", still, false, 12),
        ("between", (25, 60, 0.3), false, 0),
    ] {
        let (_, pixels) = texture(&reader, ends, half, cycles)?;
        fs::write(folder.join(format!("{name}.rgba")), pixels)?;
    }
    fs::write(folder.join("dressed.reprise"), dressed)?;
    Ok(())
}
