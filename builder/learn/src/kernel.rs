//! How alike two inputs are: kernels of Gaussian processes, and how they change with their parameters.
//!
//! Thesis equations 5.13 to 5.15 (Williams 1998; Rasmussen and Williams 2006). A kernel sees inputs by their products alone, so that
//! training needs those once. The neural-network kernel as equation 5.13 prints it makes f odd about the mean input; inputs
//! with a 1 beside them (Williams' bias) do not. The linear kernel has that 1, too.

/// A kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Of a network with endlessly many hidden units (5.13, with bias).
    NeuralNetwork,
    /// Squared exponential (5.14).
    SquaredExponential,
    /// Linear, with bias (5.15).
    Linear,
    /// The affine map of least squares, after Baran and others (2009): linear, with nothing to learn and no noise.
    Affine,
}

/// Logarithms of a kernel's parameters: what training looks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Of the deviation of the signal (sigma_f).
    pub signal: f64,
    /// Of the length over which inputs are alike (l).
    pub length: f64,
    /// Of the deviation of the noise (sigma_n), above what it is at least.
    pub noise: f64,
}

/// A kernel with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    kernel: Kernel,
    /// The variance of the signal.
    signal: f64,
    /// One over the square of the length.
    narrow: f64,
}

impl Kernel {
    /// Whether maps by it are linear.
    #[must_use]
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Linear | Self::Affine)
    }

    /// It with parameters.
    #[must_use]
    pub fn with(self, parameters: &Parameters) -> Likeness {
        let (signal, narrow) = ((2.0 * parameters.signal).exp(), (-2.0 * parameters.length).exp());
        Likeness { kernel: self, signal, narrow }
    }
}

impl Likeness {
    /// The kernel of inputs with the product `product` and the squared lengths `own` and `other`, and its derivative by the
    /// logarithm of the length; noise is left out.
    #[must_use]
    pub fn value(&self, product: f64, own: f64, other: f64) -> (f64, f64) {
        let Self { kernel, signal, narrow } = *self;
        match kernel {
            Kernel::NeuralNetwork => {
                let u = 0.5 * narrow;
                let (a, b, c) = (product + 1.0, own + 1.0, other + 1.0);
                let r = 1.0 / ((1.0 + u * b) * (1.0 + u * c)).sqrt();
                let q = (u * a * r).clamp(-1.0 + 1e-15, 1.0 - 1e-15);
                let change = a * r - 0.5 * q * (b / (1.0 + u * b) + c / (1.0 + u * c));
                (signal * q.asin(), -2.0 * u * signal * change / (1.0 - q * q).sqrt())
            }
            Kernel::SquaredExponential => {
                let apart = (own + other - 2.0 * product).max(0.0) * narrow;
                let value = signal * (-0.5 * apart).exp();
                (value, value * apart)
            }
            Kernel::Linear | Kernel::Affine => {
                let slope = signal * narrow * product;
                (signal + slope, -2.0 * slope)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    #[test]
    fn derivatives_are_those_of_differences() {
        for kernel in [Kernel::NeuralNetwork, Kernel::SquaredExponential, Kernel::Linear] {
            for case in 0..20 {
                let number = |k: u64| f64::from(signed(case, k));
                let [x, y] = [[number(0), number(1)], [number(2), number(3)]];
                let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
                let at = |length: f64| {
                    let parameters = Parameters { signal: 0.3, length, noise: 0.0 };
                    kernel.with(&parameters).value(dot(x, y), dot(x, x), dot(y, y))
                };
                let (length, step) = (number(4), 1e-5);
                let plain = (at(length + step).0 - at(length - step).0) / (2.0 * step);
                assert!((at(length).1 - plain).abs() < 1e-8, "{kernel:?}: {} and {plain}", at(length).1);
            }
        }
    }

    #[test]
    fn the_neural_network_is_not_odd_about_the_mean() {
        let parameters = Parameters { signal: 0.0, length: 0.0, noise: 0.0 };
        let with_mean = Kernel::NeuralNetwork.with(&parameters).value(0.0, 0.0, 0.5).0;
        assert!(with_mean > 0.1, "the mean input is like others: {with_mean}");
    }
}
