//! Fits of path loss, ranges, hearing and maps: what made the data comes back.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::nalgebra::{Vector2, Vector3};
use adit_estimation::radio::map::Hearing;
use adit_estimation::radio::{Lattice, MapParams, RadioMap, Reading};
use adit_tuning::TuningError;
use adit_tuning::fingerprint::{self, FingerprintParams, ReadingKind};
use adit_tuning::radio::path_loss::{self, PathLossParams};
use adit_tuning::radio::{Site, SurveyedScan, belief, by_spot, hearing, ranges};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, StandardUniform, StudentT};

/// A hall of 40 × 30 m, access points about it, each with its own strength at 1 m and exponent.
struct Hall {
    sites: Vec<Option<Site>>,
    lines: Vec<[f64; 2]>,
    random: ChaCha8Rng,
}

impl Hall {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let places = [
            (0.0, 0.0),
            (40.0, 0.0),
            (0.0, 30.0),
            (40.0, 30.0),
            (20.0, 15.0),
            (5.0, 15.0),
            (30.0, 25.0),
            (15.0, 5.0),
        ];
        let (strength, exponent) = (Normal::new(-42.0, 3.0).unwrap(), Normal::new(2.4, 0.25).unwrap());
        let lines = places.map(|_| [strength.sample(&mut random), exponent.sample(&mut random)]).to_vec();
        let site = |(x, y)| Some(Site { position_m: Vector3::new(x, y, 2.5), floor: None });
        Self { sites: places.map(site).to_vec(), lines, random }
    }

    fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.random)
    }

    /// Scans at random places; `noise` of a reading, `heard` says whether one of this strength is.
    fn scans(
        &mut self,
        count: usize,
        mean: impl Fn(usize, f64) -> f64,
        mut noise: impl FnMut(&mut ChaCha8Rng) -> f64,
        heard: impl Fn(f64, f64) -> bool,
    ) -> Vec<SurveyedScan> {
        let mut scans = Vec::new();
        for _ in 0..count {
            let position_m = Vector3::new(40.0 * self.uniform(), 30.0 * self.uniform(), 1.2);
            let mut readings = Vec::new();
            for transmitter in 0..self.sites.len() {
                let (away, _) = self.sites[transmitter].unwrap().away(&position_m, 0, 3.0);
                let value = mean(transmitter, away) + noise(&mut self.random);
                let chance = self.uniform();
                if heard(value, chance) {
                    readings.push(Reading { transmitter, value });
                }
            }
            scans.push(SurveyedScan { position_m, floor: 0, readings, whole: true });
        }
        scans
    }
}

#[test]
fn the_path_loss_of_each_transmitter_comes_back() {
    let mut hall = Hall::new(1);
    let lines = hall.lines.clone();
    let (tail, sites) = (StudentT::new(4.0).unwrap(), hall.sites.clone());
    let scans = hall.scans(
        600,
        |k, d| lines[k][0] - 10.0 * lines[k][1] * d.log10(),
        |random| 3.0 * tail.sample(random),
        |_, _| true,
    );
    let fit = path_loss::fit(&scans, &sites, &PathLossParams::default()).unwrap();
    assert_eq!(fit.breakpoint_m, None);
    // The scale of Student's t of 4,800 values: within 2 %, twice its standard error.
    assert!((fit.sigma_db / 3.0 - 1.0).abs() < 0.04, "{}", fit.sigma_db);
    for (emitter, [at_1m, exponent]) in fit.emitters.iter().zip(&lines) {
        let model = emitter.unwrap().path_loss;
        // 600 values over a decade of distance: 3.9 dB / √600 / 0.25 decades = 0.6 dB and 0.06 in the exponent; thrice that.
        assert!((model.exponent - exponent).abs() < 0.19, "{model:?} {exponent}");
        assert!((model.rssi_at_1m_dbm - at_1m).abs() < 2.2, "{model:?} {at_1m}");
    }
    // How the transmitters differ, from eight of them.
    assert!(
        (1.0..6.0).contains(&fit.between[0]) && (0.1..0.5).contains(&fit.between[1]),
        "{:?}",
        fit.between
    );
}

/// Weak signals are not heard. Who looks only at what was heard takes the far field for stronger than it is.
#[test]
fn what_was_not_heard_counts() {
    let mut hall = Hall::new(2);
    let (normal, sites) = (Normal::new(0.0, 5.0).unwrap(), hall.sites.clone());
    let scans = hall.scans(
        800,
        |_, d| -40.0 - 30.0 * d.log10(),
        |random| normal.sample(random),
        |value, _| value > -80.0,
    );
    let exponent = |scans: &[SurveyedScan]| {
        let params = PathLossParams { dof: 30.0, missed: 0.001, ..PathLossParams::default() };
        path_loss::fit(scans, &sites, &params).unwrap().common[1]
    };
    let censored = exponent(&scans);
    let ignored: Vec<SurveyedScan> =
        scans.iter().map(|scan| SurveyedScan { whole: false, ..scan.clone() }).collect();
    let ignored = exponent(&ignored);
    // Six thousand values of 5 dB over half a decade: a standard error of 0.03.
    assert!((censored - 3.0).abs() < 0.09, "{censored} {ignored}");
    assert!(ignored < 2.85, "{ignored}");
}

#[test]
fn a_second_slope_is_found_where_there_is_one_and_only_there() {
    for (seed, beyond) in [(3, 5.0), (4, 2.0)] {
        let mut hall = Hall::new(seed);
        let (normal, sites) = (Normal::new(0.0, 3.0).unwrap(), hall.sites.clone());
        let mean = |_: usize, d: f64| {
            -40.0 - 20.0 * d.min(15.0).log10() - 10.0 * beyond * (d / 15.0).max(1.0).log10()
        };
        let scans = hall.scans(400, mean, |random| normal.sample(random), |_, _| true);
        let fit = path_loss::fit(&scans, &sites, &PathLossParams::default()).unwrap();
        if beyond > 4.0 {
            // Breakpoints are tried at five shares of the distances, 11 to 26 m here.
            assert!((10.0..20.0).contains(&fit.breakpoint_m.unwrap()), "{fit:?}");
            let far = fit.emitters[0].unwrap().path_loss.exponent_beyond.unwrap();
            assert!((far - beyond).abs() < 0.6, "{far}");
        } else {
            assert_eq!(fit.breakpoint_m, None);
            assert!((fit.common[1] - 2.0).abs() < 0.1);
        }
    }
}

#[test]
fn floors_take_their_loss() {
    let mut hall = Hall::new(5);
    let normal = Normal::new(0.0, 3.0).unwrap();
    let mut sites = hall.sites.clone();
    for (index, site) in sites.iter_mut().enumerate() {
        site.as_mut().unwrap().floor = Some(i32::try_from(index % 3).unwrap());
    }
    let mut scans = Vec::new();
    for number in 0..600 {
        let floor = number % 3;
        let position_m = Vector3::new(40.0 * hall.uniform(), 30.0 * hall.uniform(), 1.2);
        let value = |site: &Option<Site>, random: &mut ChaCha8Rng| {
            let (away, floors) = site.unwrap().away(&position_m, floor, 3.0);
            -40.0 - 25.0 * away.log10() - 14.0 * floors + normal.sample(random)
        };
        let readings = sites
            .iter()
            .enumerate()
            .map(|(transmitter, site)| Reading { transmitter, value: value(site, &mut hall.random) });
        scans.push(SurveyedScan { position_m, floor, readings: readings.collect(), whole: true });
    }
    let fit = path_loss::fit(&scans, &sites, &PathLossParams::default()).unwrap();
    // 4,800 values of 3 dB: a standard error of 0.06 dB; thrice that, and the trend of distance beside it.
    assert!((fit.storeys.loss_db - 14.0).abs() < 0.3, "{:?}", fit.storeys);
}

#[test]
fn offsets_of_ranges_come_back_from_among_blocked_ones() {
    let mut hall = Hall::new(6);
    let (normal, sites) = (Normal::new(0.0, 0.3).unwrap(), hall.sites.clone());
    let offset = |k: usize| 0.9 + 0.1 * k as f64;
    let mut blocked = 0;
    let scans = hall.scans(
        300,
        |k, d| offset(k) + 1.04 * d,
        |random| {
            blocked += 1;
            // Every tenth comes round a corner.
            normal.sample(random) + if blocked % 10 == 0 { 6.0 } else { 0.0 }
        },
        |_, _| true,
    );
    let fit = ranges::fit(&scans, &sites).unwrap();
    for (k, model) in fit.models.iter().enumerate() {
        let model = model.unwrap();
        // A least-squares fit would put 0.6 m on every offset; Student's t leaves a tenth of that.
        assert!((model.offset_m + 20.0 * (model.scale - 1.04) - offset(k)).abs() < 0.12, "{k}: {model:?}");
        assert!((model.scale - 1.04).abs() < 0.02, "{k}: {model:?}");
    }
}

#[test]
fn the_curve_of_hearing_comes_back() {
    let truth = Hearing { half_dbm: -82.0, width_db: 3.0, unsure: 0.05 };
    let mut hall = Hall::new(7);
    let pairs: Vec<(f64, bool)> = (0..5000)
        .map(|_| {
            let mean = -110.0 + 70.0 * hall.uniform();
            (mean, hall.uniform() < truth.probability(mean))
        })
        .collect();
    let found = hearing::fit(&pairs, 0.05).unwrap();
    assert!((found.half_dbm - truth.half_dbm).abs() <= 1.0, "{found:?}");
    assert!((2.0..4.5).contains(&found.width_db), "{found:?}");
    assert_eq!(hearing::fit(&[(-50.0, true), (-60.0, true)], 0.05), None);
    assert_eq!(hearing::fit(&[], 0.05), None);
}

#[test]
fn too_little_is_refused() {
    let few =
        |result: Result<(), TuningError>| assert!(matches!(result, Err(TuningError::TooFewReadings { .. })));
    let site = [Some(Site { position_m: Vector3::zeros(), floor: None })];
    let scan = SurveyedScan {
        position_m: Vector3::new(1.0, 0.0, 0.0),
        floor: 0,
        readings: vec![Reading { transmitter: 0, value: -50.0 }],
        whole: true,
    };
    for scans in [vec![], vec![scan.clone()], vec![scan; 3]] {
        few(path_loss::fit(&scans, &site, &PathLossParams::default()).map(|_| ()));
        few(ranges::fit(&scans, &site).map(|_| ()));
        let lattice = Lattice::within(&Vector2::zeros(), &Vector2::new(2.0, 2.0), 1.0).unwrap();
        few(fingerprint::fit(&scans, &site, lattice, &FingerprintParams::of(ReadingKind::Strength))
            .map(|_| ()));
    }
}

#[test]
fn spots_gather_their_scans() {
    let scan = |x: f64, floor: i32, value: f64| SurveyedScan {
        position_m: Vector3::new(x, 0.1, 1.0),
        floor,
        readings: vec![Reading { transmitter: 1, value }, Reading { transmitter: 9, value: 0.0 }],
        whole: true,
    };
    let spots = by_spot(
        &[scan(0.1, 0, -50.0), scan(0.3, 0, -54.0), scan(0.1, 1, -60.0), scan(0.5, 0, -70.0)],
        2,
        0.4,
    );
    let shown: Vec<_> =
        spots.iter().map(|s| (s.scans, s.floor, s.readings[1].count, s.readings[1].mean)).collect();
    assert_eq!(shown, [(2, 0, 2, -52.0), (1, 1, 1, -60.0), (1, 0, 1, -70.0)]);
    assert!(
        (spots[0].position_m.x - 0.2).abs() < 1e-12 && (spots[0].readings[1].squares - 8.0).abs() < 1e-12
    );
    assert_eq!(spots[0].readings[0].count, 0);
}

/// Shadowing that a path loss knows nothing of, drawn over the hall as waves: the map follows it, and its belief is honest.
#[test]
fn a_map_of_fingerprints_finds_scans_that_it_has_not_seen() {
    let mut hall = Hall::new(8);
    let (sites, normal) = (hall.sites.clone(), Normal::new(0.0, 1.0).unwrap());
    let waves: Vec<[f64; 4]> =
        (0..24 * sites.len()).map(|_| [0; 4].map(|_: i32| normal.sample(&mut hall.random))).collect();
    let shadow = |k: usize, at: &Vector3<f64>| {
        let of = |w: &[f64; 4]| 1.2 * (at.x * w[0] / 4.0 + at.y * w[1] / 4.0 + 6.0 * w[2]).sin();
        waves[24 * k..24 * (k + 1)].iter().map(of).sum::<f64>()
    };
    let mut scan = |x: f64, y: f64| {
        let position_m = Vector3::new(x, y, 0.0);
        let mut value = |k: usize| {
            let (away, _) = sites[k].unwrap().away(&position_m, 0, 3.0);
            -42.0 - 24.0 * away.log10() + shadow(k, &position_m) + 1.5 * normal.sample(&mut hall.random)
        };
        let readings = (0..8).map(|transmitter| Reading { transmitter, value: value(transmitter) });
        SurveyedScan { position_m, floor: 0, readings: readings.collect(), whole: true }
    };
    let mut survey = Vec::new();
    for i in 0..20 {
        for j in 0..15 {
            survey.push(scan(2.0 * f64::from(i) + 1.0, 2.0 * f64::from(j) + 1.0));
        }
    }
    let lattice = Lattice::within(&Vector2::zeros(), &Vector2::new(40.0, 30.0), 1.0).unwrap();
    let params = FingerprintParams::of(ReadingKind::Strength);
    let fit = fingerprint::fit(&survey, &sites, lattice.clone(), &params).unwrap();
    let of_path_loss = path_loss::fit(&survey, &sites, &PathLossParams::default()).unwrap();
    assert!(of_path_loss.sigma_db > 3.0, "the shadowing is there: {}", of_path_loss.sigma_db);
    let emitters: Vec<_> = of_path_loss.emitters.iter().map(|emitter| (emitter.unwrap(), None)).collect();
    let (storeys, hearing) = (of_path_loss.storeys, of_path_loss.hearing);
    let without = RadioMap::of_emitters(lattice.clone(), &emitters, 0.0, &storeys, &hearing).unwrap();
    let (mut errors, mut errors_without, mut inside) = (0.0, 0.0, 0);
    for i in 0..60 {
        let judged = scan(2.0 + 0.6 * f64::from(i), 3.0 + 0.4 * f64::from(i * 7 % 60));
        let away = |map: &RadioMap| {
            let found = map.fix(&judged.readings, &fit.belief).unwrap().fix;
            ((found.position_m - judged.position_m.xy()).norm(), found.radius_95_m())
        };
        let (error, radius) = away(&fit.map);
        inside += i32::from(error <= radius);
        errors += error / 60.0;
        errors_without += away(&without).0 / 60.0;
    }
    // What the path loss cannot know is most of its error.
    assert!(errors < 0.6 * errors_without && errors < 1.5, "{errors} {errors_without}");
    // 57 expected of 60; the binomial distribution has 51 or more with 99.5 %.
    assert!(inside >= 51, "{inside}");
    // The same on one thread as on many, and again.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(alone.install(|| fingerprint::fit(&survey, &sites, lattice, &params).unwrap()), fit);
}

/// A map that is told to be twice as sharp as its readings is believed less.
#[test]
fn a_map_that_is_too_sure_is_believed_less() {
    let mut hall = Hall::new(9);
    let (sites, normal) = (hall.sites.clone(), Normal::new(0.0, 4.0).unwrap());
    let scans = hall.scans(200, |_, d| -42.0 - 24.0 * d.log10(), |random| normal.sample(random), |_, _| true);
    let lattice = Lattice::within(&Vector2::zeros(), &Vector2::new(40.0, 30.0), 1.0).unwrap();
    let belief_at = |sigma_db: f64| {
        let storeys = adit_estimation::radio::map::Storeys { height_m: 3.0, loss_db: 0.0 };
        let hearing = Hearing { half_dbm: -120.0, width_db: 4.0, unsure: 0.1 };
        let fit = path_loss::fit(&scans, &sites, &PathLossParams::default()).unwrap();
        let emitters: Vec<_> = fit
            .emitters
            .iter()
            .map(|emitter| (adit_estimation::radio::Emitter { sigma_db, ..emitter.unwrap() }, None))
            .collect();
        let map = RadioMap::of_emitters(lattice.clone(), &emitters, 1.2, &storeys, &hearing).unwrap();
        belief::learn(&[(map, scans.clone())], false)
    };
    let (right, sharp) = (belief_at(4.0), belief_at(2.0));
    assert!(right.share >= 0.8 && sharp.share <= 0.4, "{right:?} {sharp:?}");
    assert_eq!(belief::learn(&[], true), MapParams::RANGES);
    assert_eq!(belief::learn(&[], false), MapParams::SCAN);
}

#[test]
fn every_spot_is_left_out_once() {
    let mut hall = Hall::new(10);
    let mut scans = hall.scans(100, |_, d| -42.0 - 24.0 * d.log10(), |_| 0.0, |_, _| true);
    let folds = belief::folds(&scans, 0.4);
    assert_eq!(folds.len(), 5);
    assert!(folds.iter().all(|(kept, judged)| kept.len() == 80 && judged.len() == 20));
    assert!(folds.iter().all(|(kept, judged)| judged.iter().all(|scan| !kept.contains(scan))));
    assert!(scans.iter().all(|scan| folds.iter().filter(|(_, judged)| judged.contains(scan)).count() == 1));
    assert!(belief::folds(&scans[..19], 0.4).is_empty());
    scans[3].whole = false;
    assert!(belief::folds(&scans, 0.4).is_empty());
}
