//! Cotangent Laplacians.
