//! The positioning methods, one module each.

pub mod foot_ins;
