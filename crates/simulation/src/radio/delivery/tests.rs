#![expect(clippy::unwrap_used, clippy::panic, reason = "a test may stop")]

use super::*;
use adit_core::time::Time;
use adit_observation::{DeviceId, Sighting};
use std::collections::HashMap;

/// One sighting every `interval_s`, numbered by its reader.
fn stream(count: u64, interval_s: f64) -> impl Iterator<Item = Observation> {
    (0..count).map(move |number| {
        Observation::Sighting(Sighting {
            time: Time::from_seconds(number as f64 * interval_s).unwrap(),
            reader: DeviceId::new(&number.to_string()).unwrap(),
        })
    })
}

fn number(delivered: &Delivered) -> String {
    match &delivered.observation {
        Observation::Sighting(sighting) => sighting.reader.as_str().to_owned(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_not_lost_arrives_once_and_once_more_for_each_duplicate() {
    let link = LinkSpec {
        duplicated: 0.1,
        extra_delay_s: 0.5,
        cut_off: vec![StoreAndForward { from_s: 30.0, until_s: 60.0 }],
        store: 200,
        ..LinkSpec::default()
    };
    let mut delivery = Delivery::new(stream(20_000, 0.1), &ClockSpec::default(), &link, 3, 4).unwrap();
    let (mut once, mut twice): (HashMap<String, u32>, u64) = (HashMap::new(), 0);
    let (mut last_s, mut most) = (f64::NEG_INFINITY, 0);
    while let Some(delivered) = delivery.next() {
        assert!(delivered.arrival_s >= last_s);
        last_s = delivered.arrival_s;
        most = most.max(delivery.under_way());
        if delivered.duplicate {
            twice += 1;
        } else {
            *once.entry(number(&delivered)).or_default() += 1;
        }
    }
    let counts = delivery.counts();
    assert_eq!(counts.made, 20_000);
    assert_eq!(once.len() as u64, counts.made - counts.lost - counts.dropped);
    assert!(once.values().all(|count| *count == 1));
    assert_eq!(twice, counts.duplicated);
    // 300 fall into the cut: 200 are kept.
    assert!((90..=110).contains(&counts.dropped), "{counts:?}");
    // The store, and ten per second over delays that hardly ever pass 10 means.
    assert!(most <= 200 + 60, "{most}");
    assert!(twice > 1_500 && counts.lost > 50, "{counts:?}");
}

#[test]
fn a_perfect_link_changes_nothing() {
    let delivery =
        Delivery::new(stream(100, 0.1), &ClockSpec::perfect(), &LinkSpec::perfect(), 1, 1).unwrap();
    let arrived: Vec<Observation> = delivery.map(|delivered| delivered.observation).collect();
    assert_eq!(arrived, stream(100, 0.1).collect::<Vec<_>>());
}

#[test]
fn delays_longer_than_the_interval_let_observations_overtake_each_other() {
    let delivery =
        Delivery::new(stream(1_000, 0.01), &ClockSpec::perfect(), &LinkSpec::default(), 1, 1).unwrap();
    let numbers: Vec<u64> = delivery.map(|d| number(&d).parse().unwrap()).collect();
    assert!(numbers.windows(2).filter(|w| w[1] < w[0]).count() > 100);
}

#[test]
fn nothing_arrives_during_a_cut_and_the_store_is_forwarded_at_its_rate_after_it() {
    let link = LinkSpec {
        cut_off: vec![StoreAndForward { from_s: 10.0, until_s: 20.0 }],
        store: 1_000,
        forwarded_per_s: 50.0,
        ..LinkSpec::perfect()
    };
    let delivery = Delivery::new(stream(300, 0.1), &ClockSpec::perfect(), &link, 1, 1).unwrap();
    let arrivals: Vec<f64> = delivery.map(|d| d.arrival_s).collect();
    assert_eq!(arrivals.len(), 300);
    assert!(!arrivals.iter().any(|at| (10.0..20.0).contains(at)));
    // 100 stored at 50 a second: the last one 2 s after the end.
    let late = arrivals.iter().filter(|at| (20.0..=22.0 + 1e-9).contains(*at)).count();
    assert_eq!(late, 100 + 20 + 1);
}

#[test]
fn losses_come_in_bursts_with_the_shares_of_gilbert_and_elliott() {
    let link = LinkSpec { lost_good: 0.0, lost_bad: 1.0, to_bad: 0.01, to_good: 0.2, ..LinkSpec::perfect() };
    let delivery = Delivery::new(stream(100_000, 0.1), &ClockSpec::perfect(), &link, 9, 1).unwrap();
    let arrived: Vec<u64> = delivery.map(|d| number(&d).parse().unwrap()).collect();
    let lost = 100_000 - arrived.len();
    let bursts = arrived.windows(2).filter(|w| w[1] - w[0] > 1).count();
    // π_bad = 0.01/0.21 = 0.0476, bursts of 5 on average; the variance of the share is larger by the bursts: ± 0.004 is four standard
    // errors, ± 0.7 for the length of 950 bursts.
    assert!((lost as f64 / 1e5 - 0.0476).abs() < 0.006, "{lost}");
    assert!((lost as f64 / bursts as f64 - 5.0).abs() < 0.7, "{}", lost as f64 / bursts as f64);
}

#[test]
fn a_clock_drifts_by_its_rate_and_wanders_by_its_walk() {
    let deviation = |spec: &ClockSpec, time_s: f64| {
        let errors: Vec<f64> = (0..2_000)
            .map(|person| {
                let mut clock =
                    DeviceClock::new(spec, Key::new(1, Purpose::Clock as u64).with(person)).unwrap();
                clock.stamp(time_s).seconds() - time_s
            })
            .collect();
        (errors.iter().map(|e| e * e).sum::<f64>() / 2_000.0).sqrt()
    };
    let rate = ClockSpec { rate_sigma_ppm: 10.0, ..ClockSpec::perfect() };
    let walk = ClockSpec { rate_walk_ppm: 0.1, ..ClockSpec::perfect() };
    // 10 ppm over 1000 s: 10 ms; a rate's walk of 0.1 ppm/√s over 300 s: 1e-7 √(300³/3) = 0.3 ms. 2000 clocks: ± 6 %.
    assert!((deviation(&rate, 1_000.5) / 0.010_005 - 1.0).abs() < 0.07);
    assert!((deviation(&walk, 300.0) / 3e-4 - 1.0).abs() < 0.07);
    assert!(deviation(&ClockSpec::perfect(), 777.25) < 1e-9);
}
