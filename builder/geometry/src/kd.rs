//! The nearest of many points, in any number of dimensions.

/// Points in a leaf.
const LEAF: usize = 8;

/// A tree over points; of two that are equally near, the first is found.
#[derive(Clone, Debug)]
pub struct KdTree<const D: usize> {
    nodes: Vec<Node>,
    points: Vec<[f32; D]>,
    /// The number of each of `points`, as they were given.
    numbers: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
enum Node {
    /// Points `first..end`.
    Leaf { first: u32, end: u32 },
    /// Along `axis`, what is at most `at` lies in the next node, what is at least that in node `above`.
    Split { axis: u32, at: f32, above: u32 },
}

impl<const D: usize> KdTree<D> {
    /// A tree over `points`; those with a coordinate that is no number are left out.
    #[must_use]
    pub fn new(points: &[[f32; D]]) -> Self {
        let finite = |&k: &u32| points[k as usize].iter().all(|x| x.is_finite());
        let mut numbers: Vec<u32> = (0..points.len() as u32).filter(finite).collect();
        let mut nodes = Vec::with_capacity(2 * points.len() / LEAF + 1);
        build(points, &mut numbers, 0, &mut nodes);
        let points = numbers.iter().map(|&k| points[k as usize]).collect();
        Self { nodes, points, numbers }
    }

    /// The number of the point nearest to `place` and the square of its distance; `None` where none is nearer than the square
    /// root of `within`.
    #[must_use]
    pub fn nearest(&self, place: [f32; D], within: f32) -> Option<(u32, f32)> {
        let mut best = (u32::MAX, within);
        if !self.points.is_empty() {
            self.search(0, place, &mut [0.0; D], 0.0, &mut best);
        }
        (best.0 != u32::MAX).then_some(best)
    }

    /// `beyond` holds for each axis how far the node lies from `place` along it, `least` the sum of their squares.
    fn search(&self, node: usize, place: [f32; D], beyond: &mut [f32; D], least: f32, best: &mut (u32, f32)) {
        match self.nodes[node] {
            Node::Leaf { first, end } => {
                for k in first as usize..end as usize {
                    let distance = squared_distance(self.points[k], place);
                    if distance < best.1 || distance == best.1 && self.numbers[k] < best.0 {
                        *best = (self.numbers[k], distance);
                    }
                }
            }
            Node::Split { axis, at, above } => {
                let axis = axis as usize;
                let side = place[axis] - at;
                let (near, far) = if side <= 0.0 { (node + 1, above as usize) } else { (above as usize, node + 1) };
                self.search(near, place, beyond, least, best);
                let before = beyond[axis];
                let further = least - before * before + side * side;
                if further <= best.1 {
                    beyond[axis] = side;
                    self.search(far, place, beyond, further, best);
                    beyond[axis] = before;
                }
            }
        }
    }
}

fn squared_distance<const D: usize>(a: [f32; D], b: [f32; D]) -> f32 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    sum
}

/// Orders `numbers`, which begin at `first` of all, and adds the nodes over them.
fn build<const D: usize>(points: &[[f32; D]], numbers: &mut [u32], first: u32, nodes: &mut Vec<Node>) {
    let node = nodes.len();
    nodes.push(Node::Leaf { first, end: first + numbers.len() as u32 });
    if numbers.len() <= LEAF {
        return;
    }
    let widest = (0..D).map(|axis| (axis, extent(points, numbers, axis)));
    let Some((axis, width)) = widest.max_by(|a, b| a.1.total_cmp(&b.1)) else { return };
    if width <= 0.0 {
        return;
    }
    let middle = numbers.len() / 2;
    let value = |k: u32| points[k as usize][axis];
    numbers.select_nth_unstable_by(middle, |&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
    let at = value(numbers[middle]);
    let (below, above) = numbers.split_at_mut(middle);
    build(points, below, first, nodes);
    nodes[node] = Node::Split { axis: axis as u32, at, above: nodes.len() as u32 };
    build(points, above, first + middle as u32, nodes);
}

fn extent<const D: usize>(points: &[[f32; D]], numbers: &[u32], axis: usize) -> f32 {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for &k in numbers {
        low = low.min(points[k as usize][axis]);
        high = high.max(points[k as usize][axis]);
    }
    high - low
}

#[cfg(test)]
mod tests {
    use kernels::random::signed;

    use super::*;

    #[test]
    fn finds_what_looking_at_all_finds() {
        let mut drawn = 0;
        let mut random = |most: f32| {
            drawn += 1;
            most * signed(7, drawn)
        };
        for count in [0, 1, 7, 9, 100, 3000] {
            // Coarse places, so that many points coincide.
            let points: Vec<[f32; 4]> = (0..count).map(|_| std::array::from_fn(|_| random(6.0).round())).collect();
            let tree = KdTree::new(&points);
            for _ in 0..200 {
                let place: [f32; 4] = std::array::from_fn(|_| random(9.0));
                for within in [f32::INFINITY, 4.0] {
                    let plain = (0..points.len() as u32)
                        .map(|k| (k, squared_distance(points[k as usize], place)))
                        .filter(|found| found.1 < within)
                        .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
                    assert_eq!(tree.nearest(place, within), plain);
                }
            }
        }
    }

    #[test]
    fn what_has_no_place_is_never_found() {
        let points = [[f32::NAN, 0.0], [f32::INFINITY, 0.0], [3.0, 4.0]];
        assert_eq!(KdTree::new(&points).nearest([0.0; 2], f32::INFINITY), Some((2, 25.0)));
        assert_eq!(KdTree::new(&points[..2]).nearest([0.0; 2], f32::INFINITY), None);
    }
}
