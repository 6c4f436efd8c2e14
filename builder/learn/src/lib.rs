//! Statistics over many long rows: matrices in, matrices out. Knows no mesh, no frame and no texture.
//!
//! [`store`] holds rows that do not fit in memory, [`pca`] finds their principal components, [`symmetric`] the eigenvalues
//! of a small matrix. [`gpdm`] learns how motion goes on, on [`dense`] matrices (in `blocks`) and by [`descent`]; [`stretch`] draws other ways
//! through it by [`hmc`]. [`linear_map`] and [`regression`], with its [`kernel`]s, learn one row from another. Sums run in a fixed order: neither threads nor vector instructions change a bit, since bundles are
//! made of the results.

mod blocks;
pub mod dense;
pub mod descent;
pub mod gpdm;
mod gpdm_objective;
pub mod hmc;
pub mod kernel;
pub mod linear_map;
pub mod pca;
pub mod regression;
pub mod store;
pub mod stretch;
pub mod symmetric;

pub use self::pca::{PrincipalComponents, components};
pub use self::store::{ScratchError, Store};
