//! The impulse responses beside a table.

use super::{FIRST_TAP, LabelledRanges, TAPS};
use crate::error::{At, LogError, Place};
use crate::files::{Input, read_error};
use crate::radio::ImpulseResponse;
use std::io::{self, Read};

/// Bytes of a response.
const BLOCK: usize = 4 * TAPS;

/// Gives each row its response.
pub fn read(input: Input, set: &mut LabelledRanges) -> Result<(), LogError> {
    let Input { file, mut reader, gzip, .. } = input;
    let rows = set.ranges.len();
    let count = |found: String| LogError::BadValue {
        place: Place::new(&file, At::File),
        what: "responses".to_owned(),
        found,
        expected: format!("{rows} of {BLOCK} bytes, one for each row of {}", set.file.display()),
    };
    let mut block = [0; BLOCK];
    let mut responses = Vec::with_capacity(rows);
    loop {
        let (number, byte) = (responses.len() as u64 + 1, (BLOCK * responses.len()) as u64);
        let place = Place::new(&file, At::Record { number, byte });
        let filled = fill(&mut reader, &mut block).map_err(|e| read_error(place, gzip, e))?;
        match filled {
            0 => break,
            _ if responses.len() == rows => return Err(count(format!("more than {rows}"))),
            BLOCK => responses.push(response(&block)),
            _ => return Err(count(format!("{} and a part of one", responses.len()))),
        }
    }
    if responses.len() < rows {
        return Err(count(responses.len().to_string()));
    }
    for (range, response) in set.ranges.iter_mut().zip(responses) {
        range.reception.impulse_response = Some(response);
    }
    Ok(())
}

/// Fills the block; how much of it: less at the end.
fn fill(reader: &mut impl Read, block: &mut [u8; BLOCK]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < BLOCK {
        match reader.read(&mut block[filled..]) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

fn response(block: &[u8; BLOCK]) -> ImpulseResponse {
    let (taps, _) = block.as_chunks::<4>();
    let taps = taps.iter().map(|[a, b, c, d]| [i16::from_le_bytes([*a, *b]), i16::from_le_bytes([*c, *d])]);
    ImpulseResponse { first_tap: FIRST_TAP, taps: taps.collect() }
}
