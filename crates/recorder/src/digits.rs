//! Quick formatting of digits into a reused string: an export writes some sixty million digits while the
//! user waits.

/// A digit, 0-15.
const fn digit(value: u8) -> char {
    (match value {
        0..=9 => b'0' + value,
        _ => b'A' + value % 16 - 10,
    }) as char
}

/// A whole number.
pub fn push_decimal(out: &mut String, value: u64) {
    push_padded(out, value, 1);
}

/// A whole number with at least this many digits, 20 at most.
pub fn push_padded(out: &mut String, value: u64, width: usize) {
    let mut digits = [0_u8; 20];
    let mut rest = value;
    let mut length = 0;
    for slot in &mut digits {
        // Below ten, so it fits.
        *slot = u8::try_from(rest % 10).unwrap_or_default();
        rest /= 10;
        length += 1;
        if rest == 0 && length >= width {
            break;
        }
    }
    let written = digits.get(..length).unwrap_or_default();
    out.extend(written.iter().rev().map(|value| digit(*value)));
}

/// Bytes as two hex digits each, with spaces between: `01 74 00`.
pub fn push_hex(out: &mut String, bytes: &[u8]) {
    let mut first = true;
    for byte in bytes {
        if !first {
            out.push(' ');
        }
        first = false;
        push_hex_byte(out, *byte);
    }
}

/// Bytes as two hex digits each: `017400`.
pub fn push_hex_digits(out: &mut String, bytes: &[u8]) {
    for byte in bytes {
        push_hex_byte(out, *byte);
    }
}

/// `0x1F`
pub fn push_0x(out: &mut String, byte: u8) {
    out.push_str("0x");
    push_hex_byte(out, byte);
}

fn push_hex_byte(out: &mut String, byte: u8) {
    out.push(digit(byte / 16));
    out.push(digit(byte % 16));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl FnOnce(&mut String)) -> String {
        let mut out = String::new();
        write(&mut out);
        out
    }

    #[test]
    fn digits_are_those_of_the_library() {
        for value in [0, 7, 10, 99, 100, 12_345, u64::MAX] {
            assert_eq!(written(|out| push_decimal(out, value)), value.to_string());
        }
        assert_eq!(written(|out| push_padded(out, 7, 3)), "007");
        assert_eq!(written(|out| push_padded(out, 1_234, 3)), "1234");
        assert_eq!(written(|out| push_padded(out, 0, 2)), "00");
        let bytes: Vec<u8> = (0..=255).collect();
        let expected: Vec<_> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
        assert_eq!(written(|out| push_hex(out, &bytes)), expected.join(" "));
        assert_eq!(written(|out| push_0x(out, 0xC8)), "0xC8");
    }
}
