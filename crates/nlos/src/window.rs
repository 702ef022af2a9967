//! What the network sees of a response: its amplitudes around the first path.
//!
//! Tap `⌊f⌋ − 8` to `⌊f⌋ + 71`, with the first path at index `f`; each amplitude against the largest of the response, twice: as it is, and in dB from
//! −40 (0) to 0 (1). Phases are left out: that of the first path is drawn anew with every packet.

use adit_observation::Reception;

/// Taps.
pub const TAPS: usize = 80;
/// Values of each tap.
pub const CHANNELS: usize = 2;
/// Taps before the first path.
pub const BEFORE: usize = 8;
/// The weakest amplitude that is told from nothing, dB below the peak.
const FLOOR_DB: f32 = 40.0;

/// Tap by tap, [`CHANNELS`] values each.
pub type Window = [f32; TAPS * CHANNELS];

/// That of nothing at all.
pub const SILENT: Window = [0.0; TAPS * CHANNELS];

/// The window of a reception; `None` without a response, or where the first path lies outside of it.
pub fn of(reception: &Reception) -> Option<Window> {
    let response = reception.impulse_response.as_ref()?;
    let first = reception.first_path_index_tap? - f32::from(response.first_tap);
    if !(0.0..response.taps.len() as f32).contains(&first) {
        return None;
    }
    let amplitude = |[i, q]: &[i16; 2]| f32::from(*i).hypot(f32::from(*q));
    let peak = response.taps.iter().map(amplitude).fold(0.0, f32::max);
    if peak <= 0.0 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the taps")]
    let first = first as usize;
    let mut window = SILENT;
    let (taps, _) = window.as_chunks_mut::<CHANNELS>();
    for (k, value) in taps.iter_mut().enumerate() {
        // What the device has not kept is silent.
        let tap = (first + k).checked_sub(BEFORE).and_then(|at| response.taps.get(at));
        let against = tap.map_or(0.0, |tap| amplitude(tap) / peak);
        *value = values(against);
    }
    Some(window)
}

/// The values of a tap, of its amplitude against the largest.
pub fn values(against: f32) -> [f32; CHANNELS] {
    [against, (1.0 + 20.0 * against.max(1e-6).log10() / FLOOR_DB).max(0.0)]
}
