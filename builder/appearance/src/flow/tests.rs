use super::*;

/// A smooth pattern with detail of several sizes, 0 to 1.
fn pattern(x: f32, y: f32) -> f32 {
    let waves = [(0.31, 0.11, 0.3), (-0.13, 0.27, 1.1), (0.07, -0.05, 2.0), (0.55, 0.42, 0.7), (-0.4, 0.6, 1.9)];
    let sum: f32 = waves.iter().map(|&(a, b, c): &(f32, f32, f32)| (a * x + b * y + c).sin()).sum();
    0.5 + 0.09 * sum
}

/// A warp of up to `reach` texels that varies over the texture.
fn bend(reach: f32, x: f32, y: f32) -> (f32, f32) {
    (reach * (0.021 * x + 0.013 * y).sin(), reach * (0.017 * x - 0.019 * y + 1.0).cos())
}

fn plane(size: usize, value: impl Fn(f32, f32) -> f32) -> Vec<f32> {
    (0..size * size).map(|k| value((k % size) as f32, (k / size) as f32)).collect()
}

/// Mean distance of `flow` from the truth at texels where `counts`.
fn end_point_error(
    size: usize,
    flow: &Flow,
    truth: impl Fn(f32, f32) -> (f32, f32),
    counts: impl Fn(usize) -> bool,
) -> f64 {
    let errors: Vec<f64> = (0..size * size)
        .filter(|&k| counts(k))
        .map(|k| {
            let (x, y) = truth((k % size) as f32, (k / size) as f32);
            f64::from((flow.x[k] - x).hypot(flow.y[k] - y))
        })
        .collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

/// `template(x) = other(x + w(x))` holds exactly, for `other` is a pattern known everywhere.
fn bent_pair(size: usize, reach: f32) -> (Vec<f32>, Vec<f32>) {
    let template = plane(size, |x, y| {
        let (dx, dy) = bend(reach, x, y);
        pattern(x + dx, y + dy)
    });
    (template, plane(size, pattern))
}

#[test]
fn known_warps_are_found() {
    let size = 256;
    for (reach, bound) in [(0.4, 0.05), (3.0, 0.1), (5.0, 0.4)] {
        let (template, other) = bent_pair(size, reach);
        let grid = FlowGrid::new(&Charts::whole(size, size), FlowOptions::default());
        let flow = grid.flow(&grid.prepare(&template, None), &grid.prepare(&other, None));
        let error = end_point_error(size, &flow, |x, y| bend(reach, x, y), |_| true);
        let inner = end_point_error(
            size,
            &flow,
            |x, y| bend(reach, x, y),
            |k| (24..size - 24).contains(&(k % size)) && (24..size - 24).contains(&(k / size)),
        );
        println!("reach {reach}: error {error}, away from the edge {inner}");
        assert!(inner < bound, "reach {reach}: {inner}");
        assert!(error < 4.0 * bound, "reach {reach}: {error}");
    }
}

#[test]
fn a_texture_does_not_move_against_itself() {
    let size = 128;
    let values = plane(size, pattern);
    let grid = FlowGrid::new(&Charts::whole(size, size), FlowOptions::default());
    let prepared = grid.prepare(&values, None);
    let flow = grid.flow(&prepared, &prepared);
    assert!(flow.x.iter().chain(&flow.y).all(|w| w.abs() < 1e-3));
}

/// Two charts side by side that move in opposite directions.
fn two_charts(size: usize) -> Charts {
    let labels = (0..size * size).map(|k| if k % size < size / 2 { 1 } else { 2 }).collect();
    Charts { width: size, height: size, labels }
}

#[test]
fn charts_do_not_see_each_other() {
    let size = 128;
    let charts = two_charts(size);
    let grid = FlowGrid::new(&charts, FlowOptions::default());
    let half = (size / 2) as f32;
    let other = plane(size, pattern);
    let moved = plane(size, |x, y| if x < half { pattern(x - 1.5, y) } else { pattern(x + 1.5, y + 1.0) });
    // The right chart alone changes: the left one's flow must not.
    let also = plane(size, |x, y| if x < half { pattern(x - 1.5, y) } else { pattern(2.0 * x, y) });
    let other = grid.prepare(&other, None);
    let flow = grid.flow(&grid.prepare(&moved, None), &other);
    let changed = grid.flow(&grid.prepare(&also, None), &other);
    for k in (0..size * size).filter(|k| charts.labels[*k] == 1) {
        assert_eq!((flow.x[k], flow.y[k]), (changed.x[k], changed.y[k]), "texel {k}");
    }
    let truth = |x: f32, _: f32| if x < half { (-1.5, 0.0) } else { (1.5, 1.0) };
    let error = end_point_error(size, &flow, truth, |k| {
        (8..size - 8).contains(&(k % size)) && (8..size - 8).contains(&(k / size))
    });
    assert!(error < 0.12, "{error}");
}

#[test]
fn what_was_not_seen_does_not_pull() {
    let size = 128;
    let (mut template, other) = bent_pair(size, 2.0);
    let hidden = |k: usize| (50..70).contains(&(k % size)) && (50..70).contains(&(k / size));
    let seen: Vec<bool> = (0..size * size).map(|k| !hidden(k)).collect();
    for (k, value) in template.iter_mut().enumerate().filter(|(k, _)| hidden(*k)) {
        *value = 0.02 * (k % 7) as f32;
    }
    let grid = FlowGrid::new(&Charts::whole(size, size), FlowOptions::default());
    let other = grid.prepare(&other, None);
    let near = |k: usize| (46..74).contains(&(k % size)) && (46..74).contains(&(k / size));
    let error = |flow: &Flow| end_point_error(size, flow, |x, y| bend(2.0, x, y), near);
    let with = error(&grid.flow(&grid.prepare(&template, Some(&seen)), &other));
    let without = error(&grid.flow(&grid.prepare(&template, None), &other));
    assert!(with < 0.3 && with < 0.5 * without, "{with} {without}");
}

#[test]
fn instruction_sets_and_threads_give_the_same_bits() {
    let size = 200;
    let (template, other) = bent_pair(size, 3.0);
    let mut grid = FlowGrid::new(&two_charts(size), FlowOptions::default());
    let (template, other) = (grid.prepare(&template, None), grid.prepare(&other, None));
    let best = grid.flow(&template, &other);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| grid.flow(&template, &other)), best);
    }
    for level in Instructions::available() {
        grid.instructions = level;
        assert_eq!(grid.flow(&template, &other), best, "{level:?}");
    }
}
