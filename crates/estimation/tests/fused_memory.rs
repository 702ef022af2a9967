//! What a walker takes, counted on the heap: what belongs to the site is there once.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/wearer.rs"]
mod wearer;

use adit_estimation::methods::Worn;
use adit_estimation::methods::fused::Fused;
use wearer::{log, settings, two_level, wearers};

#[global_allocator]
static HEAP: dhat::Alloc = dhat::Alloc;

/// Epochs of ranges, Hz.
const RANGING_HZ: f64 = 10.0;
/// Walkers that share a site.
const WALKERS: usize = 10;

#[test]
fn a_walker_takes_kibibytes_and_a_site_is_there_once() {
    let mine = two_level();
    for (mount, worn) in wearers() {
        let (log, settings) = (log(&mine, mount, RANGING_HZ), settings(&mine, worn));
        let profiler = dhat::Profiler::builder().testing().build();
        let mut walkers: Vec<Fused> = (0..WALKERS).map(|_| Fused::new(settings.clone()).unwrap()).collect();
        let mut most = Vec::new();
        for (index, observation) in log.iter().enumerate() {
            for walker in &mut walkers {
                let mut due = walker.observe(observation).unwrap();
                while due.is_some() {
                    due = walker.next_due().unwrap();
                }
            }
            if index % 500 == 0 {
                most.push(dhat::HeapStats::get().curr_bytes / WALKERS);
            }
        }
        // The first seconds, which are kept until it is known what the log is of, are not typical.
        let mut settled = most[most.len() / 4..].to_vec();
        settled.sort_unstable();
        let (typical, worst) = (settled[settled.len() / 2], settled[settled.len() - 1]);
        println!("{worn:?}: {typical} bytes a walker, at most {worst}");
        drop(profiler);
        // What docs/performance.md says of it; the roadways' map of the radio alone takes 9 MiB.
        let most = if worn == Worn::Foot { 28 * 1024 } else { 36 * 1024 };
        assert!(typical <= most, "{worn:?}: {typical} bytes");
    }
}
