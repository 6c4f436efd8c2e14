//! Deformation gradients of triangles between two poses.
