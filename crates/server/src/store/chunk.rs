//! A run of fixes of one tag on one person as compressed columns (pco: Loncaric, Jeppesen & Zinberg, 2025, <https://arxiv.org/abs/2502.06112>).
//!
//! Bytes: a format number (1), then the columns time (ms after the first fix), x, y, z (cm), radius (cm), quality, level, zone, then
//! the CRC-32 of all before, little endian. A column is a byte 0 and the one value that all fixes share (4 bytes, little endian), or a byte 1, the length
//! (4 bytes, little endian) and a standalone pco file, or a byte 2, the length and the differences from one to the next, from 0, as zigzag LEB128.
//! The latter is for small chunks, which live some minutes: written in a tenth of the time.

use crate::store::packed::PackedFix;
use pco::ChunkConfig;
use pco::data_types::Number;
use pco::standalone::{simple_compress, simple_decompress};

const FORMAT: u8 = 1;
const SHARED: u8 = 0;
const COMPRESSED: u8 = 1;
const DIFFERENCES: u8 = 2;
/// Bytes of the CRC at the end.
const CHECK: usize = 4;
/// Most fixes of one chunk.
pub(crate) const MOST: usize = 2048;
/// Longest span of one chunk, ms: 30 days, so that times after the first fit 32 bits.
pub(crate) const LONGEST_MS: i64 = 30 * 86_400_000;

/// What a chunk has, beside its columns, in columns of its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ChunkRow {
    pub(crate) id: i64,
    pub(crate) tag: i64,
    pub(crate) person: i64,
    pub(crate) from_ms: i64,
}

/// How much work packing is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    /// For some minutes.
    Quick,
    /// For good.
    Small,
}

/// Packs fixes of one tag and person, in order of time, at most [`LONGEST_MS`] apart; says what has no room.
pub(crate) fn pack(fixes: &[PackedFix], effort: Effort) -> Result<Vec<u8>, String> {
    let first = fixes.first().ok_or("no fixes")?.time_ms;
    let mut bytes = vec![FORMAT];
    put::<u32>(&mut bytes, fixes, effort, |fix| fix.time_ms - first)?;
    put::<i32>(&mut bytes, fixes, effort, |fix| fix.position_cm[0])?;
    put::<i32>(&mut bytes, fixes, effort, |fix| fix.position_cm[1])?;
    put::<i32>(&mut bytes, fixes, effort, |fix| fix.position_cm[2])?;
    put::<u32>(&mut bytes, fixes, effort, |fix| fix.radius_cm)?;
    put::<u32>(&mut bytes, fixes, effort, |fix| fix.quality)?;
    put::<u32>(&mut bytes, fixes, effort, |fix| fix.level)?;
    put::<u32>(&mut bytes, fixes, effort, |fix| fix.zone)?;
    let check = crc32fast::hash(&bytes);
    bytes.extend_from_slice(&check.to_le_bytes());
    Ok(bytes)
}

/// The fixes of a chunk; says what is wrong with its bytes.
pub(crate) fn unpack(row: &ChunkRow, count: usize, bytes: &[u8]) -> Result<Vec<PackedFix>, String> {
    let wrong = |what: &str| format!("track_chunk {}: {what}", row.id);
    let (body, check) = bytes.split_last_chunk::<CHECK>().ok_or_else(|| wrong("no bytes"))?;
    let found = crc32fast::hash(body);
    if found != u32::from_le_bytes(*check) {
        return Err(wrong(&format!("CRC-32 {:08x}, expected {found:08x}", u32::from_le_bytes(*check))));
    }
    let Some((&FORMAT, mut left)) = body.split_first() else {
        return Err(wrong(&format!(
            "format {}, expected {FORMAT}",
            body.first().copied().unwrap_or_default()
        )));
    };
    let empty = PackedFix {
        time_ms: row.from_ms,
        tag: row.tag,
        person: row.person,
        position_cm: [0; 3],
        radius_cm: 0,
        quality: 0,
        level: 0,
        zone: 0,
    };
    let mut fixes = vec![empty; count];
    let left = &mut left;
    fill::<u32>(left, &mut fixes, |fix, after| fix.time_ms = row.from_ms.saturating_add(after))
        .and_then(|()| fill::<i32>(left, &mut fixes, |fix, x| fix.position_cm[0] = x))
        .and_then(|()| fill::<i32>(left, &mut fixes, |fix, y| fix.position_cm[1] = y))
        .and_then(|()| fill::<i32>(left, &mut fixes, |fix, z| fix.position_cm[2] = z))
        .and_then(|()| fill::<u32>(left, &mut fixes, |fix, radius| fix.radius_cm = radius))
        .and_then(|()| fill::<u32>(left, &mut fixes, |fix, quality| fix.quality = quality))
        .and_then(|()| fill::<u32>(left, &mut fixes, |fix, level| fix.level = level))
        .and_then(|()| fill::<u32>(left, &mut fixes, |fix, zone| fix.zone = zone))
        .map_err(|what| wrong(&what))?;
    Ok(fixes)
}

/// The next column into its field.
fn fill<T: Number + Into<i64> + Bytes4>(
    left: &mut &[u8],
    fixes: &mut [PackedFix],
    set: impl Fn(&mut PackedFix, i64),
) -> Result<(), String> {
    let column = take::<T>(left, fixes.len())?;
    for (fix, value) in fixes.iter_mut().zip(column) {
        set(fix, value);
    }
    Ok(())
}

fn put<T: Number + TryFrom<i64> + Into<i64> + PartialEq + Bytes4>(
    bytes: &mut Vec<u8>,
    fixes: &[PackedFix],
    effort: Effort,
    of: impl Fn(&PackedFix) -> i64,
) -> Result<(), String> {
    let column: Vec<T> = fixes
        .iter()
        .map(|fix| T::try_from(of(fix)).map_err(|_| format!("{} needs more than 32 bits", of(fix))))
        .collect::<Result<_, _>>()?;
    if let Some(first) = column.first()
        && column.iter().all(|value| value == first)
    {
        bytes.push(SHARED);
        bytes.extend_from_slice(&first.bytes());
        return Ok(());
    }
    let (how, packed) = match effort {
        Effort::Small => (
            COMPRESSED,
            simple_compress(&column, &ChunkConfig::default()).map_err(|error| error.to_string())?,
        ),
        Effort::Quick => (DIFFERENCES, differences(column.into_iter().map(Into::into))),
    };
    bytes.push(how);
    bytes.extend_from_slice(&u32::try_from(packed.len()).map_err(|error| error.to_string())?.to_le_bytes());
    bytes.extend_from_slice(&packed);
    Ok(())
}

fn take<T: Number + Into<i64> + Bytes4>(left: &mut &[u8], count: usize) -> Result<Vec<i64>, String> {
    let ([how, size @ ..], rest) = left.split_first_chunk::<5>().ok_or("cut short")?;
    if *how == SHARED {
        *left = rest;
        return Ok(vec![T::of(*size).into(); count]);
    }
    let size = usize::try_from(u32::from_le_bytes(*size)).map_err(|error| error.to_string())?;
    let (packed, rest) = rest.split_at_checked(size).ok_or("cut short")?;
    *left = rest;
    let column = if *how == DIFFERENCES {
        sums(packed)?
    } else {
        let column: Vec<T> = simple_decompress(packed).map_err(|error| error.to_string())?;
        column.into_iter().map(Into::into).collect()
    };
    if column.len() != count {
        return Err(format!("a column of {} values, expected {count}", column.len()));
    }
    Ok(column)
}

fn differences(column: impl Iterator<Item = i64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut before = 0;
    for value in column {
        // Of 32 bits each: the difference has room.
        let difference: i64 = value - before;
        before = value;
        let mut left = ((difference << 1) ^ (difference >> 63)).cast_unsigned();
        while left >= 0x80 {
            bytes.push(left.to_le_bytes()[0] | 0x80);
            left >>= 7;
        }
        bytes.push(left.to_le_bytes()[0]);
    }
    bytes
}

fn sums(bytes: &[u8]) -> Result<Vec<i64>, String> {
    let mut column = Vec::new();
    let (mut before, mut value, mut shift) = (0_i64, 0_u64, 0_u32);
    for byte in bytes {
        if shift > 35 {
            return Err("a difference of more than 32 bits".to_owned());
        }
        value |= u64::from(byte & 0x7f) << shift;
        shift += 7;
        if byte & 0x80 == 0 {
            before = before.saturating_add((value >> 1).cast_signed() ^ -(value & 1).cast_signed());
            column.push(before);
            (value, shift) = (0, 0);
        }
    }
    if shift > 0 {
        return Err("cut short".to_owned());
    }
    Ok(column)
}

/// Numbers of four bytes, little endian.
trait Bytes4: Copy {
    fn bytes(self) -> [u8; 4];
    fn of(bytes: [u8; 4]) -> Self;
}

impl Bytes4 for u32 {
    fn bytes(self) -> [u8; 4] {
        self.to_le_bytes()
    }
    fn of(bytes: [u8; 4]) -> Self {
        Self::from_le_bytes(bytes)
    }
}

impl Bytes4 for i32 {
    fn bytes(self) -> [u8; 4] {
        self.to_le_bytes()
    }
    fn of(bytes: [u8; 4]) -> Self {
        Self::from_le_bytes(bytes)
    }
}
