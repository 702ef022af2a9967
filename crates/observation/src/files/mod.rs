//! What all file kinds share: where bytes come from ([`Input`]), how files are written whole or not at all
//! ([`AtomicFile`]), and numbers as text ([`decimal`]).

pub mod decimal;
mod input;
mod output;

pub use input::{Input, LONGEST_LINE};
pub(crate) use input::{LineLimit, read_error};
pub use output::AtomicFile;
