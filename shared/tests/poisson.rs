//! Poisson interpolation against a plain solution in double precision.

mod common;

use common::exact::{self, Exact};
use glam::{DVec3, Vec3};
use shared::poisson::{GUARANTEE, KeyedPose, PoissonInterpolator};
use shared::topology::Topology;

#[test]
fn try_crane() {
    let Some(crane) = common::captured("crane", &[0, 60, 120]) else { return };
    let (topology, poses) = (&crane.0, &crane.1);
    let exact = Exact::new(topology);
    let mut interpolator = PoissonInterpolator::new(topology, None).unwrap();
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    let aligned = common::aligned(topology, &poses[0], &poses[2]);
    for step in 0..=10 {
        let lambda = step as f32 / 10.0;
        let t = std::time::Instant::now();
        let effort = interpolator
            .interpolate(KeyedPose { frame: 0, pose: &poses[0] }, KeyedPose { frame: 120, pose: &aligned }, lambda, &mut out)
            .unwrap();
        let t = t.elapsed();
        let truth = exact.interpolate(&poses[0], &aligned, f64::from(lambda));
        println!("{lambda} {effort:?} {t:?} error {:.2e} sides {:.2e} volume {:.4}", common::largest_difference(&out, &truth.blended), truth.sides_differ, exact::volume(topology, &truth.blended));
    }
}
