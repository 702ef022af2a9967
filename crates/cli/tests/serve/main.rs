//! `adit serve` and `adit load`, as they are run: the real binary, a real broker, power cuts, full disks, locked files, floods of junk.
#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail by panicking")]

mod broker;
mod disk;
mod flood;
mod locked;
mod replay;
mod served;
mod usual;
