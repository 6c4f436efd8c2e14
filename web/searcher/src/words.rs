//! Numbers and names one after another, as 32-bit words: what one module's memory holds, for the other's.

use glam::{Vec2, Vec3};
use kernels::align::Placement;

/// Writes words.
#[derive(Clone, Debug, Default)]
pub struct Writer(
    /// The words so far.
    pub Vec<u32>,
);

impl Writer {
    /// A whole number.
    pub fn number(&mut self, value: u32) {
        self.0.push(value);
    }

    /// A number of 32 bits.
    pub fn float(&mut self, value: f32) {
        self.0.push(value.to_bits());
    }

    /// Several of them.
    pub fn floats<const N: usize>(&mut self, values: [f32; N]) {
        self.0.extend(values.map(f32::to_bits));
    }

    /// A number of 64 bits.
    pub fn double(&mut self, value: f64) {
        let bits = value.to_bits();
        self.0.extend([bits as u32, (bits >> 32) as u32]);
    }

    /// Text.
    pub fn name(&mut self, name: &str) {
        self.number(name.len() as u32);
        self.0.extend(name.bytes().map(u32::from));
    }

    /// A point.
    pub fn point(&mut self, point: Vec3) {
        self.floats(point.to_array());
    }

    /// A placement.
    pub fn placement(&mut self, placement: &Placement) {
        self.floats([placement.heading, placement.translation.x, placement.translation.y]);
    }

    /// How many there are, then each as `write` writes it.
    pub fn list<T>(&mut self, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.number(items.len() as u32);
        items.iter().for_each(|item| write(self, item));
    }
}

/// Reads what [`Writer`] has written, in the same order; `None` where it is over too soon.
pub struct Reader<'a>(
    /// What is left.
    pub &'a [u32],
);

impl Reader<'_> {
    /// A whole number.
    pub fn number(&mut self) -> Option<u32> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    /// A number of 32 bits.
    pub fn float(&mut self) -> Option<f32> {
        self.number().map(f32::from_bits)
    }

    /// A number of 64 bits.
    pub fn double(&mut self) -> Option<f64> {
        let [low, high] = [self.number()?, self.number()?].map(u64::from);
        Some(f64::from_bits(low | high << 32))
    }

    /// Text.
    pub fn name(&mut self) -> Option<String> {
        let bytes: Option<Vec<u8>> = self.list(|reader| u8::try_from(reader.number()?).ok());
        String::from_utf8(bytes?).ok()
    }

    /// A point.
    pub fn point(&mut self) -> Option<Vec3> {
        Some(Vec3::new(self.float()?, self.float()?, self.float()?))
    }

    /// A placement.
    pub fn placement(&mut self) -> Option<Placement> {
        Some(Placement { heading: self.float()?, translation: Vec2::new(self.float()?, self.float()?) })
    }

    /// As many things as were written, each as `read` reads it.
    pub fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = self.number()?;
        // Nothing is reserved: a list that is said to be longer than it is ends early.
        (0..count).map(|_| read(self)).collect()
    }
}
