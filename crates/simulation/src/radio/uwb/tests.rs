#![expect(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test may stop; taps are single precision"
)]

use super::*;
use crate::radio::keyed::Key;

/// A clean path at a fraction of a tap, found in noise.
fn lateness(power_dbm: f64, fraction: f64, draw: u64) -> Option<f64> {
    let receiver = Receiver::new(spec::ReceiverSpec::default());
    let mut rng = Key::new(draw, 99).stream();
    let mut channel: Channel = [[0.0; 2]; TAPS];
    let amplitude = (Receiver::energy(power_dbm) / *pulse::ENERGY).sqrt() as f32;
    pulse::add(&mut channel, (DIRECT_TAP as f64 + fraction) as f32, [0.6 * amplitude, 0.8 * amplitude]);
    let found = receiver.detect(&mut channel, &mut rng)?;
    assert!((found.power_dbm - power_dbm).abs() < 0.6, "{}", found.power_dbm);
    Some(receiver.lateness_taps(&found, fraction))
}

#[test]
fn a_clean_path_is_found_to_a_fraction_of_a_tap_wherever_it_falls() {
    let mut sum = 0.0;
    for step in 0..320_u64 {
        let late = lateness(-85.0, step as f64 / 320.0, step).unwrap();
        // The highest sample is up to 8 % below the peak and the edge is bent: a seventh of a tap, and noise.
        assert!(late.abs() < 0.2, "{step}: {late}");
        sum += late;
    }
    assert!((sum / 320.0).abs() < 0.01, "{}", sum / 320.0);
}

#[test]
fn a_path_below_the_threshold_is_not_found_and_the_next_is_taken() {
    assert!(lateness(-125.0, 0.3, 1).is_none());
    let receiver = Receiver::new(spec::ReceiverSpec::default());
    let found = |first_db: f64| {
        let mut channel: Channel = [[0.0; 2]; TAPS];
        let strong = (Receiver::energy(-92.0) / *pulse::ENERGY).sqrt();
        let weak = (strong * 10.0_f64.powf(0.05 * first_db)) as f32;
        pulse::add(&mut channel, DIRECT_TAP as f32 + 0.3, [weak, 0.0]);
        pulse::add(&mut channel, DIRECT_TAP as f32 + 12.3, [0.0, strong as f32]);
        let found = receiver.detect(&mut channel, &mut Key::new(3, 99).stream()).unwrap();
        receiver.lateness_taps(&found, 0.3)
    };
    assert!(found(-10.0).abs() < 0.4, "{}", found(-10.0));
    assert!((found(-30.0) - 12.0).abs() < 0.3, "{}", found(-30.0));
}

#[test]
fn the_bias_by_power_is_the_table_of_aps011() {
    for (power_dbm, bias_cm) in
        [(-61.0, -11.0), (-77.0, 0.0), (-79.0, 2.1), (-93.0, 8.1), (-50.0, -11.0), (-99.0, 8.6)]
    {
        assert!((100.0 * power_bias_m(power_dbm) - bias_cm).abs() < 0.01, "{power_dbm}");
    }
    assert!((100.0 * power_bias_m(-78.0) - 1.05).abs() < 1e-9);
}

#[test]
fn diagnostics_follow_the_manual_from_the_response_itself() {
    let receiver = Receiver::new(spec::ReceiverSpec::default());
    let mut rng = Key::new(5, 99).stream();
    let mut channel: Channel = [[0.0; 2]; TAPS];
    let amplitude = (Receiver::energy(-90.0) / *pulse::ENERGY).sqrt() as f32;
    pulse::add(&mut channel, DIRECT_TAP as f32 + 0.2, [amplitude, 0.0]);
    pulse::add(&mut channel, DIRECT_TAP as f32 + 9.7, [0.0, 0.7 * amplitude]);
    let found = receiver.detect(&mut channel, &mut rng).unwrap();
    let told = receiver.reception(&found, &mut channel, &mut rng, true);
    let response = told.impulse_response.unwrap();
    assert_eq!((response.first_tap, response.taps.len()), (700, 200));
    let amplitude = |tap: usize| {
        let [i, q] = response.taps[tap - 700].map(f64::from);
        i.hypot(q)
    };
    let n = f64::from(told.preamble_count.unwrap());
    let index = f64::from(told.first_path_index_tap.unwrap());
    assert!((740.0..755.0).contains(&index), "{index}");
    let three: f64 = (1..=3).map(|k| amplitude(index.floor() as usize + k).powi(2)).sum();
    let first_path = 10.0 * (three / (n * n)).log10() - 121.74;
    assert!((first_path - f64::from(told.first_path_power_dbm.unwrap())).abs() < 0.01);
    let whole: f64 = (700..900).map(|k| amplitude(k).powi(2)).sum();
    let received = 10.0 * (whole / (n * n)).log10() - 121.74;
    // The sum begins two taps before the first path; what stands before that is noise.
    assert!((received - f64::from(told.rx_power_dbm.unwrap())).abs() < 0.1);
    // Gain control tells a little less than what arrives.
    assert!((f64::from(told.rx_power_dbm.unwrap()) - found.power_dbm).abs() < 1.5);
    let peak = (700..900).max_by(|a, b| amplitude(*a).total_cmp(&amplitude(*b))).unwrap();
    assert!((peak as f64 - f64::from(told.peak_index_tap.unwrap())).abs() < 1e-3);
    assert!((14_000.0..24_000.0).contains(&amplitude(peak)), "{}", amplitude(peak));
}
