//! Writes records and their fields.

/// Adds a record with the content that `write` adds.
pub(crate) fn record(out: &mut Vec<u8>, opcode: u8, write: impl FnOnce(&mut Vec<u8>)) {
    out.push(opcode);
    let length_at = out.len();
    out.extend([0; 8]);
    write(out);
    let length = (out.len() - length_at - 8) as u64;
    set_u64(out, length_at, length);
}

pub(crate) fn u16(out: &mut Vec<u8>, value: u16) {
    out.extend(value.to_le_bytes());
}

pub(crate) fn u32(out: &mut Vec<u8>, value: u32) {
    out.extend(value.to_le_bytes());
}

pub(crate) fn u64(out: &mut Vec<u8>, value: u64) {
    out.extend(value.to_le_bytes());
}

/// Adds bytes after their length in 32 bits.
pub(crate) fn bytes(out: &mut Vec<u8>, value: &[u8]) {
    sized(out, |out| out.extend(value));
}

pub(crate) fn text(out: &mut Vec<u8>, value: &str) {
    bytes(out, value.as_bytes());
}

/// Adds the content that `write` adds, after its length in bytes.
pub(crate) fn sized(out: &mut Vec<u8>, write: impl FnOnce(&mut Vec<u8>)) {
    let length_at = out.len();
    out.extend([0; 4]);
    write(out);
    let length = u32::try_from(out.len() - length_at - 4).unwrap_or(u32::MAX);
    if let Some(slot) = out.get_mut(length_at..length_at + 4) {
        slot.copy_from_slice(&length.to_le_bytes());
    }
}

pub(crate) fn texts(out: &mut Vec<u8>, pairs: &[(&str, &str)]) {
    sized(out, |out| {
        for (key, value) in pairs {
            text(out, key);
            text(out, value);
        }
    });
}

fn set_u64(out: &mut [u8], at: usize, value: u64) {
    if let Some(slot) = out.get_mut(at..at + 8) {
        slot.copy_from_slice(&value.to_le_bytes());
    }
}
