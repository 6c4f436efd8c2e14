//! A list that grows by pieces: one that moves all that it has into a larger place stops the page for as long as that takes.

/// Elements of a piece, as a power of two.
const PIECE: u32 = 12;

/// Elements by their number, in pieces that never move.
#[derive(Clone, Debug)]
pub(super) struct Pool<T> {
    pieces: Vec<Vec<T>>,
    len: u32,
}

impl<T: Copy> Pool<T> {
    /// Nothing.
    pub fn new() -> Self {
        Self { pieces: Vec::new(), len: 0 }
    }

    /// Adds an element; its number.
    pub fn push(&mut self, element: T) -> u32 {
        let number = self.len;
        let piece = (number >> PIECE) as usize;
        if piece == self.pieces.len() {
            self.pieces.push(Vec::with_capacity(1 << PIECE));
        }
        self.pieces[piece].push(element);
        self.len += 1;
        number
    }

    /// Element `number`.
    pub fn get(&self, number: u32) -> T {
        self.pieces[(number >> PIECE) as usize][Self::place(number)]
    }

    /// Puts an element in the place of `number`.
    pub fn set(&mut self, number: u32, element: T) {
        self.pieces[(number >> PIECE) as usize][Self::place(number)] = element;
    }

    /// Forgets all, and keeps the memory.
    pub fn clear(&mut self) {
        self.pieces.iter_mut().for_each(Vec::clear);
        self.len = 0;
    }

    fn place(number: u32) -> usize {
        (number & ((1 << PIECE) - 1)) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_keep_their_numbers() {
        let mut pool = Pool::new();
        for round in 0..2 {
            let count = 3 << PIECE;
            for k in 0..count + round {
                assert_eq!(pool.push(7 * k), k);
            }
            pool.set(1 << PIECE, 5);
            let expected = |k: u32| if k == 1 << PIECE { 5 } else { 7 * k };
            assert!((0..count + round).all(|k| pool.get(k) == expected(k)));
            pool.clear();
        }
    }
}
