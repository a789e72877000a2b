//! Reads the values of flags.

use std::time::Duration;

use motorlink_bus::{CommandRate, Ramp};
use motorlink_messages::sessions::PlaySpeed;
use motorlink_protocol::{AssignableId, Frame, MotorId};

pub fn assignable(text: &str) -> Result<AssignableId, String> {
    let id: MotorId = text.trim().parse().map_err(|error| format!("{error}"))?;
    AssignableId::new(id).map_err(|error| error.to_string())
}

pub fn seconds(text: &str) -> Result<Duration, String> {
    const MAX: f64 = 86_400.0;
    let seconds = text.trim().parse::<f64>().ok();
    // Not a number compares false.
    let seconds = seconds.filter(|seconds| (0.0..=MAX).contains(seconds));
    let seconds = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    seconds.ok_or_else(|| "expected 0 to 86400 seconds".to_owned())
}

/// A parameter and its values: one, or several with commas between.
pub type Assignment = (String, Vec<f64>);

pub fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, values) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let values = values.split(',').map(|value| value.trim().parse::<f64>());
    let values: Vec<f64> = values
        .collect::<Result<_, _>>()
        .map_err(|_| format!("{name}: expected a number"))?;
    Ok((name.trim().to_owned(), values))
}

pub fn hertz(text: &str) -> Result<f64, String> {
    let hertz = text.trim().parse::<f64>().ok();
    let hertz = hertz.filter(|hertz| (0.001..=1000.0).contains(hertz));
    hertz.ok_or_else(|| "expected 0.001 to 1000 a second".to_owned())
}

pub fn rate(text: &str) -> Result<CommandRate, String> {
    let rate = text.trim().parse().ok().map(CommandRate::new);
    rate.and_then(Result::ok)
        .ok_or_else(|| "expected 1 to 500 a second".to_owned())
}

pub fn ramp(text: &str) -> Result<Ramp, String> {
    let ramp = text.trim().parse().ok().map(Ramp::new);
    ramp.and_then(Result::ok)
        .ok_or_else(|| "expected 1 to 10000 rpm a second".to_owned())
}

pub fn amps(text: &str) -> Result<f32, String> {
    let amps = text.trim().parse::<f32>().ok();
    let amps = amps.filter(|amps| (-8.0..=8.0).contains(amps));
    amps.ok_or_else(|| "expected -8 to 8 A".to_owned())
}

pub fn play_speed(text: &str) -> Result<PlaySpeed, String> {
    let factor = text.trim().parse::<f64>().ok();
    let factor = factor.filter(|factor| (0.1..=100.0).contains(factor));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "100 to 100,000"
    )]
    let speed = factor.map(|factor| PlaySpeed::from_per_mille((factor * 1_000.0).round() as u32));
    speed.ok_or_else(|| "expected 0.1 to 100".to_owned())
}

/// Ten bytes, or nine to which the CRC is added. Commas and `0x` are allowed.
pub fn frame(text: &str) -> Result<Frame, String> {
    let words = text.split(|letter: char| letter == ',' || letter.is_whitespace());
    let words = words.filter(|word| !word.is_empty());
    let bytes = words.map(|word| {
        let digits = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X"));
        let byte = u8::from_str_radix(digits.unwrap_or(word), 16);
        byte.map_err(|_| format!("`{word}` is not a byte in hex"))
    });
    let bytes = bytes.collect::<Result<Vec<u8>, _>>()?;
    if let Ok(bytes) = <[u8; 10]>::try_from(bytes.as_slice()) {
        return Ok(Frame::new(bytes));
    }
    let bytes = <[u8; 9]>::try_from(bytes.as_slice());
    let bytes = bytes.map_err(|_| "expected ten bytes, or nine without the CRC".to_owned())?;
    Ok(Frame::with_crc(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_of_nine_bytes_gets_its_crc_and_one_of_ten_stays() {
        let query = "01 74 00 00 00 00 00 00 00 04";
        assert_eq!(
            frame("0x01,0x74, 00 00 00 00 00 00 00").unwrap(),
            query.parse().unwrap()
        );
        let wrong_crc = frame("01 74 00 00 00 00 00 00 00 FF").unwrap();
        assert_eq!(wrong_crc.bytes()[9], 0xFF);
        assert!(frame("01 74").is_err());
        assert!(frame("").is_err());
    }
}
