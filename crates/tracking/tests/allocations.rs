//! A fix that changes nothing but the position allocates nothing.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_tracking::{Input, Rules};
use common::{Room, at, fix};

#[global_allocator]
static HEAP: dhat::Alloc = dhat::Alloc;

#[test]
fn a_quiet_second_allocates_nothing() {
    let mut room = Room::of(3, Rules::default());
    // Inside the shop, outside of everything, and in the portal.
    let places = [("t1", 310.0), ("t2", 50.0), ("t3", 0.0)];
    for (tag, x) in places {
        room.main(1.0, tag, x);
    }
    let fixes: Vec<(i32, Input)> = (2..60)
        .flat_map(|second| {
            let step = 0.05 * f64::from(second);
            places.map(|(tag, x)| (second, Input::Fix(fix(tag, f64::from(second), [x + step, 0.0, 1.0]))))
        })
        .collect();
    let profiler = dhat::Profiler::builder().testing().build();
    for (second, fix) in &fixes {
        let now = at(f64::from(*second));
        room.tracking.hear(now, fix, &mut room.events).unwrap();
        room.tracking.hear(now, &Input::Tick, &mut room.events).unwrap();
    }
    let blocks = dhat::HeapStats::get().total_blocks;
    drop(profiler);
    assert_eq!(room.tracking.person("p1").unwrap().live.last_known.unwrap().time, at(59.0));
    assert_eq!(blocks, 0);
}
