//! Sparse Cholesky factors of Laplacians.
