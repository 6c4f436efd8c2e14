//! What is done again and again allocates nothing.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod systems;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use kernels::cholesky::{
    ConstrainedFactor, Constraints, EliminationOrder, Factor, Real, SolveScratch, Symbolic, SymmetricPattern, Workspace,
};
use systems::{Random, positive, sheet};

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: all is done by the system's allocator; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> usize {
    ALLOCATIONS.with(Cell::get)
}

fn check<S: Real>() {
    let n = 63;
    let pattern = SymmetricPattern::from_triangles(n, &sheet(9, 7)).unwrap();
    let mut random = Random::new(2);
    let matrices = [positive(&pattern, 0.5, &mut random), positive(&pattern, 0.5, &mut random)];
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
    let (mut workspace, mut scratch) = (Workspace::default(), SolveScratch::<S>::default());
    let mut factor = Factor::<S>::default();
    let mut constraints = Constraints::new();
    constraints.hard(5);
    constraints.soft(60, 3.0);
    let mut constrained = ConstrainedFactor::<S>::new(&symbolic, &matrices[0], &constraints, &mut workspace).unwrap();
    let (mut x, wanted) = (vec![S::from_f64(1.0); 6 * n], vec![S::from_f64(0.5); 12]);
    let before = allocations();
    let mut after_the_first = 0;
    for (round, matrix) in matrices.iter().cycle().take(6).enumerate() {
        symbolic.refactorise(matrix, &mut workspace, &mut factor).unwrap();
        symbolic.update(&mut factor, 2.0, &[(3, 1.0), (4, -1.0)], &mut workspace).unwrap();
        symbolic.update(&mut factor, -2.0, &[(3, 1.0), (4, -1.0)], &mut workspace).unwrap();
        constrained.refactorise(&symbolic, matrix, &constraints, &mut workspace).unwrap();
        constrained.set_weight(&symbolic, 60, 5.0, &mut workspace).unwrap();
        for k in [1, 3, 6] {
            symbolic.solve(&factor, &mut x[..k * n], k, &mut scratch).unwrap();
            constrained.solve(&symbolic, &wanted[..2 * k], k, &mut x[..k * n], &mut scratch).unwrap();
        }
        if round == 0 {
            after_the_first = allocations();
        }
    }
    assert!(after_the_first > before, "the first round makes the memory");
    assert_eq!(allocations(), after_the_first, "no other round does");
}

#[test]
fn repeated_work_allocates_nothing() {
    check::<f32>();
    check::<f64>();
}
