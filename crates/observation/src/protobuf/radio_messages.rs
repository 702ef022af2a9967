//! Signal strengths and ranges as messages and back.

use super::messages::{BadMessage, Messages, device, number, refill, reread, time};
use super::schema::{Timestamp, message};
use crate::radio::{ImpulseResponse, Radio, RangeSample, Reception, SignalStrength};
use prost::Message;
use std::sync::Arc;

/// In-phase and quadrature amplitude, two bytes each.
const BYTES_A_TAP: usize = 4;

impl Messages {
    pub(crate) fn encode_signal(
        &mut self,
        timestamp: Option<Timestamp>,
        signal: &SignalStrength,
        bytes: &mut Vec<u8>,
    ) {
        let message = &mut self.signal;
        message.timestamp = timestamp;
        refill(&mut message.transmitter, signal.transmitter.as_str());
        message.rssi_dbm = Some(signal.rssi_dbm);
        message.radio = radio_to_message(signal.radio).into();
        message.encode_raw(bytes);
    }

    pub(crate) fn decode_signal(&mut self, bytes: &[u8]) -> Result<SignalStrength, BadMessage> {
        reread(&mut self.signal, bytes)?;
        let message = &self.signal;
        Ok(SignalStrength {
            time: time(message.timestamp)?,
            transmitter: device(&mut self.names, &message.transmitter, "transmitter")?,
            rssi_dbm: number(message.rssi_dbm, "rssi_dbm")?,
            radio: radio_from_message(message.radio()),
        })
    }

    pub(crate) fn encode_range(
        &mut self,
        timestamp: Option<Timestamp>,
        range: &RangeSample,
        bytes: &mut Vec<u8>,
    ) {
        let message = &mut self.range;
        message.timestamp = timestamp;
        refill(&mut message.anchor, range.anchor.as_str());
        refill(&mut message.tag, range.tag.as_ref().map_or("", |tag| tag.as_str()));
        message.range_m = Some(range.range_m);
        message.sigma_m = range.sigma_m;
        message.line_of_sight = range.line_of_sight;
        message.radio = radio_to_message(range.radio).into();
        match &range.reception {
            Some(reception) => fill_reception(message.reception.get_or_insert_default(), reception),
            None => message.reception = None,
        }
        message.encode_raw(bytes);
    }

    pub(crate) fn decode_range(&mut self, bytes: &[u8]) -> Result<RangeSample, BadMessage> {
        reread(&mut self.range, bytes)?;
        let message = &self.range;
        let tag = match message.tag.as_str() {
            "" => None,
            tag => Some(device(&mut self.names, tag, "tag")?),
        };
        Ok(RangeSample {
            time: time(message.timestamp)?,
            anchor: device(&mut self.names, &message.anchor, "anchor")?,
            tag,
            range_m: number(message.range_m, "range_m")?,
            sigma_m: message.sigma_m,
            line_of_sight: message.line_of_sight,
            in_the_way: None,
            radio: radio_from_message(message.radio()),
            reception: message.reception.as_ref().map(reception).transpose()?.map(Arc::new),
        })
    }
}

fn fill_reception(message: &mut message::Reception, reception: &Reception) {
    let [first, second, third] = reception.first_path_amplitudes.map_or([None; 3], |a| a.map(Some));
    let mut response = message.impulse_response.take();
    match &reception.impulse_response {
        Some(from) => fill_response(response.get_or_insert_default(), from),
        None => response = None,
    }
    *message = message::Reception {
        rx_power_dbm: reception.rx_power_dbm,
        first_path_power_dbm: reception.first_path_power_dbm,
        first_path_index_tap: reception.first_path_index_tap,
        peak_index_tap: reception.peak_index_tap,
        first_path_amp1: first,
        first_path_amp2: second,
        first_path_amp3: third,
        noise_std: reception.noise_std,
        noise_max: reception.noise_max,
        preamble_count: reception.preamble_count.map(u32::from),
        impulse_response: response,
    };
}

fn fill_response(message: &mut message::ImpulseResponse, response: &ImpulseResponse) {
    message.first_tap = response.first_tap.into();
    message.taps.clear();
    let amplitudes = response.taps.iter().flatten();
    message.taps.extend(amplitudes.flat_map(|amplitude| amplitude.to_le_bytes()));
}

fn reception(message: &message::Reception) -> Result<Reception, BadMessage> {
    let amplitudes = [message.first_path_amp1, message.first_path_amp2, message.first_path_amp3];
    let first_path_amplitudes = match amplitudes {
        [Some(first), Some(second), Some(third)] => Some([first, second, third]),
        [None, None, None] => None,
        [None, ..] => return Err(BadMessage::Missing("first_path_amp1")),
        [_, None, _] => return Err(BadMessage::Missing("first_path_amp2")),
        [.., None] => return Err(BadMessage::Missing("first_path_amp3")),
    };
    Ok(Reception {
        rx_power_dbm: message.rx_power_dbm,
        first_path_power_dbm: message.first_path_power_dbm,
        first_path_index_tap: message.first_path_index_tap,
        peak_index_tap: message.peak_index_tap,
        first_path_amplitudes,
        noise_std: message.noise_std,
        noise_max: message.noise_max,
        preamble_count: message.preamble_count.map(|count| short(count, "preamble_count")).transpose()?,
        impulse_response: message.impulse_response.as_ref().map(response).transpose()?,
    })
}

fn response(message: &message::ImpulseResponse) -> Result<ImpulseResponse, BadMessage> {
    let (taps, rest) = message.taps.as_chunks::<BYTES_A_TAP>();
    let bytes = message.taps.len();
    if !rest.is_empty() || taps.len() > ImpulseResponse::MOST_TAPS {
        let expected = "4 bytes for each of at most 1016 taps";
        return Err(BadMessage::Unlikely("impulse_response taps", bytes as f64, expected));
    }
    let amplitudes = |tap: &[u8; BYTES_A_TAP]| {
        let [i0, i1, q0, q1] = *tap;
        [i16::from_le_bytes([i0, i1]), i16::from_le_bytes([q0, q1])]
    };
    let first_tap = short(message.first_tap, "impulse_response first_tap")?;
    Ok(ImpulseResponse { first_tap, taps: taps.iter().map(amplitudes).collect() })
}

fn short(value: u32, name: &'static str) -> Result<u16, BadMessage> {
    u16::try_from(value).map_err(|_| BadMessage::Unlikely(name, value.into(), "at most 65535"))
}

fn radio_to_message(radio: Radio) -> message::Radio {
    match radio {
        Radio::Unknown => message::Radio::Unspecified,
        Radio::Wifi => message::Radio::Wifi,
        Radio::Ble => message::Radio::Ble,
        Radio::Uwb => message::Radio::Uwb,
    }
}

/// A radio that a later version of the schema knows is unknown here.
fn radio_from_message(radio: message::Radio) -> Radio {
    Radio::ALL.into_iter().find(|ours| radio_to_message(*ours) == radio).unwrap_or_default()
}
