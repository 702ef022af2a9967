//! The store from outside: what goes in comes out, once, in little room, and what is wrong is told.

mod common;
mod once;
