//! The optimisers: as good as mealpy's, within bounds and budget, the same on any number of threads, resumed to the same end.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "support/problems.rs"]
mod problems;

use adit_tuning::TuningError;
use adit_tuning::optimise::{Found, Method, Progress, Record, Search, Task};
use problems::{AGENTS, EVALUATIONS, PROBLEMS, Problem, better, mean, median, rastrigin, sphere};
use proptest::prelude::*;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

fn task(dimensions: usize, half: f64, seed: u64) -> Task {
    Task { bounds: vec![[-half, half]; dimensions], agents: AGENTS, evaluations: EVALUATIONS, seed }
}

fn search(method: Method, task: Task, cost: &(dyn Fn(&[f64]) -> f64 + Sync)) -> Found {
    Search::new(method, task, cost).unwrap().run()
}

fn sphere_and_rastrigin() -> impl Iterator<Item = &'static Problem> {
    PROBLEMS.iter().filter(|problem| problem.optimum == "origin")
}

/// Lower by mean, by median and in most pairs of runs.
fn assert_beats(problem: &Problem, method: Method, rival: &str) {
    let (ours, theirs) = (problem.costs(method), problem.rival(rival));
    let (name, share) = (problem.name, better(&ours, &theirs).0);
    assert!(mean(&ours) <= mean(&theirs), "{method:?}, {name}, mean: {} {}", mean(&ours), mean(&theirs));
    assert!(median(&ours) <= median(&theirs), "{method:?}, {name}, median: {}", median(&ours));
    assert!(share >= 0.5, "{method:?}, {name}: better in {share} of the pairs");
}

#[test]
fn the_bats_and_scaba_are_at_least_as_good_as_mealpys() {
    for problem in sphere_and_rastrigin() {
        assert_beats(problem, Method::Bat, "DevBA");
        assert_beats(problem, Method::SineCosineBat, "DevBA");
        assert_beats(problem, Method::SineCosineBat, "OriginalSCA");
        assert_beats(problem, Method::CovarianceMatrix, "DevBA");
    }
    assert_beats(&PROBLEMS[0], Method::CovarianceMatrix, "OriginalSCA");
}

/// They are one algorithm: its mean is no higher, and ranks do not tell them apart (1.96 standard deviations are 95 % of equals).
#[test]
fn the_sine_cosine_algorithm_is_as_good_as_mealpys() {
    for problem in sphere_and_rastrigin() {
        let (ours, theirs) = (problem.costs(Method::SineCosine), problem.rival("OriginalSCA"));
        assert!(mean(&ours) <= mean(&theirs), "{}: {} {}", problem.name, mean(&ours), mean(&theirs));
        let (share, deviations) = better(&ours, &theirs);
        assert!(deviations > -1.96, "{}: better in {share} of the pairs", problem.name);
    }
}

/// Bats and CMA-ES find a shifted optimum as they find one at zero (2.58 standard deviations are 99 % of equals); the sine cosine algorithm does not.
#[test]
fn only_the_sine_cosine_algorithm_is_drawn_to_zero() {
    for (at_origin, shifted) in [(&PROBLEMS[0], &PROBLEMS[1]), (&PROBLEMS[2], &PROBLEMS[3])] {
        let drawn = |method| better(&at_origin.costs(method), &shifted.costs(method)).1;
        for method in [Method::Bat, Method::CovarianceMatrix] {
            assert!(drawn(method).abs() < 2.58, "{method:?}, {}: {}", at_origin.name, drawn(method));
        }
        assert!(drawn(Method::SineCosine) > 2.58, "{}: {}", at_origin.name, drawn(Method::SineCosine));
        assert_beats(shifted, Method::SineCosineBat, "DevBA");
        assert_beats(shifted, Method::SineCosineBat, "OriginalSCA");
    }
}

#[test]
fn the_budget_is_spent_to_the_last_evaluation_and_no_further() {
    for method in Method::ALL {
        for evaluations in [30, 31, 100, 997] {
            let calls = AtomicUsize::new(0);
            let cost = |x: &[f64]| {
                calls.fetch_add(1, Ordering::Relaxed);
                sphere(x)
            };
            let found = search(method, Task { evaluations, ..task(3, 5.0, 1) }, &cost);
            assert_eq!((calls.into_inner(), found.evaluations), (evaluations, evaluations), "{method:?}");
            assert_eq!(found.record.costs.len(), evaluations);
            assert!((sphere(&found.point) - found.cost).abs() < 1e-15);
            assert!(found.improvements.windows(2).all(|pair| pair[1].0 > pair[0].0 && pair[1].1 < pair[0].1));
        }
    }
}

#[test]
fn a_search_is_the_same_on_one_thread_and_on_many() {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let many = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap();
    for method in Method::ALL {
        let run = || search(method, task(4, 3.0, 11), &rastrigin);
        assert_eq!(alone.install(run), many.install(run), "{method:?}");
        assert_ne!(run().point, search(method, task(4, 3.0, 12), &rastrigin).point, "{method:?}");
    }
}

#[test]
fn a_search_broken_off_and_resumed_ends_where_the_whole_one_does() {
    for method in Method::ALL {
        let whole = search(method, task(5, 5.12, 3), &rastrigin);
        let mut kept = String::new();
        let mut watch = |progress: Progress<'_>| {
            kept = serde_json::to_string(progress.record).unwrap();
            if progress.record.costs.len() >= 2000 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let part = Search::new(method, task(5, 5.12, 3), &rastrigin).unwrap().watched_by(&mut watch).run();
        assert!(part.evaluations >= 2000 && part.evaluations < 2200, "{method:?}: {}", part.evaluations);
        let record: Record = serde_json::from_str(&kept).unwrap();
        assert_eq!(record, part.record);
        let calls = AtomicUsize::new(0);
        let cost = |x: &[f64]| {
            calls.fetch_add(1, Ordering::Relaxed);
            rastrigin(x)
        };
        let resumed = Search::resume(record, &cost).unwrap().run();
        // Nothing is evaluated twice.
        assert_eq!(calls.into_inner(), EVALUATIONS - part.evaluations, "{method:?}");
        assert_eq!(resumed, whole, "{method:?}");
    }
}

#[test]
fn a_cost_that_is_no_number_is_never_the_best() {
    for method in Method::ALL {
        let half_blind = |x: &[f64]| if x[0] < 0.0 { f64::NAN } else { sphere(x) };
        let found = search(method, task(3, 5.0, 2), &half_blind);
        assert!(found.cost.is_finite() && found.point[0] >= 0.0, "{method:?}: {found:?}");
        let blind = search(method, Task { evaluations: 300, ..task(3, 5.0, 2) }, &|_: &[f64]| f64::NAN);
        assert!(blind.cost.is_infinite() && blind.evaluations == 300);
    }
}

#[test]
fn what_cannot_be_searched_is_refused() {
    let good = task(2, 1.0, 1);
    for (task, expected) in [
        (Task { bounds: vec![], ..good.clone() }, "bounds of a search: found none"),
        (Task { bounds: vec![[1.0, 1.0]], ..good.clone() }, "bounds of a search: found 1 to 1"),
        (Task { bounds: vec![[0.0, f64::NAN]], ..good.clone() }, "bounds of a search: found 0 to NaN"),
        (Task { bounds: vec![[f64::MIN, f64::MAX]], ..good.clone() }, "expected finite and rising"),
        (Task { agents: 3, ..good.clone() }, "agents of a search: found 3, expected 4 to 1048576"),
        (Task { evaluations: 29, ..good.clone() }, "evaluations of a search: found 29"),
    ] {
        let error: TuningError = Search::new(Method::Bat, task, &sphere).err().unwrap();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let record = Record { method: Method::Bat, task: Task { evaluations: 30, ..good }, costs: vec![1.0; 31] };
    let error = Search::resume(record, &sphere).err().unwrap();
    assert!(error.to_string().contains("costs of a record: found 31"), "{error}");
    assert!(Method::ALL.iter().all(|method| Method::from_name(method.name()) == Some(*method)));
    assert_eq!(Method::from_name("annealing"), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_is_tried_outside_the_bounds(
        bounds in prop::collection::vec((-1e3..1e3_f64, 1e-3..1e3_f64), 1..6), agents in 4..12_usize, seed in 0..1000_u64
    ) {
        let bounds: Vec<[f64; 2]> = bounds.into_iter().map(|(low, width)| [low, low + width]).collect();
        for method in Method::ALL {
            let outside = Mutex::new(Vec::new());
            let cost = |x: &[f64]| {
                if x.iter().zip(&bounds).any(|(v, [low, high])| !(low..=high).contains(&v)) {
                    outside.lock().unwrap().push(x.to_vec());
                }
                // A slope: the best place is at a corner.
                x.iter().sum()
            };
            let task = Task { bounds: bounds.clone(), agents, evaluations: 400, seed };
            Search::new(method, task, &cost).unwrap().run();
            prop_assert!(outside.lock().unwrap().is_empty(), "{method:?}: {:?}", outside.lock().unwrap());
        }
    }
}
