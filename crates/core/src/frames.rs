//! Frames as types.
