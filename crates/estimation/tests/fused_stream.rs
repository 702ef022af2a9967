//! `fused` as a stream: what was kept in between, and what comes twice, changes nothing.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/wearer.rs"]
mod wearer;

use adit_core::nalgebra::{Matrix2, Vector3};
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::MethodError;
use adit_estimation::methods::fused::{Fused, FusedParams};
use adit_observation::{FixSource, HeightFix, Observation, PositionFix};
use wearer::{log, settings, two_level, wearers};

/// Epochs of ranges, Hz.
const RANGING_HZ: f64 = 2.0;
const SECOND_NS: i64 = 1_000_000_000;

fn feed(method: &mut Fused, log: &[Observation], solutions: &mut Vec<Solution>) {
    for observation in log {
        let mut due = method.observe(observation).unwrap();
        while let Some(solution) = due {
            solutions.push(solution);
            due = method.next_due().unwrap();
        }
    }
}

fn end(mut method: Fused, mut solutions: Vec<Solution>) -> Vec<String> {
    let refused = loop {
        match method.finish_next() {
            Ok(Some(solution)) => solutions.push(solution),
            Ok(None) => break None,
            Err(error) => break Some(error.to_string()),
        }
    };
    // Numbers in JSON are the shortest that read back to the same bits.
    let told = solutions.iter().map(|solution| serde_json::to_string(solution).unwrap());
    told.chain(refused).collect()
}

fn whole(settings: &FusedParams, log: &[Observation]) -> Vec<String> {
    let (mut method, mut solutions) = (Fused::new(settings.clone()).unwrap(), Vec::new());
    feed(&mut method, log, &mut solutions);
    end(method, solutions)
}

/// Kept as JSON and read back this often.
fn split(settings: &FusedParams, log: &[Observation], parts: usize) -> Vec<String> {
    let (mut method, mut solutions) = (Fused::new(settings.clone()).unwrap(), Vec::new());
    for part in log.chunks(log.len() / parts) {
        feed(&mut method, part, &mut solutions);
        let kept = serde_json::to_string(&method.detached()).unwrap();
        assert!(kept.len() < 300_000, "{} bytes", kept.len());
        method = serde_json::from_str(&kept).unwrap();
        method.attach(settings).unwrap();
    }
    end(method, solutions)
}

#[test]
fn a_run_that_was_kept_in_between_is_the_whole_run() {
    let mine = two_level();
    for (mount, worn) in wearers() {
        let log = log(&mine, mount, RANGING_HZ);
        let settings = settings(&mine, worn);
        let whole = whole(&settings, &log);
        assert!(whole.len() > 60, "{} solutions", whole.len());
        assert!(whole == split(&settings, &log, 13), "{worn:?}");
        // Nor does a walker who is not to be held to the roadways find them when he is read back.
        let mut free = settings.clone();
        free.place.roadways = false;
        assert!(self::whole(&free, &log) == split(&free, &log, 13), "{worn:?}");
        // One kept within the half second that it looks at.
        let mut first = log.clone();
        first.truncate(30);
        assert!(self::whole(&settings, &first) == split(&settings, &first, 3), "{worn:?}");
    }
}

/// Without a compass the direction of the way is found by walking; who stands since the beginning is somewhere nevertheless.
#[test]
fn who_has_not_walked_yet_is_told_where_he_stands() {
    const STANDS_S: i64 = 4;
    const TIMES: i64 = 5;
    let there_m = [5_320.0, 3_000.0, 113.0];
    let fix = |second: i64| {
        Observation::Fix(PositionFix {
            time: Time::from_nanos(second * SECOND_NS),
            level_m: [there_m[0], there_m[1]].into(),
            covariance_m2: Matrix2::identity(),
            height: Some(HeightFix { up_m: there_m[2], sigma_m: 0.5 }),
            source: FixSource::Unknown,
        })
    };
    let mine = two_level();
    for (mount, worn) in wearers() {
        let whole = log(&mine, mount, RANGING_HZ);
        // He stands for as long, again and again: steps are decided a few seconds late.
        let begin = whole.iter().filter(|o| matches!(o, Observation::Imu(_)));
        let begin: Vec<_> = begin.take_while(|o| o.time().nanos() < STANDS_S * SECOND_NS).cloned().collect();
        let again = |time: i64| {
            let shift = Interval::from_nanos(time * STANDS_S * SECOND_NS);
            begin.iter().map(move |o| o.clone().at(o.time() + shift))
        };
        let mut standing: Vec<_> = (0..TIMES).flat_map(again).collect();
        standing.extend((1..TIMES * STANDS_S).map(fix));
        standing.sort_by_key(Observation::time);

        let mut settings = settings(&mine, worn);
        let run = |settings: &FusedParams, log: &[Observation]| {
            let (mut method, mut solutions) = (Fused::new(settings.clone()).unwrap(), Vec::new());
            feed(&mut method, log, &mut solutions);
            solutions
        };
        assert!(run(&settings, &standing).is_empty(), "{worn:?}");
        let silent = run(&settings, &whole);
        settings.place.before_direction = true;
        let told = run(&settings, &standing);
        assert!(told.len() >= 8, "{worn:?}: {} told", told.len());
        for solution in &told {
            let off_m = (solution.position_m - Vector3::from(there_m)).norm();
            assert!(off_m < 1e-9, "{worn:?}: {off_m} m");
            // 2.45 m of the fix in 95 %, and what ranges and fixes have in common.
            assert!((2.4..4.0).contains(&solution.radius_95_m()), "{worn:?}: {} m", solution.radius_95_m());
        }
        // What is told so holds nothing: where the direction is found, all is as without.
        let found = silent[0].time;
        let after = |solutions: Vec<Solution>| {
            let after = solutions.into_iter().filter(|solution| solution.time >= found);
            after.map(|solution| format!("{solution:?}")).collect::<Vec<_>>()
        };
        assert!(after(run(&settings, &whole)) == after(silent), "{worn:?}");
    }
}

#[test]
fn a_walk_that_nothing_places_says_so() {
    let mine = two_level();
    for (mount, worn) in wearers() {
        let mut log = log(&mine, mount, RANGING_HZ);
        log.retain(|observation| observation.kind().is_wired());
        let mut method = Fused::new(settings(&mine, worn)).unwrap();
        feed(&mut method, &log, &mut Vec::new());
        let told = method.finish_next().unwrap_err();
        assert_eq!(told, MethodError::NeverPlaced { ranges: 0, signals: 0, fixes: 0 });
    }
}

#[test]
fn what_comes_twice_counts_once() {
    let mine = two_level();
    for (mount, worn) in wearers() {
        let log = log(&mine, mount, RANGING_HZ);
        let settings = settings(&mine, worn);
        let mut twice = Vec::new();
        for (index, observation) in log.iter().enumerate() {
            twice.push(observation.clone());
            // At once; and what came by radio once more when ten others have come.
            twice.push(observation.clone());
            let before = index.checked_sub(10).map(|index| &log[index]);
            twice.extend(before.filter(|before| !before.kind().is_wired()).cloned());
        }
        assert!(whole(&settings, &log) == whole(&settings, &twice), "{worn:?}");
        // The copies would tell otherwise: other ones of a range do.
        let moved = log.iter().cloned().map(|mut observation| {
            if let Observation::Range(range) = &mut observation {
                range.range_m += 1e-6;
            }
            observation
        });
        assert!(whole(&settings, &log) != whole(&settings, &moved.collect::<Vec<_>>()), "{worn:?}");
    }
}
