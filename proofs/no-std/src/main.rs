//! A program without a standard library that walks, levels and measures with adit.
//!
//! It has its own entry point, allocator and panic handler, so that the linker itself is the proof: anything that
//! reaches for `std` or libc leaves an undefined or a doubled symbol. Linux gives it a stack and two system calls;
//! it exits with 0, or with the number of the check that failed, or with 99 after a panic.
//!
//! This crate is outside the workspace's ban on `unsafe`: an entry point, a global allocator and a system call
//! cannot be written without. Nothing of it is used anywhere else.
#![no_std]
#![no_main]

mod runtime;
