#![expect(clippy::unwrap_used, reason = "tests")]

use super::*;
use adit_observation::ImpulseResponse;
use std::hint::black_box;

/// A response with its first path at tap 745 and this many taps between it and the peak.
fn reception(rise: usize) -> Reception {
    let mut taps = vec![[20, -15]; 200];
    for (k, tap) in taps.iter_mut().enumerate().skip(45) {
        let peak = 45 + rise;
        let amplitude = if k <= peak {
            9000.0 * (k - 44) as f64 / (rise + 1) as f64
        } else {
            9000.0 * (-((k - peak) as f64) / 6.0).exp()
        };
        #[expect(clippy::cast_possible_truncation, reason = "at most 9000")]
        let real = amplitude as i16;
        *tap = [real, real / 3];
    }
    Reception {
        rx_power_dbm: Some(-79.0),
        first_path_power_dbm: Some(-81.5 - 1.2 * rise as f32),
        first_path_index_tap: Some(745.3),
        preamble_count: Some(u16::try_from(270 + 40 * rise).unwrap()),
        noise_std: Some(60.0),
        impulse_response: Some(ImpulseResponse { first_tap: 700, taps: taps.into() }),
        ..Reception::default()
    }
}

#[test]
fn the_shipped_model_tells_a_sharp_response_from_a_slow_one() {
    let model = Model::shipped().unwrap();
    let mut scratch = Scratch::default();
    let mut straight = |rise, range_m| model.judge(&reception(rise), Some(range_m), &mut scratch)[0];
    let (sharp, slow) = (straight(1, 2.5), straight(12, 6.0));
    // A fifth of the ranges it was learnt of are in sight.
    assert!(sharp > 0.21 && slow < 0.05, "{sharp} {slow}");
}

#[test]
fn probabilities_sum_to_one_whatever_is_told() {
    let model = Model::shipped().unwrap();
    let mut scratch = Scratch::default();
    let nothing = Reception::default();
    let silent = Reception {
        impulse_response: Some(ImpulseResponse { first_tap: 0, taps: vec![[0, 0]; 3].into() }),
        first_path_index_tap: Some(1.0),
        noise_std: Some(0.0),
        ..Reception::default()
    };
    let loud = Reception {
        impulse_response: Some(ImpulseResponse { first_tap: 0, taps: vec![[i16::MIN; 2]; 1016].into() }),
        first_path_index_tap: Some(1015.9),
        rx_power_dbm: Some(-200.0),
        ..Reception::default()
    };
    for reception in [&nothing, &silent, &loud, &reception(0)] {
        for range_m in [None, Some(-3.0), Some(1e6)] {
            let told = model.judge(reception, range_m, &mut scratch);
            assert!(
                (told.iter().sum::<f32>() - 1.0).abs() < 1e-5 && told.iter().all(|p| *p >= 0.0),
                "{told:?}"
            );
        }
    }
}

#[test]
fn a_model_survives_its_file_bit_by_bit() {
    let model = Model::shipped().unwrap();
    let again = Model::from_bytes("again", &model.to_bytes().unwrap()).unwrap();
    assert_eq!(
        (&again.record, &again.baseline, &again.network),
        (&model.record, &model.baseline, &model.network)
    );
    assert!(again.network.unwrap().looks_at_window());
}

#[test]
fn a_damaged_file_is_an_error_never_a_panic() {
    let bytes = Model::shipped().unwrap().to_bytes().unwrap();
    for length in [0, 7, 8, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(Model::from_bytes("cut", &bytes[..length]).is_err());
    }
    // Every byte of the header in turn; what still reads is a model that answers.
    let header = usize::try_from(u64::from_le_bytes(*bytes.first_chunk().unwrap())).unwrap();
    for at in (0..header + 8).step_by(7) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x11;
        if let Ok(model) = Model::from_bytes("damaged", &damaged) {
            black_box(model.judge(&reception(3), Some(3.0), &mut Scratch::default()));
        }
    }
    let error = Model::from_bytes("m.safetensors", b"no model").unwrap_err().to_string();
    assert!(error.starts_with("m.safetensors: this is no safetensors file"), "{error}");
}
