//! Poisson shape interpolation.
